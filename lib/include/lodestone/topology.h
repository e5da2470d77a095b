// SPDX-License-Identifier: MIT
/// \file
/// How the triangles of a mesh hang together: borders, holes, handles, and where it is no manifold.
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone {

/// By position: wedges at one place are one corner point, so uv seams and creases are no borders. Triangles with two
/// corners on one point are left out.
struct Topology {
  std::uint32_t corner_points = 0;  ///< used by triangles
  std::uint32_t edges = 0;          ///< distinct
  std::uint32_t faces = 0;
  std::uint32_t non_manifold_edges = 0;   ///< three or more faces
  std::uint32_t inconsistent_edges = 0;   ///< two faces that turn opposite ways
  std::uint32_t non_manifold_points = 0;  ///< faces around it form more than one fan

  /// The mesh cut apart along those edges and at those points gives this many manifold, oriented pieces.
  std::uint32_t pieces = 0;
  std::uint32_t closed_pieces = 0;  ///< without any border
  std::uint32_t handles = 0;        ///< sum of the genus of all pieces

  /// Borders of one face each: for every loop around a hole or along an outer border its sides, in the order met. A
  /// side runs from the corner named to the next corner of its triangle. Where loops touch in a point they are told
  /// apart.
  std::vector<std::vector<CornerId>> boundary_loops;
};

/// O(size log size). Precondition: validate(mesh).
[[nodiscard]] Topology analyse_topology(const Mesh& mesh);

}  // namespace lodestone
