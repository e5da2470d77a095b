// SPDX-License-Identifier: MIT
// Where tiles meet: the edges between them, and the true border of the outcrop.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/weld.h"

namespace lodestone::outcrop {

// Between corner points a < b, with a face of `left` and one of `right` on it, left < right.
struct BorderEdge {
  std::uint32_t a = 0, b = 0;
  std::uint32_t left = 0, right = 0;
};

struct Borders {
  std::vector<BorderEdge> edges;  // ascending by (a, b)
  std::uint32_t open_edges = 0;   // used by one face
};

// `owner_of_face` is per face. O(n log n).
[[nodiscard]] Borders find_borders(std::span<const VertexId> indices, const Weld& weld,
                                   std::span<const std::uint32_t> owner_of_face);

}  // namespace lodestone::outcrop
