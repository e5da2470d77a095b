// SPDX-License-Identifier: MIT
// Panes drawn in the plane of a wall, between the corners of an opening, of the faces that stand in it.
#pragma once

#include <optional>
#include <vector>

#include "facets/opening_view.h"
#include "facets/patch.h"
#include "facets/walls.h"

namespace lodestone::facets {

struct Site {
  const FacetMesh& mesh;
  const Opening& opening;
  const glm::dvec3& normal;            // of the wall
  const std::vector<FaceId>& content;  // that stands in the opening, ascending
  const OpeningView& view;
};

// In the plane of the wall, sewn to the corners of the opening, or so far behind it, of points that nothing else hangs
// on. Of the one material that shows most. Empty if there are not enough faces, points or vertices, or the outline
// crosses itself.
[[nodiscard]] std::optional<Patch> draw_pane(const Site& site, double depth_m, double& look_cost);
// With a frame around it; empty too if that looks no better or has no fewer faces than what is there.
[[nodiscard]] std::optional<Patch> draw_framed_pane(const Site& site, double depth_m, double& look_cost);

}  // namespace lodestone::facets
