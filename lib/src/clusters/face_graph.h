// SPDX-License-Identifier: MIT
// Which faces of a piece of mesh are neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clusters/live.h"
#include "partition/graph_partition.h"

namespace lodestone::clusters {

// An edge of a face: ids of its two points, the smaller first.
struct EdgeOfFace {
  std::uint32_t low = 0, high = 0;
  std::uint32_t face = 0;
};

// All edges of faces given by three points each, equal edges next to each other. Faces with two equal corners have
// none.
[[nodiscard]] std::vector<EdgeOfFace> sorted_edges(std::span<const std::array<std::uint32_t, 3>> faces,
                                                   std::uint32_t point_count);

// Three points per face, renumbered 0..point_count-1 in order of first use.
struct LocalPoints {
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint32_t> points;  // per local point: the point
};
[[nodiscard]] LocalPoints local_points(std::span<const LiveFace> faces, std::span<const std::uint32_t> point_of);

// The order of places along a space-filling curve.
[[nodiscard]] std::vector<std::uint32_t> morton_order(std::span<const glm::vec3> places);

// Faces that share an edge (by position) are linked, and along a space-filling curve those next to each other that are
// not connected, weakly.
[[nodiscard]] partition::WeightedGraph face_graph(std::span<const LiveFace> faces, const Ground& ground);

}  // namespace lodestone::clusters
