// SPDX-License-Identifier: MIT
#include "facets/surroundings.h"

#include <algorithm>
#include <cmath>

namespace lodestone::facets {
namespace {

constexpr std::size_t most_young = 4;  // the old tree stands until one face in so many has changed

}  // namespace

bool Surroundings::stands(FaceId f) const { return mesh_.faces[f].live && state_[f] == mesh_.state_of(f); }

void Surroundings::plant(Grove& grove, std::vector<FaceId> faces) const {
  std::vector<VertexId> indices;
  indices.reserve(3 * faces.size());
  for (const FaceId f : faces) {
    indices.insert(indices.end(), mesh_.faces[f].point.begin(), mesh_.faces[f].point.end());
  }
  grove.tree = TriangleBvh{mesh_.place, indices};
  grove.faces = std::move(faces);
}

void Surroundings::update(const std::vector<std::uint32_t>& part_of) {
  state_.resize(mesh_.faces.size(), 0);
  std::vector<FaceId> live;
  std::vector<FaceId> young;
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    if (!mesh_.faces[f].live) continue;
    live.push_back(f);
    if (!stands(f)) young.push_back(f);
  }
  if (most_young * young.size() > live.size() || 2 * live.size() < old_.faces.size()) {
    std::fill(state_.begin(), state_.end(), 0);
    for (const FaceId f : live) state_[f] = mesh_.state_of(f);
    plant(old_, std::move(live));
    young.clear();
  }
  plant(young_, std::move(young));
  std::vector<std::uint32_t> part;
  for (Grove* grove : {&old_, &young_}) {
    part.resize(grove->faces.size());
    for (std::size_t i = 0; i < part.size(); ++i) {
      const FaceId f = grove->faces[i];
      part[i] = grove == &young_ || stands(f) ? part_of[f] : none;
    }
    grove->tree.set_labels(part);
  }
}

Surroundings::Nearest Surroundings::nearest(const glm::dvec3& p, std::uint32_t part, double limit_m,
                                            FaceId hint) const {
  Nearest best{limit_m, none};
  if (hint != none) {
    const auto& q = mesh_.faces[hint].point;
    const double d = std::sqrt(squared_distance_to_triangle(p, mesh_.at(q[0]), mesh_.at(q[1]), mesh_.at(q[2])));
    if (d < limit_m) best = {d, hint};
  }
  for (const Grove* grove : {&old_, &young_}) {
    const TriangleBvh::Nearest found = grove->tree.nearest_unlike(p, best.distance_m, part);
    if (found.face != none) best = {std::sqrt(found.squared_distance), grove->faces[found.face]};
  }
  return best.face == none ? Nearest{} : best;
}

bool Surroundings::lies_behind(const glm::dvec3& p, const glm::dvec3& across, std::uint32_t part,
                               double limit_m) const {
  bool found = false;
  for (const Grove* grove : {&old_, &young_}) {
    const auto across_it = [&](FaceId i) {
      return std::abs(glm::dot(mesh_.faces[grove->faces[i]].normal, across)) > 0.7;
    };
    grove->tree.within_unlike(p, limit_m, part, across_it, [&](FaceId i) {
      const Face& face = mesh_.faces[grove->faces[i]];
      const glm::dvec3 a = mesh_.at(face.point[0]);
      const double d = std::sqrt(squared_distance_to_triangle(p, a, mesh_.at(face.point[1]), mesh_.at(face.point[2])));
      found = d <= std::abs(glm::dot(p - a, face.normal)) + 1e-3;
      return !found;
    });
    if (found) return true;
  }
  return false;
}

}  // namespace lodestone::facets
