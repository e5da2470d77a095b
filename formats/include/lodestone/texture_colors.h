// SPDX-License-Identifier: MIT
/// \file
/// What colour textures have on the whole, for builders that compare looks without decoding whole images.
///
///     auto built = lodestone::build_by_facet_shift(mesh, {.texture_colors = lodestone::mean_texture_colors(mesh)});
#pragma once

#include <vector>

#include <lodestone/mesh.h>

namespace lodestone {

/// One for each texture: sRGB, 0..1, the mean of its pixels, from pixels, bytes or file, whichever is there. What
/// cannot be read is white, as it is drawn. A JPEG is decoded at an eighth of its size: about 2 ms for a million
/// pixels.
[[nodiscard]] std::vector<glm::vec3> mean_texture_colors(const Surroundings& source);

}  // namespace lodestone
