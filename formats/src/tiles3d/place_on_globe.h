// SPDX-License-Identifier: MIT
// Where a local frame lies on the earth.
#pragma once

#include <array>
#include <string>

#include <lodestone/result.h>
#include <lodestone/types.h>

namespace lodestone {

// Column by column, as 3D Tiles writes it.
using Transform = std::array<double, 16>;

// Takes coordinates relative to `origin` in the system `crs` (metres, Z up) to the earth-centred frame of EPSG:4978:
// the tangent of the projection at the origin. Over a kilometre it is off by the curvature, some 8 cm. Errors: BadData
// if PROJ does not know the system or the place.
[[nodiscard]] Result<Transform> place_on_globe(const glm::dvec3& origin, const std::string& crs);

}  // namespace lodestone
