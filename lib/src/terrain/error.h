// SPDX-License-Identifier: MIT
// The proof: a TIN against the posts it was made from.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "terrain/lattice.h"

namespace lodestone::terrain {

struct TinError {
  struct Off {
    Post post;
    double off_m = 0.0;  // the TIN's height less the post's
  };
  double max_m = 0.0;             // largest difference in height
  std::vector<Off> too_far;       // posts off by more than the limit, by row and column
  std::size_t covered_count = 0;  // posts that some triangle covers
  bool sound = true;              // every triangle is counter-clockwise with an area
};

// Rasterises every triangle, in the place where a client decodes it, against all posts, borders included; exact in what
// it covers. A post on an edge is held against both triangles. O(posts).
[[nodiscard]] TinError measure(const Tin& tin, const TileLattice& lattice, double limit_m);

// Twice the area in quantised units.
[[nodiscard]] constexpr std::int64_t area_of(const Tin::Vertex& a, const Tin::Vertex& b,
                                             const Tin::Vertex& c) noexcept {
  return static_cast<std::int64_t>(b.u - a.u) * (c.v - a.v) - static_cast<std::int64_t>(b.v - a.v) * (c.u - a.u);
}

constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept {  // b > 0
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

// Whether no post that a counter-clockwise triangle covers is off by more. Quick: posts that are outside by less than a
// millionth may be asked as well, none that it covers is left out.
[[nodiscard]] bool within(const Tin::Vertex& a, const Tin::Vertex& b, const Tin::Vertex& c, const TileLattice& lattice,
                          double limit_m);

// Calls visit(x, y, height) for each post that a counter-clockwise triangle covers; height is the triangle's there, in
// metres. Post x lies at 32767 x, a vertex at 256 u on the same scale, so what is covered is decided exactly.
template <class Visit>
void for_each_post(const Tin::Vertex& a, const Tin::Vertex& b, const Tin::Vertex& c, Visit visit) {
  constexpr std::int64_t fine = size, coarse = quantized_max;
  const std::int64_t area = area_of(a, b, c);
  const double rise_u =
      ((b.height_m - a.height_m) * (c.v - a.v) - (c.height_m - a.height_m) * (b.v - a.v)) / static_cast<double>(area);
  const double rise_v =
      ((c.height_m - a.height_m) * (b.u - a.u) - (b.height_m - a.height_m) * (c.u - a.u)) / static_cast<double>(area);
  const Tin::Vertex* corner[3] = {&a, &b, &c};
  const auto [v_min, v_max] = std::minmax({a.v, b.v, c.v});
  const auto y_first = static_cast<int>(-floor_div(-v_min * fine, coarse));
  const auto y_last = static_cast<int>(floor_div(v_max * fine, coarse));
  for (int y = y_first; y <= y_last; ++y) {
    std::int64_t x_first = 0, x_last = size;
    for (int k = 0; k < 3; ++k) {
      const Tin::Vertex& p = *corner[k];
      const Tin::Vertex& q = *corner[(k + 1) % 3];
      // Left of pq: (qu - pu) (y - pv) - (qv - pv) (x - pu) >= 0, in units of 1 / (256 * 32767).
      const std::int64_t rise = q.v - p.v;
      const std::int64_t constant = (q.u - p.u) * (y * coarse - p.v * fine) + rise * p.u * fine;
      if (rise > 0) x_last = std::min(x_last, floor_div(constant, rise * coarse));
      if (rise < 0) x_first = std::max(x_first, -floor_div(constant, -rise * coarse));
      if (rise == 0 && constant < 0) x_last = -1;
    }
    const double row_m = a.height_m + rise_v * (static_cast<double>(y * coarse) / fine - a.v);
    for (auto x = static_cast<int>(x_first); x <= static_cast<int>(x_last); ++x) {
      visit(x, y, row_m + rise_u * (static_cast<double>(x * coarse) / fine - a.u));
    }
  }
}

}  // namespace lodestone::terrain
