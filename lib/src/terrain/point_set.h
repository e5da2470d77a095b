// SPDX-License-Identifier: MIT
// A TIN of few points that stand for all posts of a tile, with the tile's borders and sharp edges as lines of it.
#pragma once

#include <span>

#include "terrain/greedy.h"
#include "terrain/sample_points.h"

namespace lodestone::terrain {

struct PointSetTask {
  TerrainMethod method = TerrainMethod::PointsRandom;
  SampleOptions samples;
  double feature_angle_rad = 1.0;
  std::uint32_t feature_edges = 5;
  double tolerance_m = 1.0;  // in space, of the lines
  double step_m = 1.0;
  std::span<const Post> inside = {};  // vertices whatever is sampled: of a grid, of the rim of voids
};

// `border` as for greedy_insertion().
[[nodiscard]] MeasuredTin point_set_tin(const TileLattice& lattice, std::span<const Tin::Vertex> border,
                                        const PointSetTask& task);

}  // namespace lodestone::terrain
