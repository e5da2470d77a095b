// SPDX-License-Identifier: MIT
// Doors and gates that reach the foot of their wall: no holes in it but notches in its outline.
#pragma once

#include <vector>

#include "facets/walls.h"

namespace lodestone::facets {

// Where the lower side of the outline, which turns left around the wall, goes up and comes down on the same line. Each
// as a loop with the wall to its left whose last side, from the last point to the first, is the side that is missing.
[[nodiscard]] std::vector<Opening> find_notches(const FacetMesh& mesh, const std::vector<std::uint32_t>& outline,
                                                const glm::dvec3& normal);

}  // namespace lodestone::facets
