// SPDX-License-Identifier: MIT
// Which cells are tiles at which level: simplify and merge from the bottom up.
#pragma once

#include <cstdint>
#include <vector>

#include "outcrop/cells.h"

namespace lodestone::outcrop {

// Bytes of the tile of each cell that is one at the present level.
struct CellBytes {
  std::vector<double> geometry, texture;  // per cell
};

// The cells that hold the surface at one level, ascending; every leaf lies in exactly one.
class Front {
 public:
  explicit Front(const CellTree& tree);

  // One level up: cells whose parent's children are all here, and together small enough after scaling by the two
  // shares (equation 2), are replaced by the parent; the others stay. `force` merges whatever can.
  // Returns false if nothing was merged.
  bool merge(const CellBytes& bytes, double geometry_share, double texture_share, double tile_bytes, bool force);

  [[nodiscard]] const std::vector<std::uint32_t>& cells() const noexcept { return cells_; }
  // Per cell: the place in cells() of the one it lies in, itself included; none above the front.
  [[nodiscard]] std::vector<std::uint32_t> cover() const;

 private:
  const CellTree& tree_;
  std::vector<std::uint32_t> cells_;
};

}  // namespace lodestone::outcrop
