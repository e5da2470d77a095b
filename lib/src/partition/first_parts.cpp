// SPDX-License-Identifier: MIT
// Based on: Karypis and Kumar 1998 (multilevel recursive bisection), by their library METIS; this is the only file that
// names it.
// Differs: neighbours are joined here until a graph is small, because METIS, built for large graphs, takes longer for
// that.
#include "partition/first_parts.h"

#include <metis.h>

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>

namespace lodestone::partition {
namespace {

// METIS draws from rand() and sets signal handlers, both of the whole process: one call at a time, each with its own
// seed.
std::mutex metis_door;

// To so many for each part vertices are joined. With 16 METIS takes a fifth less, but 6 to 12 % more vertices are
// locked later, and with 8 it is 15 to 25 %.
constexpr std::uint32_t vertices_per_part = 32;

constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();

// A graph, how much each of its vertices counts, and, where it was made by joining neighbours, which one each vertex of
// the finer graph went into.
struct Coarse {
  WeightedGraph graph;
  std::vector<std::int32_t> count;
  std::vector<std::uint32_t> into;
};

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

// False if METIS could not.
bool metis_parts(WeightedGraph& graph, std::vector<std::int32_t>& count, std::uint32_t parts,
                 std::vector<std::int32_t>& part) {
  static_assert(sizeof(idx_t) == sizeof(std::int32_t));
  auto vertices = static_cast<idx_t>(graph.size());
  auto part_count = static_cast<idx_t>(parts);
  idx_t constraints = 1;
  idx_t cut = 0;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_UFACTOR] = 10;
  options[METIS_OPTION_NCUTS] = 1;
  part.resize(graph.size());
  const std::lock_guard lock{metis_door};
  return METIS_PartGraphRecursive(&vertices, &constraints, graph.first.data(), graph.neighbour.data(), count.data(),
                                  nullptr, graph.weight.data(), &part_count, nullptr, nullptr, options, &cut,
                                  part.data()) == METIS_OK;
}

bool find_parts(WeightedGraph graph, std::vector<std::int32_t> count, std::uint32_t parts,
                std::vector<std::int32_t>& part) {
  if (graph.size() <= vertices_per_part * parts) return metis_parts(graph, count, parts, part);
  Coarse coarse = coarser(graph, count);
  if (coarse.graph.size() > graph.size() / 8 * 7) return metis_parts(graph, count, parts, part);  // hardly any links
  std::vector<std::int32_t> joined;
  if (!find_parts(std::move(coarse.graph), std::move(coarse.count), parts, joined)) return false;
  part.resize(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v) part[v] = joined[coarse.into[v]];
  return true;
}

}  // namespace

std::vector<std::int32_t> first_parts(const WeightedGraph& graph, std::uint32_t parts) {
  std::vector<std::int32_t> part;
  if (!find_parts(graph, std::vector<std::int32_t>(graph.size(), 1), parts, part)) {
    part.resize(graph.size());
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      part[v] = static_cast<std::int32_t>(std::uint64_t{v} * parts / graph.size());
    }
  }
  return part;
}

}  // namespace lodestone::partition
