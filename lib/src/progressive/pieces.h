// SPDX-License-Identifier: MIT
// Where T-junctions were closed, triangles of the source stand in pieces.
#pragma once

#include <vector>

#include <lodestone/mesh.h>

namespace lodestone::progressive {

struct Uncovered {
  FaceId whole = none;  // a triangle that its pieces do not cover
  FaceId piece = none;  // a piece that is no part of any triangle
};

// Whether each of the triangles `wholes` of `source` is covered exactly by some of `pieces` of `cut`: in its plane, of
// its material and feature, turning the same way, with its vertices at its corners and interpolated attributes between
// them. What is not is named; needles thinner than 2 mm may fill cracks besides. O(wholes * pieces) at worst.
[[nodiscard]] Uncovered find_uncovered(const Mesh& source, const std::vector<FaceId>& wholes, const Mesh& cut,
                                       const std::vector<FaceId>& pieces);

}  // namespace lodestone::progressive
