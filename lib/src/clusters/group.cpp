// SPDX-License-Identifier: MIT
// Based on: Wang et al. 2023, section 2.3 (groups of 8 to 32 clusters by partition of the graph of clusters, weighted
// by shared edges).
#include "clusters/group.h"

#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.h"
#include "clusters/face_graph.h"

namespace lodestone::clusters {
namespace {

constexpr std::int32_t edge_weight = 4;
constexpr std::int32_t near_weight = 1;
constexpr std::uint32_t several = none - 1;

// An edge between points that several clusters use; `owner` is a cluster, or the number of clusters for what has ended.
struct OwnedEdge {
  std::uint32_t low = 0, high = 0, owner = 0;
  friend bool operator<(const OwnedEdge& a, const OwnedEdge& b) {
    if (a.low != b.low) return a.low < b.low;
    return a.high != b.high ? a.high < b.high : a.owner < b.owner;
  }
};

class Grouper {
 public:
  Grouper(const Live& live, std::span<const LiveFace> ended, const Ground& ground)
      : live_(live), ended_(ended), ground_(ground), count_(static_cast<std::uint32_t>(live.clusters.size())) {}

  Grouping run(std::uint32_t aim) {
    find_border_edges();
    const std::vector<std::uint32_t> group_of = partition(aim);
    return collect(group_of);
  }

 private:
  template <class Visit>
  void for_each_face(Visit visit) const {
    for (std::uint32_t c = 0; c < count_; ++c) {
      for (const LiveFace& f : live_.faces_of(live_.clusters[c])) visit(points_of(f), c);
    }
    for (const LiveFace& f : ended_) visit(points_of(f), count_);
  }
  [[nodiscard]] std::array<std::uint32_t, 3> points_of(const LiveFace& f) const {
    return {ground_.point_of[f.vertex[0]], ground_.point_of[f.vertex[1]], ground_.point_of[f.vertex[2]]};
  }

  // Edges whose two points are both used by several clusters: the others lie inside one.
  void find_border_edges() {
    std::vector<std::uint32_t> owner(ground_.deviation_m.size(), none);
    for_each_face([&](const auto& points, std::uint32_t c) {
      for (const std::uint32_t p : points) owner[p] = owner[p] == none || owner[p] == c ? c : several;
    });
    for_each_face([&](const auto& points, std::uint32_t c) {
      if (is_collapsed(points)) return;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t p = points[k];
        const std::uint32_t q = points[k == 2 ? 0 : k + 1];
        if (owner[p] == several && owner[q] == several) edges_.push_back({std::min(p, q), std::max(p, q), c});
      }
    });
    std::sort(edges_.begin(), edges_.end());
  }

  // Calls visit(first, last) for the uses of every edge.
  template <class Visit>
  void for_each_edge(Visit visit) const {
    for (auto first = edges_.begin(); first != edges_.end();) {
      auto last = first + 1;
      while (last != edges_.end() && last->low == first->low && last->high == first->high) ++last;
      visit(first, last);
      first = last;
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> partition(std::uint32_t aim) const {
    std::vector<std::uint32_t> group_of(count_, 0);
    if (count_ <= max_group) return group_of;
    const std::uint32_t groups = std::max(2U, (count_ + aim / 2) / aim);
    const std::uint32_t low = std::min(count_ / groups, std::max(min_group, aim * 3 / 4));
    const std::uint32_t high = std::max((count_ + groups - 1) / groups, std::min(max_group, aim * 5 / 4));
    return partition::partition_graph(cluster_graph(), {groups, low, high});
  }

  [[nodiscard]] partition::WeightedGraph cluster_graph() const {
    std::vector<partition::WeightedEdge> links;
    DisjointSets sets{count_};
    for_each_edge([&](auto first, auto last) {
      for (auto next = first + 1; next != last; ++next) {
        const auto& before = *(next - 1);
        if (next->owner == count_ || before.owner == next->owner) continue;
        links.push_back({before.owner, next->owner, edge_weight});
        sets.join(before.owner, next->owner);
      }
    });
    std::vector<glm::vec3> middles(count_, glm::vec3{0.0F});
    for (std::uint32_t c = 0; c < count_; ++c) {
      glm::dvec3 sum{0.0};
      for (const LiveFace& f : live_.faces_of(live_.clusters[c])) {
        sum += glm::dvec3{ground_.values.positions[f.vertex[0]]};
      }
      middles[c] = glm::vec3{sum / std::max(1.0, static_cast<double>(live_.clusters[c].faces.size()))};
    }
    const std::vector<std::uint32_t> order = morton_order(middles);
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (sets.find(order[i - 1]) != sets.find(order[i])) links.push_back({order[i - 1], order[i], near_weight});
    }
    return partition::make_graph(count_, links);
  }

  [[nodiscard]] Grouping collect(const std::vector<std::uint32_t>& group_of) const {
    Grouping result;
    for (std::uint32_t c = 0; c < count_; ++c) {
      if (group_of[c] >= result.groups.size()) result.groups.resize(group_of[c] + 1);
      result.groups[group_of[c]].clusters.push_back(c);
    }
    const auto owner_of = [&](std::uint32_t c) { return c == count_ ? several : group_of[c]; };
    std::vector<std::uint32_t> owner(ground_.deviation_m.size(), none);
    result.shared.assign(ground_.deviation_m.size(), 0);
    for_each_face([&](const auto& points, std::uint32_t c) {
      for (const std::uint32_t p : points) {
        if (owner[p] == none) owner[p] = owner_of(c);
        if (owner[p] != owner_of(c) || c == count_) result.shared[p] = 1;
      }
    });
    for_each_edge([&](auto first, auto last) {
      for (auto use = first; use != last; ++use) {
        const bool other =
            std::any_of(first, last, [&](const OwnedEdge& e) { return owner_of(e.owner) != owner_of(use->owner); });
        if (!other || use->owner == count_) continue;
        auto& border = result.groups[group_of[use->owner]].border;
        const BorderEdge edge{use->low, use->high};
        if (border.empty() || !(border.back() == edge)) border.push_back(edge);
      }
    });
    return result;
  }

  const Live& live_;
  std::span<const LiveFace> ended_;
  const Ground& ground_;
  std::uint32_t count_;
  std::vector<OwnedEdge> edges_;
};

}  // namespace

Grouping group_clusters(const Live& live, std::span<const LiveFace> ended, const Ground& ground, std::uint32_t aim) {
  return Grouper{live, ended, ground}.run(aim);
}

}  // namespace lodestone::clusters
