// SPDX-License-Identifier: MIT
// Based on: Gueziec, Taubin, Lazarus and Horn 2001, "Cutting and stitching: converting sets of polygons to manifold
// surfaces" (cut along the singular edges, then at the singular vertices).
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/mesh.h>

#include "mesh/edges.h"
#include "mesh/weld.h"

namespace lodestone {

// A mesh by position, cut until every edge has one or two faces that agree in turn and every vertex one fan. Vertices
// with the same point are twins: one place in the mesh before it was cut.
struct ManifoldCut {
  std::vector<std::uint32_t> vertex_of_corner;  // `none` for the corners of faces with two corners on one point
  std::vector<std::uint32_t> point_of_vertex;   // numbered by first corner

  [[nodiscard]] std::uint32_t vertex_count() const noexcept {
    return static_cast<std::uint32_t>(point_of_vertex.size());
  }
};

[[nodiscard]] ManifoldCut cut_to_manifold(const Mesh& mesh, const Weld& weld, const EdgeTable& edges);

}  // namespace lodestone
