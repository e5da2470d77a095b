// SPDX-License-Identifier: MIT
// What libmeshoptimizer makes of a mesh, by geometry only, in all benchmarks that stand beside it.
#pragma once

#include <meshoptimizer.h>
#include <cstdint>

#include <lodestone/mesh.h>

namespace lodestone {

// Faces keep neither materials nor features: which of them are left is not told.
[[nodiscard]] inline Mesh by_meshoptimizer(const Mesh& mesh, std::uint32_t target_triangles) {
  Mesh result = mesh;
  const std::size_t count =
      meshopt_simplify(result.indices.data(), mesh.indices.data(), mesh.indices.size(), &mesh.vertices.positions[0].x,
                       mesh.vertex_count(), sizeof(glm::vec3), std::size_t{target_triangles} * 3, 1e9F, 0, nullptr);
  result.indices.resize(count);
  result.face_materials.clear();
  result.face_features.clear();
  return result;
}

}  // namespace lodestone
