// SPDX-License-Identifier: MIT
// Mends a cut of a graph into two sides.
#pragma once

#include <cstdint>
#include <vector>

#include "partition/graph_partition.h"

namespace lodestone::partition {

// How many vertices the first side may have.
struct SideRange {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

// Moves vertices between the sides so that what is cut gets lighter, and so that the first side comes into its range
// where moves along the border can bring it there. `side`: 0 or 1 per vertex.
void refine(const WeightedGraph& graph, const SideRange& range, std::vector<std::int32_t>& side);

}  // namespace lodestone::partition
