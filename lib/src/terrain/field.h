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

  // `step_m`: vertices' heights are multiples of it. `on_posts`: triangles will have all corners at posts.
  HeightField(const TileLattice& lattice, double step_m, bool on_posts);

  [[nodiscard]] double unit_m() const noexcept { return unit_m_; }
  [[nodiscard]] bool measured(int x, int y) const noexcept { return mask_.empty() || mask_[index(x, y)] != 0; }

  // Units above a base that the field keeps to itself.
  [[nodiscard]] double to_units(double height_m) const noexcept { return (height_m - base_m_) / unit_m_; }
  [[nodiscard]] double to_m(double units) const noexcept { return base_m_ + units * unit_m_; }
  // What a vertex at a post begins with, a multiple of the step.
  [[nodiscard]] double vertex_height_m(Post p) const noexcept;

  // Largest error over the posts that a triangle covers, those on the tile's border and those nearest to its corners
  // excepted; of equal ones the first by row, then column. Corners in quantised units, counter-clockwise.
  [[nodiscard]] Worst worst_post(Post a, Post b, Post c, double za, double zb, double zc) const noexcept;

 private:
  [[nodiscard]] static std::size_t index(int x, int y) noexcept {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
  }
  struct Span;
  void scan_row(const Span& span, Worst& worst) const noexcept;
  const TileLattice& lattice_;
  double step_m_;
  bool on_posts_;
  double base_m_ = 0.0;
  double unit_m_ = 1.0;
  std::vector<std::int32_t> heights_;
  std::vector<std::int32_t> mask_;  // 0 where a post does not count, else -1; empty: all count
};

}  // namespace lodestone::terrain
