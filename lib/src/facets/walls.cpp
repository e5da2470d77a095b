// SPDX-License-Identifier: MIT
#include "facets/walls.h"

#include <algorithm>
#include <utility>

#include "facets/notches.h"
#include "facets/outline.h"

namespace lodestone::facets {
namespace {

constexpr std::size_t most_corners = 64;  // of an opening
constexpr std::size_t fewest_faces = 6;   // of a wall with an opening

}  // namespace

Walls::Walls(const FacetMesh& mesh)
    : mesh_(mesh), wall_of_(mesh.faces.size(), none), state_(mesh.faces.size(), 0), is_sliver_(mesh.faces.size(), 0) {}

// Faces on one edge; asked of the lower one that has a direction, so that both give the same answer. Slivers, drawn to
// tie a side to the points it passes by, join what they lie between: without them the pier between two windows would
// stand in one large hole.
bool Walls::joined(FaceId f, FaceId g) const {
  if (mesh_.source->face_material(f) != mesh_.source->face_material(g)) return false;
  if (g < f) std::swap(f, g);
  if (is_sliver_[f] != 0) std::swap(f, g);
  const Face& face = mesh_.faces[f];
  if (is_sliver_[f] != 0) return true;
  if (is_sliver_[g] == 0 && !is_parallel(mesh_.faces[g], face.normal)) return false;
  return is_near(mesh_, mesh_.faces[g], face.normal, glm::dot(face.normal, mesh_.at(face.point[0])));
}

void Walls::dissolve(std::uint32_t wall, std::vector<FaceId>& loose) {
  for (const FaceId f : walls_[wall].faces) {
    wall_of_[f] = none;
    if (mesh_.faces[f].live) loose.push_back(f);
  }
  walls_[wall] = {};
}

// A new wall from the seed on; walls that it meets are dissolved into it.
void Walls::grow(FaceId seed, std::vector<FaceId>& loose) {
  const auto id = static_cast<std::uint32_t>(walls_.size());
  Wall wall;
  wall.faces.push_back(seed);
  wall_of_[seed] = id;
  for (std::size_t i = 0; i < wall.faces.size(); ++i) {
    const FaceId f = wall.faces[i];
    const auto& p = mesh_.faces[f].point;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t far = p[k == 2 ? 0 : k + 1];
      for (const FaceId g : mesh_.faces_of[p[k]]) {
        const auto& q = mesh_.faces[g].point;
        if (wall_of_[g] == id || (q[0] != far && q[1] != far && q[2] != far) || !joined(f, g)) continue;
        if (wall_of_[g] != none) dissolve(wall_of_[g], loose);
        wall_of_[g] = id;
        wall.faces.push_back(g);
      }
    }
  }
  std::sort(wall.faces.begin(), wall.faces.end());
  find_openings(wall);
  walls_.push_back(std::move(wall));
}

void Walls::find_openings(Wall& wall) const {
  if (wall.faces.size() < fewest_faces) return;
  // The largest face tells the plane.
  FaceId plain = none;
  double largest = 0.0;
  for (const FaceId f : wall.faces) {
    const double area = glm::length(mesh_.area_vector(mesh_.faces[f]));
    if (area <= largest || is_sliver_[f] != 0) continue;
    largest = area;
    plain = f;
  }
  if (plain == none) return;
  const glm::dvec3 normal = mesh_.faces[plain].normal;
  for (auto& loop : chain(mesh_, outline(mesh_, wall.faces), normal)) {
    const double area_m2 = -signed_area(mesh_, loop, normal);
    if (area_m2 < 0.0) {
      for (Opening& notch : find_notches(mesh_, loop, normal)) {
        notch.wall = plain;
        wall.openings.push_back(std::move(notch));
      }
    }
    if (area_m2 <= 0.0 || loop.size() > most_corners) continue;
    Opening opening;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      opening.perimeter_m += glm::length(mesh_.at(loop[i]) - mesh_.at(loop[(i + 1) % loop.size()]));
    }
    opening.loop = std::move(loop);
    opening.wall = plain;
    opening.area_m2 = area_m2;
    wall.openings.push_back(std::move(opening));
  }
}

const std::vector<FaceId>& Walls::update() {
  changed_.clear();
  if (edits_ == mesh_.edits) return changed_;
  edits_ = mesh_.edits;
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    const std::uint64_t state = mesh_.faces[f].live ? mesh_.state_of(f) : 0;
    if (state == state_[f]) continue;
    state_[f] = state;
    is_sliver_[f] = state != 0 && is_sliver(mesh_, mesh_.faces[f]) ? 1 : 0;
    changed_.push_back(f);
  }
  std::vector<FaceId> loose;
  for (const FaceId f : changed_) {
    if (wall_of_[f] != none) {
      dissolve(wall_of_[f], loose);
    } else if (mesh_.faces[f].live) {
      loose.push_back(f);
    }
  }
  // Grown walls add to the list while it is walked.
  for (std::size_t i = 0; i < loose.size(); ++i) {
    if (wall_of_[loose[i]] == none) grow(loose[i], loose);
  }
  std::erase_if(walls_, [](const Wall& wall) { return wall.faces.empty(); });
  for (std::uint32_t i = 0; i < walls_.size(); ++i) {
    for (const FaceId f : walls_[i].faces) wall_of_[f] = i;
  }
  return changed_;
}

std::vector<Opening> Walls::openings() const {
  std::vector<Opening> all;
  for (const Wall& wall : walls_) all.insert(all.end(), wall.openings.begin(), wall.openings.end());
  std::sort(all.begin(), all.end(), [](const Opening& a, const Opening& b) {
    return a.area_m2 != b.area_m2 ? a.area_m2 < b.area_m2 : a.wall != b.wall ? a.wall < b.wall : a.loop < b.loop;
  });
  return all;
}

}  // namespace lodestone::facets
