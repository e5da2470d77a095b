// SPDX-License-Identifier: MIT
// Which of a tile's posts stand for all of them: four ways.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "terrain/lattice.h"

namespace lodestone::terrain {

struct SampleOptions {
  double keep_ratio = 0.05;
  int cell_posts = 5;
  std::uint32_t cluster_posts = 50;
  double surface_variation = 0.001;
  double radius_posts = 9.0;
  int iterations = 15;
  glm::dvec2 spacing_m{1.0};  // between posts, eastwards and northwards
  std::uint64_t seed = 0;
};

// Posts inside the tile that belong to a cell with data, row by row.
[[nodiscard]] std::vector<Post> sample_posts(const TileLattice& lattice);

[[nodiscard]] std::vector<Post> random_points(const std::vector<Post>& posts, const SampleOptions& options);
[[nodiscard]] std::vector<Post> grid_points(const std::vector<Post>& posts, const SampleOptions& options);
[[nodiscard]] std::vector<Post> hierarchy_points(const TileLattice& lattice, const std::vector<Post>& posts,
                                                 const SampleOptions& options);

// In posts, and metres of height. Points that left the posts they came from behind.
[[nodiscard]] std::vector<glm::dvec3> wlop_points(const TileLattice& lattice, const std::vector<Post>& posts,
                                                  const SampleOptions& options);

}  // namespace lodestone::terrain
