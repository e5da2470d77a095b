// SPDX-License-Identifier: MIT
// Walls small enough to know every face of.
#pragma once

#include <lodestone/mesh.h>

namespace lodestone::test {

// A wall 10 m wide and 6 m high in the plane y = 0, seen from y < 0, with a square of 1 m that lies `depth_m` behind it
// (before it if negative) and the four sides between.
[[nodiscard]] inline Mesh wall_with_panel(float depth_m) {
  Mesh mesh;
  mesh.materials.emplace_back();
  auto& p = mesh.vertices.positions;
  p = {{0, 0, 0}, {10, 0, 0}, {10, 0, 6}, {0, 0, 6}, {4, 0, 2}, {5, 0, 2}, {5, 0, 3}, {4, 0, 3}};
  for (std::uint32_t i = 4; i < 8; ++i) p.push_back({p[i].x, depth_m, p[i].z});
  const auto quad = [&](VertexId a, VertexId b, VertexId c, VertexId d) {
    mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
  };
  for (VertexId i = 0; i < 4; ++i) {
    const VertexId j = (i + 1) % 4;
    quad(i, j, 4 + j, 4 + i);
    quad(4 + i, 4 + j, 8 + j, 8 + i);
  }
  quad(8, 9, 10, 11);
  return mesh;
}

}  // namespace lodestone::test
