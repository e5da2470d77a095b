// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998 (a place by linear constraints first, an optimum in what they leave open).
// Differs: the constraints are given planes instead of volume and boundary, and memoryless: those of faces that are
// still there, so that a plane stops to hold when its last face is gone.
#include "collapse/held_planes.h"

#include <algorithm>
#include <cmath>

#include "collapse/weights.h"

namespace lodestone::collapse {
namespace {

constexpr double least_grip = 0.05;  // sine to the planes before: one that turns less adds no axis
constexpr double float_share = 1e-6;

}  // namespace

void HeldPlanes::look_at(const Star& star, const WorkingMesh& mesh, const EdgeCollapseOptions& options,
                         double diagonal_m) {
  planes_.clear();
  tolerance_m_ = std::max(options.plane_tolerance_m, float_share * diagonal_m);
  for (const StarFace& f : star.faces) {
    if (f.side == Side::Both || f.twin) continue;
    const std::uint32_t id = options.face_planes[mesh.faces[f.index].id];
    if (id == none || !options.planes[id].firm) continue;
    auto plane = std::find_if(planes_.begin(), planes_.end(), [id](const Plane& p) { return p.id == id; });
    if (plane == planes_.end()) plane = planes_.insert(plane, {.id = id});
    (f.side == Side::U ? plane->of_u : plane->of_v) = true;
  }
  if (planes_.empty()) return;
  std::sort(planes_.begin(), planes_.end(), [](const Plane& a, const Plane& b) { return a.id < b.id; });
  const glm::dvec3 at_u{mesh.position[star.u]};
  for (Plane& plane : planes_) {
    plane.normal = options.planes[plane.id].normal;
    plane.offset_m = options.planes[plane.id].offset_m - glm::dot(plane.normal, at_u);
  }
  find_subspace();
  u_will_do_ = allow(glm::dvec3{0.0}, star);
  v_will_do_ = allow(star.e, star);
}

void HeldPlanes::find_subspace() {
  rank_ = 0;
  foot_ = glm::dvec3{0.0};
  for (const Plane& plane : planes_) {
    if (rank_ == 3) break;
    const glm::dvec3 rest = across(plane.normal);
    const double grip = glm::length(rest);
    if (grip < least_grip) continue;
    const glm::dvec3 axis = rest / grip;
    foot_ += axis * ((plane.offset_m - glm::dot(plane.normal, foot_)) / grip);
    axes_[rank_++] = axis;
  }
  in_all_ = rank_ < 3 || hold(foot_);
}

// What is left of a vector without its parts along the axes.
glm::dvec3 HeldPlanes::across(const glm::dvec3& v) const {
  glm::dvec3 rest = v;
  for (std::size_t i = 0; i < rank_; ++i) rest -= axes_[i] * glm::dot(axes_[i], rest);
  return rest;
}

bool HeldPlanes::hold(const glm::dvec3& y) const {
  return std::all_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
    return std::abs(glm::dot(plane.normal, y) - plane.offset_m) <= tolerance_m_;
  });
}

bool HeldPlanes::allow(const glm::dvec3& y, const Star& star) const {
  const bool at_u = y == glm::dvec3{0.0};
  const bool at_v = y == star.e;
  return std::all_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
    if ((at_u && !plane.of_v) || (at_v && !plane.of_u)) return true;
    return std::abs(glm::dot(plane.normal, y) - plane.offset_m) <= tolerance_m_;
  });
}

// In the space across the axes the quadric is that of the planes it cuts; along them the foot is the only place.
glm::dvec3 HeldPlanes::minimum(const Star& star, const StarQuadric& quadric) const {
  if (rank_ == 3) return foot_;
  const double pull = middle_weight * quadric.a.trace() + 1e-300;
  Symmetric3 a = quadric.a;
  a.add_isotropic(pull);
  const glm::dvec3 b = across(quadric.b + (0.5 * pull) * star.e - a * foot_);
  const glm::dvec3 x = across({1.0, 0.0, 0.0});
  const glm::dvec3 y = across({0.0, 1.0, 0.0});
  const glm::dvec3 z = across({0.0, 0.0, 1.0});
  const glm::dvec3 ax = a * x;
  const glm::dvec3 ay = a * y;
  const glm::dvec3 az = a * z;
  Symmetric3 m{glm::dot(x, ax), glm::dot(x, ay), glm::dot(x, az), glm::dot(y, ay), glm::dot(y, az), glm::dot(z, az)};
  const double trace = a.trace();
  for (std::size_t i = 0; i < rank_; ++i) m.add_plane(axes_[i], trace);
  const Solver3 solve{m};
  const glm::dvec3 middle = foot_ + across(0.5 * star.e - foot_);
  const glm::dvec3 free = solve.valid() ? foot_ + across(solve(b)) : middle;
  return glm::dot(free, free) <= reach_squared(star) && !sticks_out(star, free) ? free : middle;
}

// Twice the area of a face with a corner at y is a x b + y x (a - b), linear in y; so is its part across the normal p
// of the plane, (a x b) x p + (a - b) (p y) - y (p (a - b)), whose square is the price.
StarQuadric sum_turns(const Star& star, const WorkingMesh& mesh, const EdgeCollapseOptions& options) {
  StarQuadric sum;
  const double weight = options.plane_arm_m * options.plane_arm_m;
  for (const StarFace& f : star.faces) {
    if (f.side == Side::Both || f.twin) continue;
    const std::uint32_t id = options.face_planes[mesh.faces[f.index].id];
    if (id == none) continue;
    const glm::dvec3& p = options.planes[id].normal;
    const glm::dvec3 d = f.at_a - f.at_b;
    const double slope = glm::dot(d, p);
    const glm::dvec3 rest = glm::cross(glm::cross(f.at_a, f.at_b), p);
    // |d|^2 p p^T - slope (p d^T + d p^T) + slope^2 I, the middle one from (p + d) (p + d)^T - p p^T - d d^T.
    sum.a.add_plane(p, weight * (glm::dot(d, d) + slope));
    sum.a.add_plane(d, weight * slope);
    sum.a.add_plane(p + d, -weight * slope);
    sum.a.add_isotropic(weight * slope * slope);
    sum.b -= weight * (p * glm::dot(d, rest) - slope * rest);
    sum.c += weight * glm::dot(rest, rest);
  }
  return sum;
}

glm::dvec3 HeldPlanes::best_place(const Star& star, const StarQuadric& quadric, Placement placement) const {
  glm::dvec3 best =
      placement == Placement::Optimal ? minimum(star, quadric) : collapse::best_place(star, quadric, placement);
  if (in_all_ && hold(best) && !sticks_out(star, best)) return best;
  const bool u_better = quadric.cost(glm::dvec3{0.0}) <= quadric.cost(star.e);
  return u_will_do_ && (u_better || !v_will_do_) ? glm::dvec3{0.0} : star.e;
}

}  // namespace lodestone::collapse
