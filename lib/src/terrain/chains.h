// SPDX-License-Identifier: MIT
// The vertices of a tile's border. Both tiles of a border compute them from the same posts by the same arithmetic.
#pragma once

#include <vector>

#include "terrain/lattice.h"

namespace lodestone::terrain {

enum class Side { West, South, East, North };
inline constexpr std::array<Side, 4> all_sides{Side::West, Side::South, Side::East, Side::North};

// Post t of a side, counted from the south or from the west.
[[nodiscard]] constexpr Post post_of(Side side, int t) noexcept {
  switch (side) {
    case Side::West:
      return {0, t};
    case Side::East:
      return {size, t};
    case Side::South:
      return {t, 0};
    case Side::North:
      return {t, size};
  }
  return {};
}

struct ChainOptions {
  double tolerance_m = 0.0;
  double step_m = 1.0;  // vertices' heights are snapped to it
  int divisions = 1;    // a vertex at least every size / divisions posts
};

// What a chain is made of, by post.
struct ChainLine {
  std::array<double, size + 1> post_m{};    // NaN: no data
  std::array<double, size + 1> place{};     // where a vertex at the post is drawn, in posts
  std::array<double, size + 1> vertex_m{};  // and how high
};
// The chain along a line with data everywhere, from 0 to `size`.
[[nodiscard]] std::vector<int> divided_chain(const ChainLine& line, const ChainOptions& options);

// Ascending post numbers of the vertices along a side. None where neither tile has a cell with data.
[[nodiscard]] std::vector<int> border_chain(const TileLattice& lattice, Side side, const ChainOptions& options);

// The vertex at a post of a border, as both its tiles have it.
[[nodiscard]] Tin::Vertex border_vertex(const TileLattice& lattice, Post post, double step_m);
// The chain as vertices.
[[nodiscard]] std::vector<Tin::Vertex> border_vertices(const TileLattice& lattice, Side side,
                                                       const ChainOptions& options);

// How far odd posts of the side stand off the straight line between their even neighbours: what the zoom above cannot
// know of this border.
[[nodiscard]] double border_detail_m(const TileLattice& lattice, Side side);

}  // namespace lodestone::terrain
