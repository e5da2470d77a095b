// SPDX-License-Identifier: MIT
// Normals of the posts' surface in earth-fixed axes: central differences, so that both tiles of a border agree.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "terrain/lattice.h"

namespace lodestone::terrain {

// Metres between posts in the middle of a tile, eastwards and northwards.
[[nodiscard]] glm::dvec2 post_spacing_m(const TileId& tile) noexcept;

class Normals {
 public:
  explicit Normals(const TileId& tile);

  // Needs the rim around the tile. Straight up at the poles, where all columns meet.
  [[nodiscard]] glm::dvec3 at_post(const TileLattice& lattice, int x, int y) const;
  // In quantised units; between posts, the blend of those around.
  [[nodiscard]] glm::vec3 at(const TileLattice& lattice, int u, int v) const;

 private:
  struct Turn {
    double cosine = 1.0;
    double sine = 0.0;
  };
  TileId tile_;
  std::array<Turn, size + 1> east_;   // by column
  std::array<Turn, size + 1> north_;  // by row
};

}  // namespace lodestone::terrain
