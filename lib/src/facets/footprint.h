// SPDX-License-Identifier: MIT
// The outline of a building on the ground, along its main walls.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <lodestone/facet_shift.h>

namespace lodestone::facets {

struct Footprint {
  std::vector<glm::dvec2> corners;       // all loops one after the other, the outer one, which turns left, first
  std::vector<std::uint32_t> loop_ends;  // one past the last corner of each
  double low_m = 0.0;
  double high_m = 0.0;   // half of the ground is covered up to there or higher
  std::string sentence;  // why there is none, empty if there is one

  [[nodiscard]] std::uint32_t corner_count() const noexcept { return static_cast<std::uint32_t>(corners.size()); }
};

// At most `most_corners` corners, at least 4.
[[nodiscard]] Footprint find_footprint(const Mesh& mesh, const CharacteristicSurfaces& surfaces,
                                       std::uint32_t most_corners);

}  // namespace lodestone::facets
