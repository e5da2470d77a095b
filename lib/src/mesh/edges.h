// SPDX-License-Identifier: MIT
// Undirected edges between corner points, with the faces on each; any number of faces per edge.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/mesh.h>

#include "base/corners.h"
#include "mesh/weld.h"

namespace lodestone {

// One side of a face: from the point of `corner` to that of the next corner of the face.
struct EdgeUse {
  std::uint32_t high = 0;  // the larger of the two points
  CornerId corner = 0;
  bool ascending = true;  // the face runs from the smaller point to the larger

  [[nodiscard]] CornerId corner_at_low() const noexcept { return ascending ? corner : next_corner(corner); }
  [[nodiscard]] CornerId corner_at_high() const noexcept { return ascending ? next_corner(corner) : corner; }
};

// Uses are grouped by edge: edges ascend by (low, high), uses within one by corner. Faces with two corners on one
// point have no edges.
struct EdgeTable {
  std::vector<EdgeUse> uses;
  std::vector<std::uint32_t> first_use;  // per edge, and one past the end
  std::vector<std::uint32_t> low;        // per edge: the smaller of the two points

  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(low.size()); }
  [[nodiscard]] std::span<const EdgeUse> uses_of(std::uint32_t edge) const noexcept {
    return {uses.data() + first_use[edge], uses.data() + first_use[edge + 1]};
  }
};

// O(corners), plus sorting of the few edges that leave each point.
[[nodiscard]] EdgeTable find_edges(const Mesh& mesh, const Weld& weld);

}  // namespace lodestone
