// SPDX-License-Identifier: MIT
// Based on: Karypis and Kumar 1998 (multilevel bisection), by their library METIS; this is the only file that names it.
// Differs: neighbours are joined here until a graph is small, because METIS, built for large graphs, takes longer for
// that. METIS keeps sizes within a tolerance only. Here each bisection is followed by moves along its border, those
// that lengthen it least first, until both sides can be cut into parts of the sizes asked for.
#include "partition/graph_partition.h"

#include <metis.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <mutex>
#include <numeric>
#include <queue>
#include <utility>

namespace lodestone::partition {
namespace {

// METIS draws from rand() and sets signal handlers, both of the whole process: one call at a time, each with its own
// seed.
std::mutex metis_door;

constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();

// A graph, how much each of its vertices counts, and, where it was made by joining neighbours, which one each vertex of
// the finer graph went into.
struct Coarse {
  WeightedGraph graph;
  std::vector<std::int32_t> count;
  std::vector<std::uint32_t> into;
};

// Below this METIS is fast enough by itself.
constexpr std::uint32_t few_vertices = 500;

// Joins each vertex with the neighbour that it hangs on most and that is still free, in the order of vertices.
std::vector<std::uint32_t> join_neighbours(const WeightedGraph& graph, std::uint32_t& joined_count) {
  std::vector<std::uint32_t> into(graph.size(), no_vertex);
  joined_count = 0;
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (into[v] != no_vertex) continue;
    std::int32_t most = 0;
    std::uint32_t mate = v;
    for (std::int32_t i = graph.first[v]; i != graph.first[v + 1]; ++i) {
      const auto n = static_cast<std::uint32_t>(graph.neighbour[i]);
      if (into[n] != no_vertex || graph.weight[i] <= most) continue;
      most = graph.weight[i];
      mate = n;
    }
    into[v] = into[mate] = joined_count++;
  }
  return into;
}

Coarse coarser(const WeightedGraph& fine, const std::vector<std::int32_t>& count) {
  Coarse coarse;
  std::uint32_t size = 0;
  coarse.into = join_neighbours(fine, size);
  coarse.count.assign(size, 0);
  std::vector<std::array<std::uint32_t, 2>> members(size, {no_vertex, no_vertex});
  for (std::uint32_t v = 0; v < fine.size(); ++v) {
    const std::uint32_t c = coarse.into[v];
    coarse.count[c] += count[v];
    members[c][members[c][0] == no_vertex ? 0 : 1] = v;
  }
  WeightedGraph& graph = coarse.graph;
  graph.first.reserve(std::size_t{size} + 1);
  graph.first.push_back(0);
  graph.neighbour.reserve(fine.neighbour.size());
  graph.weight.reserve(fine.neighbour.size());
  std::vector<std::int32_t> link_to(size, -1);  // place of the link, while it belongs to the vertex at hand
  for (std::uint32_t c = 0; c < size; ++c) {
    for (const std::uint32_t v : members[c]) {
      if (v == no_vertex) continue;
      for (std::int32_t i = fine.first[v]; i != fine.first[v + 1]; ++i) {
        const std::uint32_t to = coarse.into[static_cast<std::size_t>(fine.neighbour[i])];
        if (to == c) continue;
        if (link_to[to] >= graph.first.back()) {
          graph.weight[link_to[to]] += fine.weight[i];
          continue;
        }
        link_to[to] = static_cast<std::int32_t>(graph.neighbour.size());
        graph.neighbour.push_back(static_cast<std::int32_t>(to));
        graph.weight.push_back(fine.weight[i]);
      }
    }
    graph.first.push_back(static_cast<std::int32_t>(graph.neighbour.size()));
  }
  return coarse;
}

// Which vertices go to the second side, about `share` of them to the first; false if METIS could not.
bool metis_bisect(WeightedGraph& graph, std::vector<std::int32_t>& count, double share, std::vector<idx_t>& side) {
  auto vertices = static_cast<idx_t>(graph.size());
  idx_t constraints = 1;
  idx_t parts = 2;
  idx_t cut = 0;
  real_t shares[2] = {static_cast<real_t>(share), static_cast<real_t>(1.0 - share)};
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_UFACTOR] = 10;
  options[METIS_OPTION_NCUTS] = 1;
  side.resize(graph.size());
  const std::lock_guard lock{metis_door};
  return METIS_PartGraphRecursive(&vertices, &constraints, graph.first.data(), graph.neighbour.data(), count.data(),
                                  nullptr, graph.weight.data(), &parts, shares, nullptr, options, &cut,
                                  side.data()) == METIS_OK;
}

