// SPDX-License-Identifier: MIT
// A first cut of a graph into parts.
#pragma once

#include <cstdint>
#include <vector>

#include "partition/graph_partition.h"

namespace lodestone::partition {

// The part of each vertex, 0..parts-1. Sizes are about equal; parts with neighbouring numbers lie near each other, so
// that the first half of the numbers is a good half of the graph, and so on downwards.
[[nodiscard]] std::vector<std::int32_t> first_parts(const WeightedGraph& graph, std::uint32_t parts);

}  // namespace lodestone::partition
