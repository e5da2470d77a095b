// SPDX-License-Identifier: MIT
// What is found out about a level once its faces lie in their tiles: borders, and how far it is from the source.
// Nothing of it is needed to make the next level (unless that is to choose its ratio by it), so both can go on at the
// same time.
#pragma once

#include <lodestone/outcrop.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "outcrop/borders.h"
#include "outcrop/deviation.h"

namespace lodestone {

class LevelMeasurer {
 public:
  explicit LevelMeasurer(OutcropPyramid& pyramid) : out_(pyramid) {}

  // The leaf of each face of level 0; before the first measure().
  void take_leaves(std::vector<std::uint32_t> leaf_of_source_face) { leaf_of_face_ = std::move(leaf_of_source_face); }

  // Of the newest level. `tile_of_cell` tells the tile of each leaf there. Touches its mesh and its OutcropLevel only.
  void measure(const std::vector<std::uint32_t>& tile_of_cell, const Context& context);

  // Per tile of the level measured last, 0 at level 0.
  [[nodiscard]] const std::vector<outcrop::TileDeviation>& deviations() const noexcept { return deviations_; }
  [[nodiscard]] double middle_deviation_m() const noexcept { return middle_deviation_m_; }

 private:
  void find_source_borders();
  void keep_borders(const Weld& weld, const outcrop::Borders& borders) const;
  [[nodiscard]] std::vector<std::uint32_t> tile_of_faces() const;
  void hold_against_source(const std::vector<std::uint32_t>& tile_of_cell, const outcrop::Tiled& level,
                           const Context& context);

  OutcropPyramid& out_;
  std::vector<std::uint32_t> leaf_of_face_;  // of the source
  Weld source_weld_;
  std::vector<outcrop::BorderEdge> source_borders_;  // between leaves
  std::vector<std::uint8_t> source_solid_;           // outcrop::solid_points()
  std::unique_ptr<outcrop::Deviation> deviation_;
  std::vector<outcrop::TileDeviation> deviations_;
  double middle_deviation_m_ = 0.0;
};

}  // namespace lodestone
