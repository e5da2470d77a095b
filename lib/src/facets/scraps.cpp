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
constexpr double look_ahead = 16.0;  // times the price: so far costs are found, so that not each price asks anew
constexpr double behind_m = 0.05;    // nothing so near: where it goes a hole is left

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
        if (g == f || !mesh_.faces[g].has_point(b)) continue;
        other = g;
        ++count;
      }
      if (count == 1 && other > f && belongs(f, other)) sets.join(f, other);
    }
  }
  std::uint32_t count = 0;
  std::vector<std::uint32_t> group_of_root(mesh_.faces.size(), none);
  for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
    group_of_[f] = none;
    if (!mesh_.faces[f].live) continue;
    std::uint32_t& id = group_of_root[sets.find(f)];
    if (id == none) id = count++;
    group_of_[f] = id;
  }
  groups_.sort(group_of_, count);
}

// Else it is a part of its own.
bool ScrapFinder::hangs_on_rest(std::uint32_t id) const {
  const std::span<const FaceId> faces = groups_[id];
  return std::any_of(faces.begin(), faces.end(), [&](FaceId f) {
    const auto& p = mesh_.faces[f].point;
    return std::any_of(p.begin(), p.end(), [&](std::uint32_t q) {
      const auto& around = mesh_.faces_of[q];
      return std::any_of(around.begin(), around.end(), [&](FaceId g) { return group_of_[g] != id; });
    });
  });
}

// Where the group hangs on the rest, it is at no distance.
void ScrapFinder::find_corners(const Face& face, std::uint32_t id, double limit_m) {
  std::array<Surroundings::Query, 3> queries;
  std::array<std::uint32_t, 3> asked{};
  std::size_t count = 0;
  for (const std::uint32_t p : face.point) {
    Corner& corner = corners_[p];
    if (corner.look == look_ && (corner.face != none || corner.limit_m >= limit_m)) continue;
    corner = {.look = look_, .limit_m = limit_m};
    const auto& around = mesh_.faces_of[p];
    const auto other = std::find_if(around.begin(), around.end(), [&](FaceId g) { return group_of_[g] != id; });
    if (other != around.end()) {
      corner.face = *other;
    } else {
      queries[count] = {mesh_.place[p], limit_m * limit_m};
      if (last_nearest_ != none) around_.hint(queries[count], last_nearest_);
      asked[count++] = p;
    }
  }
  if (count == 0) return;
  around_.nearest(std::span{queries.data(), count}, id);
  for (std::size_t i = 0; i < count; ++i) {
    corners_[asked[i]].face = queries[i].face;
    corners_[asked[i]].squared_m = queries[i].squared_m;
  }
}

double ScrapFinder::cost_of(FaceId f, std::uint32_t id, double limit_m, Scrap& scrap) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Face& face = mesh_.faces[f];
  find_corners(face, id, limit_m);
  double sum = 0.0;
  const auto add = [&](double squared_m, FaceId nearest) {
    sum += squared_m;
    scrap.error_m = std::max(scrap.error_m, std::sqrt(squared_m));
    if (scrap.support.empty() || scrap.support.back() != nearest) scrap.support.push_back(nearest);
    last_nearest_ = nearest;
  };
  for (const std::uint32_t p : face.point) {
    const Corner& corner = corners_[p];
    if (corner.face == none || corner.squared_m > limit_m * limit_m) return infinity;
    add(corner.squared_m, corner.face);
  }
  std::array<Surroundings::Query, 4> queries;
  glm::dvec3 middle{0.0};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = face.point[k];
    const std::uint32_t b = face.point[k == 2 ? 0 : k + 1];
    queries[k] = {glm::vec3{0.5 * (mesh_.at(a) + mesh_.at(b))}, limit_m * limit_m};
    around_.hint(queries[k], corners_[a].face);
    around_.hint(queries[k], corners_[b].face);
    middle += mesh_.at(a) / 3.0;
  }
  queries[3] = {glm::vec3{middle}, limit_m * limit_m};
  for (const std::uint32_t p : face.point) around_.hint(queries[3], corners_[p].face);
  around_.nearest(queries, id);
  for (const Surroundings::Query& q : queries) {
    if (q.face == none) return infinity;
    add(q.squared_m, q.face);
  }
  const double area_m2 = mesh_.area_m2(face);
  const MaterialId material = mesh_.source->face_material(f);
  const double look = queries[3].squared_m > behind_m * behind_m
                          ? mesh_.looks.cost_of_hole(area_m2)
                          : mesh_.looks.cost(material, mesh_.source->face_material(queries[3].face), area_m2);
  return area_m2 * sum / 7.0 + look;
}

// Of its shape: what lies around it comes nearer rarely.
std::uint64_t ScrapFinder::state_of(std::uint32_t id) const {
  std::uint64_t sum = groups_[id].size();
  for (const FaceId f : groups_[id]) sum += (f + 1ULL) * mesh_.shape_of(f);
  return sum;
}

// Empty if it is too dear; `known` tells from when on it may not be.
std::optional<Scrap> ScrapFinder::measure(std::uint32_t id, double price, Known& known) {
  ++look_;
  last_nearest_ = none;
  const auto count = static_cast<double>(groups_[id].size());
  const double most = look_ahead * price * count;
  const auto limit_of = [&](FaceId f) {
    const double area_m2 = mesh_.area_m2(mesh_.faces[f]);
    return std::min(std::sqrt(7.0 * most / std::max(area_m2, 1e-9)), most_m);
  };
  if (known.dearest != none) {
    Scrap dearest;
    known.key = cost_of(known.dearest, id, limit_of(known.dearest), dearest) / count;
    if (known.key > price) return std::nullopt;
  }
  Scrap scrap;
  double deviation_m = 0.0;
  double most_cost = -1.0;
  for (const FaceId f : groups_[id]) {
    const double cost = cost_of(f, id, limit_of(f), scrap);
    scrap.cost += cost;
    if (cost > most_cost) {
      most_cost = cost;
      known.dearest = f;
    }
    if (scrap.cost > most) break;
    for (const std::uint32_t p : mesh_.faces[f].point)
      deviation_m = std::max(deviation_m, double{mesh_.deviation_m[p]});
  }
  known.key = scrap.cost / count;
  if (known.key > price) return std::nullopt;
  scrap.faces.assign(groups_[id].begin(), groups_[id].end());
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
    if (groups_[id].size() > most_faces) continue;
    Known& known = known_[groups_[id].front()];
    const std::uint64_t state = state_of(id);
    if (known.state == state && known.key > price) continue;
    if (known.state != state) known = {.state = state};
    if (!hangs_on_rest(id)) continue;
    if (auto scrap = measure(id, price, known)) found.push_back(std::move(*scrap));
  }
  std::stable_sort(found.begin(), found.end(), [](const Scrap& a, const Scrap& b) {
    return a.cost * static_cast<double>(b.faces.size()) < b.cost * static_cast<double>(a.faces.size());
  });
  return found;
}

}  // namespace lodestone::facets
