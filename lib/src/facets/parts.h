// SPDX-License-Identifier: MIT
// Detached parts that lie on, in or near the rest: frames, bars, railings, pipes, antennas.
#pragma once

#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

struct Part {
  std::vector<FaceId> faces;
  std::vector<std::uint32_t> support;  // points of the faces that it lies upon
  double error_m = 0.0;                // farthest point of it from the rest
  double cost = 0.0;                   // integral of squared distance
};

// All parts but the largest whose every point is within `limit_m` of the rest, by cost per face.
[[nodiscard]] std::vector<Part> find_parts(const FacetMesh& mesh, double limit_m);

}  // namespace lodestone::facets
