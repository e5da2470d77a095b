// SPDX-License-Identifier: MIT
// Faces that pass through each other.
#pragma once

#include <cstdint>

#include <lodestone/mesh.h>

namespace lodestone::test {

// Pairs of faces of which an edge of one pierces the other, deeper than `touch_m`. Only faces that hang together by
// points, by whatever way, are asked: parts may stand in each other.
[[nodiscard]] std::uint32_t count_crossings(const Mesh& mesh, double touch_m = 2e-3);

}  // namespace lodestone::test
