// SPDX-License-Identifier: MIT
#include "mesh/import_manifold.h"

#include "base/disjoint_sets.h"

namespace lodestone {

ManifoldCut cut_to_manifold(const Mesh& mesh, const Weld& weld, const EdgeTable& edges) {
  // Corners at one point are one vertex where faces meet across a proper edge; a chain of such faces is a fan.
  const auto corners = static_cast<CornerId>(mesh.indices.size());
  DisjointSets fans{corners};
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses_of(e);
    if (uses.size() != 2 || uses[0].ascending == uses[1].ascending) continue;
    fans.join(uses[0].corner_at_low(), uses[1].corner_at_low());
    fans.join(uses[0].corner_at_high(), uses[1].corner_at_high());
  }
  ManifoldCut cut;
  cut.vertex_of_corner.assign(corners, none);
  for (CornerId c = 0; c < corners; ++c) {
    if (collapsed(weld, &mesh.indices[c - c % 3])) continue;
    const CornerId fan = fans.find(c);  // the first corner of its set, so it has its number already unless it is c
    if (fan == c) {
      cut.vertex_of_corner[c] = cut.vertex_count();
      cut.point_of_vertex.push_back(weld.point_of[mesh.indices[c]]);
    } else {
      cut.vertex_of_corner[c] = cut.vertex_of_corner[fan];
    }
  }
  return cut;
}

}  // namespace lodestone
