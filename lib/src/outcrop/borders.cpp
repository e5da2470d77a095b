// SPDX-License-Identifier: MIT
#include "outcrop/borders.h"

#include <algorithm>
#include <utility>

#include "mesh/edges.h"
#include "mesh/weld.h"

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
    if (collapsed(weld, &indices[c - c % 3])) continue;  // is in no coarser level
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
    if (end == i + 1) {
      ++result.open_edges;
      result.open_points.push_back(static_cast<std::uint32_t>(uses[i].edge >> 32U));
      result.open_points.push_back(static_cast<std::uint32_t>(uses[i].edge));
    }
    i = end;
  }
  return result;
}

std::vector<std::uint8_t> solid_points(const std::vector<glm::vec3>& positions, std::span<const VertexId> indices,
                                       const Weld& weld) {
  std::vector<std::uint8_t> solid(weld.point_count(), 0);
  std::vector<CornerId> flat;  // where faces without area begin
  for (CornerId c = 0; c < indices.size(); c += 3) {
    const auto at = [&](CornerId k) { return glm::dvec3{positions[indices[c + k]]}; };
    if (glm::cross(at(1) - at(0), at(2) - at(0)) == glm::dvec3{0.0}) {
      flat.push_back(c);
      continue;
    }
    for (CornerId k = 0; k < 3; ++k) solid[weld.point_of[indices[c + k]]] = 1;
  }
  const bool all = std::all_of(flat.begin(), flat.end(), [&](CornerId c) {
    const auto is_solid = [&](CornerId k) { return solid[weld.point_of[indices[c + k]]] != 0; };
    return is_solid(0) && is_solid(1) && is_solid(2);
  });
  return all ? std::vector<std::uint8_t>{} : solid;
}

std::vector<std::uint8_t> border_bits(std::span<const VertexId> indices, const Weld& weld,
                                      std::span<const BorderEdge> edges) {
  std::vector<std::uint8_t> bits(indices.size() / 3, 0);
  for (CornerId c = 0; c < indices.size(); ++c) {
    const std::uint32_t p = weld.point_of[indices[c]];
    const std::uint32_t q = weld.point_of[indices[next_corner(c)]];
    const std::pair<std::uint32_t, std::uint32_t> key{std::min(p, q), std::max(p, q)};
    const auto at = std::lower_bound(edges.begin(), edges.end(), key, [](const BorderEdge& e, const auto& k) {
      return std::pair{e.a, e.b} < k;
    });
    if (at != edges.end() && std::pair{at->a, at->b} == key) bits[c / 3] |= static_cast<std::uint8_t>(1U << (c % 3));
  }
  return bits;
}

}  // namespace lodestone::outcrop
