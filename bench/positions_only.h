// SPDX-License-Identifier: MIT
// What peers that know no attributes are given, and so are we beside them.
#pragma once

#include <lodestone/mesh.h>

namespace lodestone::bench {

// Positions and triangles, vertices of equal position merged, one plain material.
inline Mesh positions_only(const Mesh& mesh) {
  Mesh result;
  result.materials.emplace_back();
  result.vertices.positions = mesh.vertices.positions;
  result.indices = mesh.indices;
  merge_identical_vertices(result);
  return result;
}

}  // namespace lodestone::bench
