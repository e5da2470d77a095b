// SPDX-License-Identifier: MIT
// Which faces can be seen from outside.
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/facet_shift.h>

namespace lodestone::facets {

// Per surface of `surfaces` whether any of its faces is seen from far away, from any side. Faces of transparent
// materials hide nothing. By samples: what is seen through slits narrower than about 1/400 of the building counts as
// unseen. O(directions * (faces + pixels)).
[[nodiscard]] std::vector<std::uint8_t> seen_surfaces(const Mesh& mesh, const CharacteristicSurfaces& surfaces);

// The one of `count` that are spread evenly over the sphere.
[[nodiscard]] glm::dvec3 spiral_direction(int i, int count);

}  // namespace lodestone::facets
