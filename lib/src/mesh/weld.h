// SPDX-License-Identifier: MIT
// Corner points: vertices (wedges) that share a position bit for bit (-0 taken as 0) are one point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone {

struct Weld {
  std::vector<std::uint32_t> point_of;  // per vertex
  std::vector<VertexId> first_vertex;   // per point: the first vertex there; points are numbered in this order

  [[nodiscard]] std::uint32_t point_count() const noexcept { return static_cast<std::uint32_t>(first_vertex.size()); }
};

[[nodiscard]] Weld weld_by_position(std::span<const glm::vec3> positions);

// True if two of the three corners are one point.
[[nodiscard]] inline bool collapsed(const Weld& weld, const VertexId* face) noexcept {
  const std::uint32_t a = weld.point_of[face[0]];
  const std::uint32_t b = weld.point_of[face[1]];
  const std::uint32_t c = weld.point_of[face[2]];
  return a == b || b == c || c == a;
}

// Area vector (twice the area long) of a face, in double.
[[nodiscard]] inline glm::dvec3 area_vector(const Mesh& mesh, FaceId f) noexcept {
  const auto& p = mesh.vertices.positions;
  const VertexId* v = &mesh.indices[3 * std::size_t{f}];
  const glm::dvec3 a{p[v[0]]};
  return glm::cross(glm::dvec3{p[v[1]]} - a, glm::dvec3{p[v[2]]} - a);
}

}  // namespace lodestone
