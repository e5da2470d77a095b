// SPDX-License-Identifier: MIT
// Simplifiers of others, each behind one function in a file of its own. Geometry only; a triangle that CGAL's mesh
// cannot hold (a third face at an edge) is left out and counted.
#pragma once

#include <cstdint>

#include <lodestone/mesh.h>

namespace lodestone::peers {

struct Outcome {
  Mesh mesh;
  std::uint32_t refused_triangles = 0;
  double seconds = 0.0;  // processor time of the thread, without the conversions
};

[[nodiscard]] Outcome by_openmesh(const Mesh& mesh, std::uint32_t target_triangles);
#ifdef LODESTONE_PEER_CGAL
[[nodiscard]] Outcome by_garland_heckbert(const Mesh& mesh, std::uint32_t target_triangles);
[[nodiscard]] Outcome by_lindstrom_turk(const Mesh& mesh, std::uint32_t target_triangles);
#endif

}  // namespace lodestone::peers
