// SPDX-License-Identifier: MIT
// The faces around an edge (u, v), with everything a collapse needs to know about them.
#pragma once

#include <cstdint>
#include <vector>

#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// Which end of the edge a face touches.
enum class Side : std::uint8_t { U, V, Both };

// A face seen from its corner at u (sides U and Both) or at v (side V): a and b are the next two points.
// Places are relative to u.
struct StarFace {
  StarFace(std::uint32_t face, std::uint32_t corner, std::uint32_t next, std::uint32_t previous, Side on,
           const glm::dvec3& next_at, const glm::dvec3& previous_at, const glm::dvec3& across) noexcept
      : index(face), k(corner), a(next), b(previous), side(on), at_a(next_at), at_b(previous_at), normal(across) {}

  std::uint32_t index;  // in WorkingMesh::faces
  std::uint32_t k;      // corner at the near end
  std::uint32_t a, b;
  Side side;
  bool twin = false;  // would coincide with an earlier face of the star: goes with the collapse
  glm::dvec3 at_a, at_b;
  glm::dvec3 normal;  // twice the area long
};

// An edge at u or v that is a line: border, three and more faces, seam, material border or sharp.
struct StarLine {
  std::uint32_t from = 0, to = 0;  // from is u or v
  glm::dvec3 direction{0.0};
};

struct Star {
  std::uint32_t u = 0, v = 0;
  glm::dvec3 e{0.0};  // from u to v
  std::vector<StarFace> faces;
  std::vector<StarLine> lines;
  std::uint32_t shared = 0;  // faces on the edge
  std::uint32_t faces_of_u = 0;
  std::uint32_t faces_of_v = 0;
  bool plain = false;  // closed manifold rings at both ends, no lines
};

// Fills `star` for the edge.
void gather_star(const WorkingMesh& mesh, std::uint32_t u, std::uint32_t v, Star& star);

}  // namespace lodestone::collapse
