// SPDX-License-Identifier: MIT
#include "facets/scraps.h"

#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"

namespace lodestone::facets {
namespace {

constexpr std::size_t most_faces = 64;
constexpr double least_price = 1e-6;  // m^4 a face: no look of a bar is had for less
constexpr double most_m = 0.1;        // from the rest: what stands out farther is no scrap
constexpr double same_plane_cosine = 0.999;
constexpr double behind_m = 0.05;  // nothing so near: where it goes a hole is left

bool has_point(const Face& face, std::uint32_t p) {
  return face.point[0] == p || face.point[1] == p || face.point[2] == p;
}

}  // namespace

// Across an edge: a frame does not belong to the glass that it stands on, a pane to the wall that it lies in.
bool ScrapFinder::belongs(FaceId f, FaceId g) const {
  return mesh_.source->face_material(f) == mesh_.source->face_material(g) ||
         glm::dot(mesh_.faces[f].normal, mesh_.faces[g].normal) > same_plane_cosine;
}

void ScrapFinder::group() {
  DisjointSets sets{static_cast<std::uint32_t>(mesh_.faces.size())};
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    if (!mesh_.faces[f].live) continue;
    const auto& p = mesh_.faces[f].point;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t b = p[k == 2 ? 0 : k + 1];
      FaceId other = none;
      std::uint32_t count = 0;
      for (const FaceId g : mesh_.faces_of[p[k]]) {
        if (g == f || !has_point(mesh_.faces[g], b)) continue;
        other = g;
        ++count;
      }
      if (count == 1 && other > f && belongs(f, other)) sets.join(f, other);
    }
  }
  groups_.clear();
  std::vector<std::uint32_t> group_of_root(mesh_.faces.size(), none);
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    group_of_[f] = none;
    if (!mesh_.faces[f].live) continue;
    std::uint32_t& id = group_of_root[sets.find(f)];
    if (id == none) {
      id = static_cast<std::uint32_t>(groups_.size());
      groups_.emplace_back();
    }
    group_of_[f] = id;
    groups_[id].push_back(f);
  }
}

// Else it is a part of its own.
bool ScrapFinder::hangs_on_rest(std::uint32_t id) const {
  return std::any_of(groups_[id].begin(), groups_[id].end(), [&](FaceId f) {
    const auto& p = mesh_.faces[f].point;
    return std::any_of(p.begin(), p.end(), [&](std::uint32_t q) {
      const auto& around = mesh_.faces_of[q];
      return std::any_of(around.begin(), around.end(), [&](FaceId g) { return group_of_[g] != id; });
    });
  });
}

double ScrapFinder::cost_of(FaceId f, std::uint32_t id, double limit_m, Scrap& scrap) const {
  const Face& face = mesh_.faces[f];
  const std::array<glm::dvec3, 3> p{mesh_.at(face.point[0]), mesh_.at(face.point[1]), mesh_.at(face.point[2])};
  const glm::dvec3 middle = (p[0] + p[1] + p[2]) / 3.0;
  double sum = 0.0;
  Surroundings::Nearest last;
  for (const glm::dvec3& at :
       {p[0], p[1], p[2], 0.5 * (p[0] + p[1]), 0.5 * (p[1] + p[2]), 0.5 * (p[2] + p[0]), middle}) {
    last = around_.nearest(at, id, limit_m, last.face);
    if (last.face == none) return std::numeric_limits<double>::infinity();
    sum += last.distance_m * last.distance_m;
    scrap.error_m = std::max(scrap.error_m, last.distance_m);
    scrap.support.push_back(last.face);
  }
  const double area_m2 = 0.5 * glm::length(mesh_.area_vector(face));
  const MaterialId material = mesh_.source->face_material(f);
  const double look = last.distance_m > behind_m
                          ? mesh_.looks.cost_of_hole(area_m2)
                          : mesh_.looks.cost(material, mesh_.source->face_material(last.face), area_m2);
  return area_m2 * sum / 7.0 + look;
}

std::optional<Scrap> ScrapFinder::measure(std::uint32_t id, double price) const {
  const double most = price * static_cast<double>(groups_[id].size());
  Scrap scrap;
  double deviation_m = 0.0;
  for (const FaceId f : groups_[id]) {
    const double area_m2 = 0.5 * glm::length(mesh_.area_vector(mesh_.faces[f]));
    const double limit_m = std::sqrt(7.0 * most / std::max(area_m2, 1e-9));
    scrap.cost += cost_of(f, id, std::min(limit_m, most_m), scrap);
    if (scrap.cost > most) return std::nullopt;
    for (const std::uint32_t p : mesh_.faces[f].point)
      deviation_m = std::max(deviation_m, double{mesh_.deviation_m[p]});
  }
  scrap.faces = groups_[id];
  std::sort(scrap.support.begin(), scrap.support.end());
  scrap.support.erase(std::unique(scrap.support.begin(), scrap.support.end()), scrap.support.end());
  scrap.error_m = std::hypot(scrap.error_m, deviation_m);
  return scrap;
}

std::vector<Scrap> ScrapFinder::find(double price) {
  if (price < least_price) return {};
  group();
  around_.update(groups_, group_of_);
  std::vector<Scrap> found;
  for (std::uint32_t id = 0; id < groups_.size(); ++id) {
    if (groups_[id].size() > most_faces || !hangs_on_rest(id)) continue;
    if (auto scrap = measure(id, price)) found.push_back(std::move(*scrap));
  }
  std::stable_sort(found.begin(), found.end(), [](const Scrap& a, const Scrap& b) {
    return a.cost * static_cast<double>(b.faces.size()) < b.cost * static_cast<double>(a.faces.size());
  });
  return found;
}

}  // namespace lodestone::facets
