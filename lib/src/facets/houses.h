// SPDX-License-Identifier: MIT
// Tells the houses of a street apart.
#pragma once

#include <cstdint>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

struct Houses {
  std::uint32_t count = 1;
  std::vector<std::uint32_t> house_of_face;  // `none`: the ground, or what stands alone and is too small for a house
};

// By the features of class Building where the source has two or more; else by what stands over the same ground: parts
// that hang together belong to the larger part that covers them. Precondition: nothing has changed in the mesh yet.
[[nodiscard]] Houses tell_houses(const FacetMesh& mesh);

}  // namespace lodestone::facets
