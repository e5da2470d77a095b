// SPDX-License-Identifier: MIT
#include "facets/surroundings.h"

#include <algorithm>
#include <cmath>

namespace lodestone::facets {
namespace {

constexpr std::size_t most_young = 4;     // the old tree stands until one face in so many has changed
constexpr std::size_t small_part = 64;    // faces; of larger parts each face has a box of its own
constexpr std::size_t bundle_faces = 16;  // of a small part
constexpr double facing_cosine = 0.7;     // of what lies behind
constexpr double margin_m = 1e-3;         // beside a face that covers

}  // namespace

bool Surroundings::stands(FaceId f) const { return mesh_.faces[f].live && shape_[f] == mesh_.shape_of(f); }

void Surroundings::add_bundle(Grove& grove, std::span<const FaceId> faces) const {
  Bundle bundle;
  bundle.first = static_cast<std::uint32_t>(grove.slots.size());
  bundle.count = static_cast<std::uint32_t>(faces.size());
  for (const FaceId f : faces) {
    Slot slot;
    slot.face = f;
    for (std::size_t k = 0; k < 3; ++k) {
      slot.corner[k] = mesh_.place[mesh_.faces[f].point[k]];
      bundle.box.add(slot.corner[k]);
    }
    grove.slots.push_back(slot);
  }
  grove.bundles.push_back(bundle);
}

void Surroundings::plant(Grove& grove) const {
  // A triangle across each box has that box.
  std::vector<glm::vec3> ends;
  std::vector<VertexId> indices;
  ends.reserve(2 * grove.bundles.size());
  indices.reserve(3 * grove.bundles.size());
  for (const Bundle& bundle : grove.bundles) {
    const auto first = static_cast<VertexId>(ends.size());
    ends.insert(ends.end(), {bundle.box.low, bundle.box.high});
    indices.insert(indices.end(), {first, first + 1, first});
  }
  grove.tree = TriangleBvh{ends, indices};
}

void Surroundings::update(const FaceGroups& parts, const std::vector<std::uint32_t>& part_of) {
  part_of_ = &part_of;
  if (edits_ == mesh_.edits) return;
  edits_ = mesh_.edits;
  shape_.resize(mesh_.faces.size(), 0);
  const std::span<const FaceId> all = parts.faces();
  const auto young_count =
      static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](FaceId f) { return !stands(f); }));
  const auto gather = [&](Grove& grove, auto wanted) {
    grove.slots.clear();
    grove.bundles.clear();
    std::vector<FaceId> some;
    for (std::uint32_t id = 0; id < parts.size(); ++id) {
      const std::span<const FaceId> faces = parts[id];
      some.clear();
      const std::size_t most = faces.size() > small_part ? 1 : bundle_faces;
      for (const FaceId f : faces) {
        if (!wanted(f)) continue;
        some.push_back(f);
        if (some.size() < most) continue;
        add_bundle(grove, some);
        some.clear();
      }
      if (!some.empty()) add_bundle(grove, some);
    }
    plant(grove);
  };
  if (most_young * young_count > all.size() || 2 * all.size() < old_.slots.size()) {
    std::fill(shape_.begin(), shape_.end(), 0);
    for (const FaceId f : all) shape_[f] = mesh_.shape_of(f);
    gather(old_, [](FaceId) { return true; });
    young_ = {};
    return;
  }
  for (Slot& slot : old_.slots) {
    if (slot.face != none && !stands(slot.face)) slot.face = none;
  }
  gather(young_, [&](FaceId f) { return !stands(f); });
}

template <class Visit>
bool Surroundings::visit_others(const Grove& grove, const Bundle& bundle, std::uint32_t part, Visit visit) const {
  for (std::uint32_t s = bundle.first; s < bundle.first + bundle.count; ++s) {
    const Slot& slot = grove.slots[s];
    // All of a bundle hung together when the tree was built; they may not any more.
    if (slot.face != none && (*part_of_)[slot.face] != part && !visit(slot)) return false;
  }
  return true;
}

void Surroundings::hint(Query& query, FaceId face) const {
  const auto& p = mesh_.faces[face].point;
  const double d2 = squared_distance_to_triangle(glm::dvec3{query.at}, mesh_.at(p[0]), mesh_.at(p[1]), mesh_.at(p[2]));
  if (d2 < query.squared_m) query = {query.at, d2, face};
}

void Surroundings::nearest(std::span<Query> queries, std::uint32_t part) const {
  FloatBox around;
  for (const Query& q : queries) around.add(q.at);
  const auto find_most = [&] {
    double most = 0.0;
    for (const Query& q : queries) most = std::max(most, q.squared_m);
    return most;
  };
  double most = find_most();
  const TriangleBvh::Place place{glm::dvec3{around.low}, glm::dvec3{around.high}};
  for (const Grove* grove : {&old_, &young_}) {
    const auto bound = [&] { return most; };
    grove->tree.visit_boxes(place, bound, [&](FaceId i) {
      const Bundle& bundle = grove->bundles[i];
      if (bundle.box.squared_distance(around) >= most) return true;
      bool nearer = false;
      visit_others(*grove, bundle, part, [&](const Slot& slot) {
        const auto& [a, b, c] = slot.corner;
        const FloatBox box{glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
        if (box.squared_distance(around) >= most) return true;
        for (Query& q : queries) {
          if (box.squared_distance(glm::dvec3{q.at}) >= q.squared_m) continue;
          const double d2 = squared_distance_to_triangle(glm::dvec3{q.at}, glm::dvec3{a}, glm::dvec3{b}, glm::dvec3{c});
          if (d2 >= q.squared_m) continue;
          q.squared_m = d2;
          q.face = slot.face;
          nearer = true;
        }
        return true;
      });
      if (nearer) most = find_most();
      return true;
    });
  }
}

bool Surroundings::lies_behind(const glm::dvec3& p, const glm::dvec3& across, std::uint32_t part, double limit_m,
                               std::span<const FaceId> hints) const {
  const auto covers = [&](FaceId f, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const double facing = glm::dot(mesh_.faces[f].normal, across);
    if (!(std::abs(facing) > facing_cosine)) return false;
    const double way_m = glm::dot(mesh_.faces[f].normal, glm::dvec3{a} - p) / facing;
    const glm::dvec3 there = p + way_m * across;
    return std::abs(way_m) <= limit_m &&
           squared_distance_to_triangle(there, glm::dvec3{a}, glm::dvec3{b}, glm::dvec3{c}) <= margin_m * margin_m;
  };
  for (const FaceId f : hints) {
    if (f == none || !mesh_.faces[f].live || (*part_of_)[f] == part) continue;
    const auto& q = mesh_.faces[f].point;
    if (covers(f, mesh_.place[q[0]], mesh_.place[q[1]], mesh_.place[q[2]])) return true;
  }
  bool found = false;
  for (const Grove* grove : {&old_, &young_}) {
    grove->tree.visit_along(p, limit_m * across, margin_m, [&](FaceId i) {
      return visit_others(*grove, grove->bundles[i], part, [&](const Slot& slot) {
        found = covers(slot.face, slot.corner[0], slot.corner[1], slot.corner[2]);
        return !found;
      });
    });
    if (found) return true;
  }
  return false;
}

}  // namespace lodestone::facets
