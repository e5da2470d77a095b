// SPDX-License-Identifier: MIT
// What those who know no attributes are given: peers in benchmarks, and we beside them.
#pragma once

#include <lodestone/mesh.h>

namespace lodestone::test {

// Positions and triangles, vertices of equal position merged, one plain material.
inline Mesh positions_only(const Mesh& mesh) {
  Mesh result;
  result.materials.emplace_back();
  result.vertices.positions = mesh.vertices.positions;
  result.indices = mesh.indices;
  merge_identical_vertices(result);
  return result;
}

}  // namespace lodestone::test
