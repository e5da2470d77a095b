// SPDX-License-Identifier: MIT
#include <cassert>

#include <lodestone/outcrop.h>

namespace lodestone {

AssembledGraph OutcropPyramid::graph() const {
  std::vector<GroupDraft> groups;
  std::vector<NodeDraft> nodes;
  std::vector<GroupId> group_of(tiles_.size(), none);
  const auto sphere_of = [](const OutcropTile& tile) {
    return Sphere{tile.bounds.center(), 0.5 * tile.bounds.diagonal_m()};
  };
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    if (tiles_[i].children.empty()) continue;
    group_of[i] = static_cast<GroupId>(groups.size());
    groups.push_back({sphere_of(tiles_[i]), tiles_[i].error_m});
  }
  for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
    const OutcropTile& tile = tiles_[i];
    nodes.push_back({.bounds = sphere_of(tile),
                     .triangle_count = tile.triangles,
                     .group = tile.parent == none ? none : group_of[tile.parent],
                     .maker = group_of[i]});
  }
  auto assembled = assemble_graph(groups, nodes);
  assert(assembled);  // a tree with finite numbers
  return std::move(*assembled);
}

}  // namespace lodestone
