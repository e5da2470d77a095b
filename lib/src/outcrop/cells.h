// SPDX-License-Identifier: MIT
// The tree of cells that tiles are merged along: quadtrees over the images, joined by a grid over the outcrop.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "outcrop/segments.h"

namespace lodestone::outcrop {

// Children come before parents; the last cell is the root. Empty cells are left out.
struct Cell {
  std::vector<std::uint32_t> children;  // none for a leaf
  std::uint32_t parent = none;
};

struct CellTree {
  std::vector<Cell> cells;
  std::vector<std::uint32_t> leaf_of_face;  // per face of the mesh: its cell
};

// Bytes that tiles aim at and what the source's data weighs.
struct ByteModel {
  double tile_geometry = 0.0, tile_texture = 0.0;  // V_t, apart for the two
  double per_triangle = 0.0;
  std::vector<double> per_texel;  // per segment, of the used part
};

// Chooses each segment's split where it is left open (`segments[i].split` says what was taken).
[[nodiscard]] CellTree make_cells(const Mesh& mesh, Segmentation& segmentation, const ByteModel& bytes,
                                  TileSplit split);

}  // namespace lodestone::outcrop
