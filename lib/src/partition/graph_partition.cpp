// SPDX-License-Identifier: MIT
// Based on: recursive bisection along the first parts that METIS finds (first_parts.h), each mended by the moves of
// Fiduccia and Mattheyses (refine.h).
// Differs: METIS keeps sizes within a tolerance only. Here moves go on until both sides can be cut into parts of the
// sizes asked for, those that lengthen the border least first.
#include "partition/graph_partition.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <queue>
#include <utility>

#include "partition/first_parts.h"
#include "partition/refine.h"

namespace lodestone::partition {
namespace {

// Moves vertices from one side to the other, the cheapest first.
class Balance {
 public:
  Balance(const WeightedGraph& graph, std::vector<std::int32_t>& side) : graph_(graph), side_(side) {}

  void move(std::int32_t from, std::uint32_t count) {
    for (std::uint32_t v = 0; v < graph_.size(); ++v) {
      if (side_[v] == from) queue_.push({gain(v), v});
    }
    while (count > 0) {
      const auto [old_gain, negative] = std::pair{queue_.top().first, queue_.top().second};
      queue_.pop();
      const std::uint32_t v = negative;
      if (side_[v] != from || gain(v) != old_gain) continue;
      side_[v] = 1 - from;
      --count;
      for (std::int32_t i = graph_.first[v]; i != graph_.first[v + 1]; ++i) {
        const auto n = static_cast<std::uint32_t>(graph_.neighbour[i]);
        if (side_[n] == from) queue_.push({gain(n), n});
      }
    }
  }

 private:
  struct Later {
    bool operator()(const std::pair<std::int64_t, std::uint32_t>& a,
                    const std::pair<std::int64_t, std::uint32_t>& b) const {
      return a.first != b.first ? a.first < b.first : a.second > b.second;
    }
  };

  // By how much the border gets lighter if v changes sides.
  [[nodiscard]] std::int64_t gain(std::uint32_t v) const {
    std::int64_t sum = 0;
    for (std::int32_t i = graph_.first[v]; i != graph_.first[v + 1]; ++i) {
      sum += side_[static_cast<std::size_t>(graph_.neighbour[i])] == side_[v] ? -graph_.weight[i] : graph_.weight[i];
    }
    return sum;
  }

  const WeightedGraph& graph_;
  std::vector<std::int32_t>& side_;
  std::priority_queue<std::pair<std::int64_t, std::uint32_t>, std::vector<std::pair<std::int64_t, std::uint32_t>>,
                      Later>
      queue_;
};

class Partition {
 public:
  Partition(std::vector<std::int32_t> first_part, const PartSizes& sizes)
      : sizes_(sizes),
        first_part_(std::move(first_part)),
        part_(first_part_.size(), 0),
        place_(first_part_.size(), 0) {}