// The same by way of a graph of joined neighbours where there are many vertices.
bool bisect(WeightedGraph& graph, std::vector<std::int32_t>& count, double share, std::vector<idx_t>& side) {
  if (graph.size() <= few_vertices) return metis_bisect(graph, count, share, side);
  Coarse coarse = coarser(graph, count);
  if (coarse.graph.size() > graph.size() / 4 * 3) return metis_bisect(graph, count, share, side);  // hardly any links
  std::vector<idx_t> coarse_side;
  if (!bisect(coarse.graph, coarse.count, share, coarse_side)) return false;
  side.resize(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v) side[v] = coarse_side[coarse.into[v]];
  return true;
}

// Moves vertices from one side to the other, the cheapest first.
class Balance {
 public:
  Balance(const WeightedGraph& graph, std::vector<idx_t>& side) : graph_(graph), side_(side) {}

  void move(idx_t from, std::uint32_t count) {
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
  std::vector<idx_t>& side_;
  std::priority_queue<std::pair<std::int64_t, std::uint32_t>, std::vector<std::pair<std::int64_t, std::uint32_t>>,
                      Later>
      queue_;
};

class Partition {
 public:
  Partition(std::uint32_t vertices, const PartSizes& sizes) : sizes_(sizes), part_(vertices, 0), place_(vertices, 0) {}

  void cut(WeightedGraph graph, const std::vector<std::uint32_t>& vertices, std::uint32_t parts, std::uint32_t first) {
    if (parts == 1) {
      for (const std::uint32_t v : vertices) part_[v] = first;
      return;
    }
    const std::uint32_t count = graph.size();
    const std::uint32_t left = parts / 2;
    const std::uint32_t right = parts - left;
    std::vector<idx_t> side;
    std::vector<std::int32_t> ones(count, 1);
    if (!bisect(graph, ones, static_cast<double>(left) / parts, side)) {
      side.assign(count, 0);
      for (std::uint32_t i = 0; i < count; ++i) side[i] = i < std::uint64_t{count} * left / parts ? 0 : 1;
    }
    const auto now = static_cast<std::uint32_t>(std::count(side.begin(), side.end(), 0));
    const auto low = static_cast<std::uint32_t>(std::max<std::int64_t>(
        std::int64_t{left} * sizes_.min, std::int64_t{count} - std::int64_t{right} * sizes_.max));
    const auto high = static_cast<std::uint32_t>(std::min<std::int64_t>(
        std::int64_t{left} * sizes_.max, std::int64_t{count} - std::int64_t{right} * sizes_.min));
    assert(low <= high);
    if (now < low) Balance{graph, side}.move(1, low - now);
    if (now > high) Balance{graph, side}.move(0, now - high);
    for (idx_t s = 0; s < 2; ++s) {
      std::vector<std::uint32_t> inside;
      WeightedGraph half = part_of(graph, side, s, vertices, inside);
      cut(std::move(half), inside, s == 0 ? left : right, s == 0 ? first : first + left);
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> take() { return std::move(part_); }

 private:
  WeightedGraph part_of(const WeightedGraph& graph, const std::vector<idx_t>& side, idx_t wanted,
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
  Partition partition{graph.size(), sizes};
  std::vector<std::uint32_t> all(graph.size());
  std::iota(all.begin(), all.end(), 0U);
  partition.cut(graph, all, sizes.parts, 0);
  return partition.take();
}

}  // namespace lodestone::partition
