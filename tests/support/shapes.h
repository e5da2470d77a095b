// SPDX-License-Identifier: MIT
// Tiny meshes made in code, and families of meshes that every algorithm must survive.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone::test {

[[nodiscard]] Mesh tetrahedron();
[[nodiscard]] Mesh cube();                                               // 8 vertices, 12 triangles, 2 m wide
[[nodiscard]] Mesh sphere(std::uint32_t rings, std::uint32_t segments);  // closed, with normals
[[nodiscard]] Mesh grid(std::uint32_t nx, std::uint32_t ny, float height_m = 0.1F);  // open border, uv, bumpy
[[nodiscard]] Mesh unwelded(const Mesh& mesh);                       // three vertices per face, flat normals
[[nodiscard]] Mesh seamed_grid(std::uint32_t nx, std::uint32_t ny);  // a grid with a uv seam and two materials
[[nodiscard]] Mesh fins(std::uint32_t fins);                         // faces that share one edge (non-manifold)
[[nodiscard]] Mesh scattered_cubes(std::uint32_t count, std::uint64_t seed);  // many small parts

struct NamedMesh {
  std::string name;
  Mesh mesh;
};
// closed, bordered, seamed, unwelded, non-manifold, degenerate, duplicate, many parts, empty, single triangle
[[nodiscard]] std::vector<NamedMesh> mesh_families();

}  // namespace lodestone::test
