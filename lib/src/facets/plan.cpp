// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019, sections 2.3 and 3.2 (facet shift: outermost plane onto the next of its parallel family,
// less important onto more important). Differs: the family is found by the edges that the shift would shrink to
// nothing, so that sides need not be whole, nor perpendicular: points run along the planes they lie in, and a dormer
// sinks along the slope it stands on.
#include "facets/plan.h"

#include <algorithm>
#include <cmath>

namespace lodestone::facets {
namespace {

constexpr double parallel_cosine = 0.99985;  // 1 degree
constexpr double plane_m = 0.002;
constexpr double meet_m = 0.001;
constexpr double least_way_m = 1e-5;
constexpr double least_grip = 0.02;  // squared sine to the planes held
constexpr double sliver_m = 1e-3;    // a flatter face holds nobody
constexpr double most_speed = 4.0;
constexpr std::size_t most_points = 4096;

}  // namespace

Planner::Planner(const FacetMesh& mesh)
    : mesh_(mesh),
      point_stamp_(mesh.point_count(), 0),
      point_index_(mesh.point_count(), 0),
      face_stamp_(mesh.faces.size(), 0) {
  surface_round_.assign(mesh.surface_faces.size(), 0);
}

bool Planner::in_group_plane(const Face& face) const {
  if (std::abs(glm::dot(face.normal, normal_)) < parallel_cosine) return false;
  return std::all_of(face.point.begin(), face.point.end(),
                     [&](std::uint32_t p) { return std::abs(glm::dot(normal_, mesh_.at(p)) - offset_m_) < plane_m; });
}

void Planner::add_face(FaceId f) {
  if (face_stamp_[f] == now_) return;
  face_stamp_[f] = now_;
  faces_.push_back(f);
  const Face& face = mesh_.faces[f];
  area_m2_ += mesh_.area_m2(face);
  for (const std::uint32_t p : face.point) {
    if (point_stamp_[p] == now_) continue;
    point_stamp_[p] = now_;
    point_index_[p] = static_cast<std::uint32_t>(runners_.size());
    runners_.push_back({.point = p});
  }
}

// The faces of the surface and all in its plane that hang on them by a point.
bool Planner::gather(std::uint32_t surface) {
  ++now_;
  faces_.clear();
  runners_.clear();
  area_m2_ = 0.0;
  double largest = 0.0;
  FaceId seed = none;
  for (const FaceId f : mesh_.surface_faces[surface]) {
    const Face& face = mesh_.faces[f];
    if (!face.live) continue;
    const double area = glm::length(mesh_.area_vector(face));
    if (area <= largest) continue;
    largest = area;
    seed = f;
  }
  if (seed == none) return false;
  normal_ = mesh_.faces[seed].normal;
  offset_m_ = glm::dot(normal_, mesh_.at(mesh_.faces[seed].point[0]));
  add_face(seed);
  for (std::size_t i = 0; i < runners_.size() && runners_.size() <= most_points; ++i) {
    for (const FaceId f : mesh_.faces_of[runners_[i].point]) {
      if (in_group_plane(mesh_.faces[f])) add_face(f);
    }
  }
  return runners_.size() <= most_points;
}

// The shortest way along all other planes at the point.
bool Planner::find_speed(Runner& runner) const {
  std::array<glm::dvec3, 3> held{};
  std::size_t count = 0;
  for (const FaceId f : mesh_.faces_of[runner.point]) {
    if (face_stamp_[f] == now_) continue;
    const Face& face = mesh_.faces[f];
    if (height_m(mesh_.at(face.point[0]), mesh_.at(face.point[1]), mesh_.at(face.point[2])) < sliver_m) continue;
    glm::dvec3 n = face.normal;
    for (std::size_t i = 0; i < count; ++i) n -= held[i] * glm::dot(held[i], n);
    const double rest = glm::dot(n, n);
    if (rest < least_grip) continue;
    if (count == 2) return false;  // held by three planes
    held[count++] = n / std::sqrt(rest);
  }
  glm::dvec3 way = normal_;
  for (std::size_t i = 0; i < count; ++i) way -= held[i] * glm::dot(held[i], way);
  const double along = glm::dot(way, normal_);
  if (along < 1.0 / most_speed) return false;
  runner.speed = way / along;
  return true;
}

glm::dvec3 Planner::speed_of(std::uint32_t point) const {
  return point_stamp_[point] == now_ ? runners_[point_index_[point]].speed : glm::dvec3{0.0};
}

// The way to the first edge that shrinks to nothing; 0 if none does.
double Planner::next_event(double sign) const {
  double best = std::numeric_limits<double>::infinity();
  for (const Runner& runner : runners_) {
    for (const FaceId f : mesh_.faces_of[runner.point]) {
      for (const std::uint32_t q : mesh_.faces[f].point) {
        if (q == runner.point) continue;
        const glm::dvec3 speed = speed_of(q) - runner.speed;
        const double speed2 = glm::dot(speed, speed);
        if (speed2 < 1e-6) continue;
        const glm::dvec3 apart = mesh_.at(q) - mesh_.at(runner.point);
        const double way = -glm::dot(apart, speed) / speed2;
        const glm::dvec3 then = apart + way * speed;
        if (way * sign > least_way_m && glm::dot(then, then) < meet_m * meet_m) best = std::min(best, way * sign);
      }
    }
  }
  return std::isfinite(best) ? best * sign : 0.0;
}

// The points that meet at the end become one: one at rest if there is one, else the first.
void Planner::join_meeting(double way) {
  const auto root = [&](std::uint32_t p) {
    while (point_stamp_[p] == now_ && runners_[point_index_[p]].onto != none) p = runners_[point_index_[p]].onto;
    return p;
  };
  const auto place = [&](std::uint32_t p) { return mesh_.at(p) + way * speed_of(p); };
  for (std::size_t i = 0; i < runners_.size(); ++i) {
    for (const FaceId f : mesh_.faces_of[runners_[i].point]) {
      for (const std::uint32_t q : mesh_.faces[f].point) {
        if (q == runners_[i].point) continue;
        const glm::dvec3 then = place(q) - place(runners_[i].point);
        if (glm::dot(then, then) >= meet_m * meet_m) continue;
        std::uint32_t a = root(runners_[i].point);
        std::uint32_t b = root(q);
        if (a == b) continue;
        const bool a_runs = point_stamp_[a] == now_;
        const bool b_runs = point_stamp_[b] == now_;
        if (!a_runs && !b_runs) continue;
        if (!a_runs || (b_runs && a < b)) std::swap(a, b);
        runners_[point_index_[a]].onto = b;
      }
    }
  }
  for (Runner& runner : runners_) {
    const std::uint32_t end = root(runner.point);
    if (end != runner.point) runner.onto = end;
  }
}

// Whether the planes met have at least the area of the group; where none is met nothing is lost.
bool Planner::goes_to_greater(double way) const {
  double area = 0.0;
  bool any = false;
  std::vector<std::uint32_t> seen;
  for (const Runner& runner : runners_) {
    if (runner.onto == none || point_stamp_[runner.onto] == now_) continue;
    for (const FaceId f : mesh_.faces_of[runner.onto]) {
      const Face& face = mesh_.faces[f];
      if (face_stamp_[f] == now_ || std::abs(glm::dot(face.normal, normal_)) < parallel_cosine) continue;
      if (std::abs(glm::dot(normal_, mesh_.at(runner.onto)) - offset_m_ - way) > plane_m) continue;
      any = true;
      if (std::find(seen.begin(), seen.end(), face.surface) != seen.end()) continue;
      seen.push_back(face.surface);
      area += mesh_.surfaces.surfaces[face.surface].area_m2;
    }
  }
  return !any || area >= 0.999 * area_m2_;
}

bool Planner::look_at(std::uint32_t surface) {
  if (surface_round_[surface] == round_ || !gather(surface)) return false;
  for (const FaceId f : faces_) surface_round_[mesh_.faces[f].surface] = round_;
  return std::all_of(runners_.begin(), runners_.end(), [&](Runner& runner) { return find_speed(runner); });
}

Plan Planner::plan(double way_m) {
  Plan plan{.way_m = way_m};
  if (way_m == 0.0) return plan;
  for (Runner& runner : runners_) runner.onto = none;
  join_meeting(way_m);
  if (!goes_to_greater(way_m)) return plan;
  for (const Runner& runner : runners_) {
    const std::uint32_t end = runner.onto == none ? runner.point : runner.onto;
    const bool at_rest = point_stamp_[end] != now_;
    plan.moves.push_back(
        {runner.point, runner.onto, at_rest ? mesh_.place[end] : glm::vec3{mesh_.at(end) + way_m * speed_of(end)}});
  }
  return plan;
}

}  // namespace lodestone::facets
