// SPDX-License-Identifier: MIT
// Which side of a model to look at first.
#pragma once

#include "camera.h"
#include "geometry.h"

namespace lodestone::render {

/// The yaw of a three-quarter view, one of four, that most triangles face: the street side of a building, the face of a
/// cliff. The usual one (Orbit's default) unless another shows a tenth more. O(triangles).
[[nodiscard]] double detailed_yaw_rad(const DrawArrays& arrays);

}  // namespace lodestone::render
