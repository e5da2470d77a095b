// SPDX-License-Identifier: MIT
// A record that is neither a move nor a vanishing: faces drawn anew between other corners.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

struct Redrawn {
  FaceId face = none;
  std::array<std::uint32_t, 3> point{};
  std::array<VertexId, 3> vertex{};
};

struct Placed {
  VertexId vertex = none;
  std::uint32_t point = none;  // where it goes
  glm::vec2 uv{0.0F};
  glm::vec3 normal{0.0F};  // zero: keeps its own
};

struct Merged {
  VertexId vertex = none;
  VertexId onto = none;
};

struct Patch {
  std::vector<std::pair<std::uint32_t, glm::vec3>> moved;  // points that only redrawn faces will use, to their places
  std::vector<FaceId> gone;
  std::vector<Redrawn> redrawn;
  std::vector<Placed> placed;
  std::vector<Merged> merged;    // where vertices go that nothing uses any more; others stay where they are
  std::uint32_t surface = none;  // that the redrawn faces belong to from now on
  glm::dvec3 normal{0.0};        // of its plane
};

// Does it, as one record.
void apply(FacetMesh& mesh, const Patch& patch, double error_m, progressive::EditLog& log);

}  // namespace lodestone::facets
