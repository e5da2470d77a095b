// SPDX-License-Identifier: MIT
#include "partition/graph_partition.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "base/rng.h"

namespace lodestone::partition {
namespace {

WeightedGraph square_lattice(std::uint32_t side) {
  std::vector<WeightedEdge> edges;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      if (x + 1 < side) edges.push_back({y * side + x, y * side + x + 1, 1});
      if (y + 1 < side) edges.push_back({y * side + x, (y + 1) * side + x, 1});
    }
  }
  return make_graph(side * side, edges);
}

std::vector<std::uint32_t> sizes_of(const std::vector<std::uint32_t>& part, std::uint32_t parts) {
  std::vector<std::uint32_t> sizes(parts, 0);
  for (const std::uint32_t p : part) ++sizes.at(p);
  return sizes;
}

}  // namespace

TEST_CASE("edges given several times add up and loops are left out") {
  const std::vector<WeightedEdge> edges{{0, 1, 2}, {1, 0, 3}, {1, 1, 9}, {1, 2, 1}};
  const WeightedGraph graph = make_graph(3, edges);
  REQUIRE(graph.first == std::vector<std::int32_t>{0, 1, 3, 4});
  REQUIRE(graph.neighbour == std::vector<std::int32_t>{1, 0, 2, 1});
  REQUIRE(graph.weight == std::vector<std::int32_t>{5, 5, 1, 1});
}

TEST_CASE("parts keep the sizes asked for, however tight, also where the graph is in pieces") {
  const WeightedGraph lattice = square_lattice(50);
  for (const PartSizes& sizes : {PartSizes{20, 125, 125}, PartSizes{20, 124, 128}, PartSizes{7, 300, 400}}) {
    const auto counts = sizes_of(partition_graph(lattice, sizes), sizes.parts);
    REQUIRE(*std::min_element(counts.begin(), counts.end()) >= sizes.min);
    REQUIRE(*std::max_element(counts.begin(), counts.end()) <= sizes.max);
  }
  const WeightedGraph loose = make_graph(1000, std::vector<WeightedEdge>{{0, 1, 1}, {5, 6, 1}});
  const auto counts = sizes_of(partition_graph(loose, {8, 125, 125}), 8);
  REQUIRE(std::count(counts.begin(), counts.end(), 125U) == 8);
}

TEST_CASE("parts of a lattice are compact and the same each time") {
  const WeightedGraph lattice = square_lattice(64);
  const auto part = partition_graph(lattice, {32, 128, 128});
  std::uint32_t cut = 0;
  for (std::uint32_t v = 0; v < lattice.size(); ++v) {
    for (std::int32_t i = lattice.first[v]; i != lattice.first[v + 1]; ++i) {
      cut += part[v] != part[static_cast<std::size_t>(lattice.neighbour[i])] ? 1U : 0U;
    }
  }
  // 32 rectangles of 8 x 16 would cut 704 edges.
  REQUIRE(cut / 2 < 1000);
  REQUIRE(partition_graph(lattice, {32, 128, 128}) == part);
}

}  // namespace lodestone::partition
