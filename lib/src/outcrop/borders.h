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
  std::vector<BorderEdge> edges;           // ascending by (a, b)
  std::uint32_t open_edges = 0;            // used by one face
  std::vector<std::uint32_t> open_points;  // the two ends of each
};

// `owner_of_face` is per face. Faces with two corners on one point are left out. O(n log n).
[[nodiscard]] Borders find_borders(std::span<const VertexId> indices, const Weld& weld,
                                   std::span<const std::uint32_t> owner_of_face);

// Per point: whether a face with an area uses it. Empty if that is so for all points that faces use.
[[nodiscard]] std::vector<std::uint8_t> solid_points(const std::vector<glm::vec3>& positions,
                                                     std::span<const VertexId> indices, const Weld& weld);

[[nodiscard]] inline bool is_before(const glm::vec3& a, const glm::vec3& b) noexcept {
  return a.x != b.x ? a.x < b.x : (a.y != b.y ? a.y < b.y : a.z < b.z);
}

// Per face: bit k is set if the edge from its corner k to the next is one of `edges`.
[[nodiscard]] std::vector<std::uint8_t> border_bits(std::span<const VertexId> indices, const Weld& weld,
                                                    std::span<const BorderEdge> edges);

}  // namespace lodestone::outcrop
