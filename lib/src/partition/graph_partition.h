// SPDX-License-Identifier: MIT
// Cuts a weighted graph into parts of bounded size with few and light edges between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lodestone::partition {

// Each edge is listed at both ends. Weights are positive.
struct WeightedGraph {
  std::vector<std::int32_t> first;  // per vertex, and one past the end
  std::vector<std::int32_t> neighbour;
  std::vector<std::int32_t> weight;

  [[nodiscard]] std::uint32_t size() const noexcept {
    return first.empty() ? 0 : static_cast<std::uint32_t>(first.size() - 1);
  }
};

struct WeightedEdge {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  std::int32_t weight = 1;
};

// Edges in any order, each given once; edges given several times, or from a vertex to itself, may occur: weights add
// up.
[[nodiscard]] WeightedGraph make_graph(std::uint32_t vertex_count, std::span<const WeightedEdge> edges);

// How many parts, and how many vertices each may have. Preconditions: parts * min <= vertices <= parts * max.
struct PartSizes {
  std::uint32_t parts = 1;
  std::uint32_t min = 1;
  std::uint32_t max = 1;
};

// The part of each vertex, 0..parts-1; the sizes are kept without exception. Depends on the input only.
[[nodiscard]] std::vector<std::uint32_t> partition_graph(const WeightedGraph& graph, const PartSizes& sizes);

}  // namespace lodestone::partition
