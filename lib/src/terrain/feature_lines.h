// SPDX-License-Identifier: MIT
// Sharp edges of the ground as lines of posts, and their simplification without crossing each other.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "terrain/lattice.h"

namespace lodestone::terrain {

using FeatureLine = std::vector<Post>;

// Lines of at least `least_edges` edges between posts inside the tile whose two triangles are turned by more than
// `angle_rad` against each other, in coordinates scaled to the unit cube. They end where other than two edges meet.
[[nodiscard]] std::vector<FeatureLine> feature_lines(const TileLattice& lattice, double angle_rad,
                                                     std::uint32_t least_edges);

// Takes vertices out of lines, the least noticed first, while every post that was on a line is within `tolerance_m` of
// it in space. No line comes to lie on another side of another line or of one of `others`. Ends stay.
void simplify_lines(std::vector<FeatureLine>& lines, const TileLattice& lattice, const glm::dvec2& spacing_m,
                    std::span<const Post> others, double tolerance_m);

}  // namespace lodestone::terrain
