// SPDX-License-Identifier: MIT
// One tile from its posts.
#pragma once

#include <lodestone/terrain.h>

#include "terrain/error.h"
#include "terrain/greedy.h"
#include "terrain/lattice.h"

namespace lodestone {

class TileBuilder {
 public:
  TileBuilder(const TerrainPyramid& pyramid, const TileId& id)
      : pyramid_{pyramid}, zoom_{pyramid.zooms_[id.zoom]}, id_{id} {}
  [[nodiscard]] Result<TerrainTile> build();
  [[nodiscard]] Result<std::vector<float>> posts();

 private:
  [[nodiscard]] PostWindow window() const;
  [[nodiscard]] Status read_posts();
  [[nodiscard]] Status plan_borders();
  void fill_placeholder();
  [[nodiscard]] std::vector<terrain::Post> fixed_posts() const;
  [[nodiscard]] terrain::MeasuredTin make_tin() const;
  [[nodiscard]] terrain::MeasuredTin point_set(const std::vector<terrain::Post>& inside) const;
  [[nodiscard]] terrain::MeasuredTin collapsed(terrain::GreedyOptions greedy) const;
  void put_vertices(const terrain::Tin& tin, TerrainTile& tile) const;
  void put_borders(TerrainTile& tile) const;
  [[nodiscard]] Status put_water(TerrainTile& tile) const;

  const TerrainPyramid& pyramid_;
  const TerrainPyramid::Zoom& zoom_;
  TileId id_;
  terrain::TileLattice lattice_;
  std::vector<terrain::Tin::Vertex> border_;
  double detail_m_ = 0.0;
  bool placeholder_ = false;
};

}  // namespace lodestone
