// SPDX-License-Identifier: MIT
#pragma once

#include <lodestone/mesh.h>

#include <catch2/catch.hpp>

namespace lodestone::test {

// A closed prism: nothing but upright and level faces, no open side, turned outwards.
inline void check_block(const Mesh& mesh) {
  const MeshReport found = inspect(mesh);
  CHECK(found.boundary_edges == 0);
  CHECK(found.non_manifold_edges == 0);
  CHECK(found.components == 1);
  double volume = 0.0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const auto at = [&](std::uint32_t k) {
      return glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
    };
    const glm::dvec3 n = glm::normalize(glm::cross(at(1) - at(0), at(2) - at(0)));
    CHECK((std::abs(n.z) < 1e-4 || std::abs(n.z) > 1.0 - 1e-4));
    volume += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
  }
  CHECK(volume > 0.0);
}

}  // namespace lodestone::test
