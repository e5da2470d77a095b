// SPDX-License-Identifier: MIT
// A block of two heights: what comes before the prism where a building has a tower, a hall or a floor set back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/facet_shift.h>

#include "facets/footprint.h"

namespace lodestone::facets {

// A flat face of it, upright or level.
struct SteppedFacet {
  enum class Kind : std::uint8_t { Bottom, Top, Side };
  Kind kind = Kind::Side;
  std::vector<std::uint32_t> corners;    // all loops one after the other, the outer one, which turns left, first
  std::vector<std::uint32_t> loop_ends;  // one past the last corner of each
};

// Closed; corners lie on each other's sides nowhere.
struct SteppedShape {
  std::vector<glm::dvec3> corners;
  std::vector<SteppedFacet> facets;
};

// Of the footprint, cut along one wall or two, what lies on one side is higher: the cut that leaves least between shape
// and building. Empty if a prism is nearly as good, or if the parts are not whole.
[[nodiscard]] std::optional<SteppedShape> find_step(const Mesh& mesh, const CharacteristicSurfaces& surfaces,
                                                    const Footprint& footprint);

}  // namespace lodestone::facets
