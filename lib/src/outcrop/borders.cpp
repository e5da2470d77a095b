// SPDX-License-Identifier: MIT
#include "outcrop/borders.h"

#include <algorithm>

#include "mesh/edges.h"

namespace lodestone::outcrop {

Borders find_borders(std::span<const VertexId> indices, const Weld& weld,
                     std::span<const std::uint32_t> owner_of_face) {
  struct Use {
    std::uint64_t edge;
    std::uint32_t owner;
  };
  std::vector<Use> uses;
  uses.reserve(indices.size());
  for (CornerId c = 0; c < indices.size(); ++c) {
    const std::uint64_t p = weld.point_of[indices[c]];
    const std::uint64_t q = weld.point_of[indices[next_corner(c)]];
    if (p != q) uses.push_back({std::min(p, q) << 32U | std::max(p, q), owner_of_face[c / 3]});
  }
  std::sort(uses.begin(), uses.end(),
            [](const Use& x, const Use& y) { return x.edge != y.edge ? x.edge < y.edge : x.owner < y.owner; });
  Borders result;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    for (; end < uses.size() && uses[end].edge == uses[i].edge; ++end) {
      if (uses[end].owner == uses[end - 1].owner) continue;
      result.edges.push_back({static_cast<std::uint32_t>(uses[i].edge >> 32U), static_cast<std::uint32_t>(uses[i].edge),
                              uses[end - 1].owner, uses[end].owner});
    }
    if (end == i + 1) ++result.open_edges;
    i = end;
  }
  return result;
}

}  // namespace lodestone::outcrop