  void cut(const WeightedGraph& graph, const std::vector<std::uint32_t>& vertices, std::uint32_t parts,
           std::uint32_t first) {
    if (parts == 1) {
      for (const std::uint32_t v : vertices) part_[v] = first;
      return;
    }
    const std::uint32_t left = parts / 2;
    const std::vector<std::int32_t> side = bisect(graph, vertices, parts, first + left);
    for (std::int32_t s = 0; s < 2; ++s) {
      std::vector<std::uint32_t> inside;
      const WeightedGraph half = part_of(graph, side, s, vertices, inside);
      cut(half, inside, s == 0 ? left : parts - left, s == 0 ? first : first + left);
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> take() { return std::move(part_); }

 private:
  // The vertices whose first part is below `middle`, and the others, mended.
  [[nodiscard]] std::vector<std::int32_t> bisect(const WeightedGraph& graph, const std::vector<std::uint32_t>& vertices,
                                                 std::uint32_t parts, std::uint32_t middle) const {
    const std::uint32_t count = graph.size();
    const std::uint32_t left = parts / 2;
    const std::uint32_t right = parts - left;
    const auto low = static_cast<std::uint32_t>(std::max<std::int64_t>(
        std::int64_t{left} * sizes_.min, std::int64_t{count} - std::int64_t{right} * sizes_.max));
    const auto high = static_cast<std::uint32_t>(std::min<std::int64_t>(
        std::int64_t{left} * sizes_.max, std::int64_t{count} - std::int64_t{right} * sizes_.min));
    assert(low <= high);
    const auto aim = static_cast<std::uint32_t>(std::uint64_t{count} * left / parts);
    const std::uint32_t play = std::max(2U, aim / 32);
    std::vector<std::int32_t> side(count, 1);
    for (std::uint32_t v = 0; v < count; ++v) {
      if (first_part_[vertices[v]] < static_cast<std::int32_t>(middle)) side[v] = 0;
    }
    refine(graph, {std::clamp(aim - std::min(aim, play), low, high), std::clamp(aim + play, low, high)}, side);
    const auto now = static_cast<std::uint32_t>(std::count(side.begin(), side.end(), 0));
    if (now < low) Balance{graph, side}.move(1, low - now);
    if (now > high) Balance{graph, side}.move(0, now - high);
    return side;
  }

  WeightedGraph part_of(const WeightedGraph& graph, const std::vector<std::int32_t>& side, std::int32_t wanted,
                        const std::vector<std::uint32_t>& vertices, std::vector<std::uint32_t>& inside) {
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      if (side[v] != wanted) continue;
      place_[v] = static_cast<std::uint32_t>(inside.size());
      inside.push_back(vertices[v]);
    }
    WeightedGraph half;
    half.first.reserve(inside.size() + 1);
    half.first.push_back(0);
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      if (side[v] != wanted) continue;
      for (std::int32_t i = graph.first[v]; i != graph.first[v + 1]; ++i) {
        const auto n = static_cast<std::size_t>(graph.neighbour[i]);
        if (side[n] != wanted) continue;
        half.neighbour.push_back(static_cast<std::int32_t>(place_[n]));
        half.weight.push_back(graph.weight[i]);
      }
      half.first.push_back(static_cast<std::int32_t>(half.neighbour.size()));
    }
    return half;
  }

  PartSizes sizes_;
  std::vector<std::int32_t> first_part_;  // per vertex of the whole
  std::vector<std::uint32_t> part_;
  std::vector<std::uint32_t> place_;
};

}  // namespace

WeightedGraph make_graph(std::uint32_t vertex_count, std::span<const WeightedEdge> edges) {
  WeightedGraph graph;
  graph.first.assign(std::size_t{vertex_count} + 1, 0);
  for (const WeightedEdge& e : edges) {
    if (e.a == e.b) continue;
    ++graph.first[e.a + 1];
    ++graph.first[e.b + 1];
  }
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  std::vector<std::int32_t> at(graph.first.begin(), graph.first.end() - 1);
  std::vector<std::pair<std::int32_t, std::int32_t>> links(static_cast<std::size_t>(graph.first.back()));
  for (const WeightedEdge& e : edges) {
    if (e.a == e.b) continue;
    links[static_cast<std::size_t>(at[e.a]++)] = {static_cast<std::int32_t>(e.b), e.weight};
    links[static_cast<std::size_t>(at[e.b]++)] = {static_cast<std::int32_t>(e.a), e.weight};
  }
  std::int32_t begin = 0;
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    const std::int32_t end = graph.first[v + 1];
    std::sort(links.begin() + begin, links.begin() + end);
    for (std::int32_t i = begin; i != end; ++i) {
      const auto& [to, weight] = links[static_cast<std::size_t>(i)];
      const bool again =
          static_cast<std::int32_t>(graph.neighbour.size()) > graph.first[v] && graph.neighbour.back() == to;
      if (again) {
        graph.weight.back() += weight;
      } else {
        graph.neighbour.push_back(to);
        graph.weight.push_back(weight);
      }
    }
    begin = end;
    graph.first[v + 1] = static_cast<std::int32_t>(graph.neighbour.size());
  }
  return graph;
}

std::vector<std::uint32_t> partition_graph(const WeightedGraph& graph, const PartSizes& sizes) {
  assert(std::uint64_t{sizes.parts} * sizes.min <= graph.size() &&
         graph.size() <= std::uint64_t{sizes.parts} * sizes.max);
  Partition partition{first_parts(graph, sizes.parts), sizes};
  std::vector<std::uint32_t> all(graph.size());
  std::iota(all.begin(), all.end(), 0U);
  partition.cut(graph, all, sizes.parts, 0);
  return partition.take();
}

}  // namespace lodestone::partition
