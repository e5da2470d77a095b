// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, section 3.2.2 (equation 2; one-to-four and one-to-one parents, the pseudo-quadtree).
#include "outcrop/tree.h"

#include <algorithm>

namespace lodestone::outcrop {

Front::Front(const CellTree& tree) : tree_(tree) {
  for (std::uint32_t c = 0; c < tree.cells.size(); ++c) {
    if (tree.cells[c].children.empty()) cells_.push_back(c);
  }
}

bool Front::merge(const CellBytes& bytes, double geometry_share, double texture_share, double tile_bytes, bool force) {
  std::vector<std::uint8_t> here(tree_.cells.size(), 0);
  for (const std::uint32_t c : cells_) here[c] = 1;
  std::vector<std::uint32_t> next;
  bool merged = false;
  for (std::uint32_t c = 0; c < tree_.cells.size(); ++c) {
    const std::vector<std::uint32_t>& children = tree_.cells[c].children;
    if (children.empty()) continue;
    if (!std::all_of(children.begin(), children.end(), [&](std::uint32_t child) { return here[child] == 1; })) continue;
    double after = 0.0;
    for (const std::uint32_t child : children) {
      after += bytes.geometry[child] * geometry_share + bytes.texture[child] * texture_share;
    }
    if (after >= tile_bytes && !force) continue;
    for (const std::uint32_t child : children) here[child] = 0;
    here[c] = 2;  // not to be merged again at this level
    merged = true;
  }
  for (std::uint32_t c = 0; c < here.size(); ++c) {
    if (here[c] != 0) next.push_back(c);
  }
  cells_.swap(next);
  return merged;
}

std::vector<std::uint32_t> Front::cover() const {
  std::vector<std::uint32_t> result(tree_.cells.size(), none);
  for (std::uint32_t i = 0; i < cells_.size(); ++i) result[cells_[i]] = i;
  for (std::uint32_t c = static_cast<std::uint32_t>(result.size()); c-- > 0;) {  // parents come later
    const std::uint32_t parent = tree_.cells[c].parent;
    if (result[c] == none && parent != none) result[c] = result[parent];
  }
  return result;
}

}  // namespace lodestone::outcrop
