// SPDX-License-Identifier: MIT
// Heights of a tile's posts as integers, and the search for the post at which a triangle is farthest off.
#pragma once

#include <cstdint>
#include <vector>

#include "terrain/lattice.h"

namespace lodestone::terrain {

// A triangle's worst post.
struct Worst {
  std::int32_t error = -1;  // in units; below 0: no post inside
  Post post;
};

// Fixed point with 28 bits over the tile's range, so that errors compare the same everywhere and sums cannot overflow.
class HeightField {
 public:
  static constexpr int stride = size + 1;

  // `step_m`: vertices' heights are multiples of it.
  HeightField(const TileLattice& lattice, double step_m);

  [[nodiscard]] double unit_m() const noexcept { return unit_m_; }
  [[nodiscard]] bool measured(int x, int y) const noexcept { return mask_.empty() || mask_[index(x, y)] != 0; }

  // Height of the vertex at a post, metres above a base that the field keeps to itself; a multiple of the step plus it.
  [[nodiscard]] double vertex_units(Post p) const noexcept;
  [[nodiscard]] double vertex_height_m(Post p) const noexcept;

  // Largest error over posts inside or on the border of a triangle, those on the tile's border and its own corners
  // excepted; of equal ones the first by row, then column. Corners counter-clockwise; heights by vertex_units().
  [[nodiscard]] Worst worst_post(Post a, Post b, Post c, double za, double zb, double zc) const noexcept;

 private:
  [[nodiscard]] static std::size_t index(int x, int y) noexcept {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
  }
  struct Span;
  void scan_row(const Span& span, Worst& worst) const noexcept;
  const TileLattice& lattice_;
  double step_m_;
  double base_m_ = 0.0;
  double unit_m_ = 1.0;
  std::vector<std::int32_t> heights_;
  std::vector<std::int32_t> mask_;  // 0 where a post does not count, else -1; empty: all count
};

}  // namespace lodestone::terrain
