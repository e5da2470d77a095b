// SPDX-License-Identifier: MIT
// Greedy insertion: a Delaunay triangulation of given border vertices, refined at the post with the largest error until
// no post is off by more than the tolerance.
#pragma once

#include <span>
#include <vector>

#include "terrain/error.h"
#include "terrain/lattice.h"

namespace lodestone::terrain {

struct GreedyOptions {
  double tolerance_m = 1.0;
  double step_m = 1.0;  // vertices' heights are multiples of it
  // Posts inside that are vertices from the start: of a grid, of the rim of voids.
  std::span<const Post> inside = {};
};

struct MeasuredTin {
  Tin tin;
  TinError error;
};

// `border`: vertices on the four sides, any order; corners may be left out. Only triangles over cells with data are
// returned, and only vertices that they use, in the order of their use.
[[nodiscard]] MeasuredTin greedy_insertion(const TileLattice& lattice, std::span<const Tin::Vertex> border,
                                           const GreedyOptions& options);

// Posts inside the tile at which cells with data meet cells without. Where they are vertices, together with a border
// chain, every Delaunay triangle lies wholly on one side, because edges between neighbouring posts are Delaunay.
[[nodiscard]] std::vector<Post> rim_posts(const TileLattice& lattice);

}  // namespace lodestone::terrain
