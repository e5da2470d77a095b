// SPDX-License-Identifier: MIT
#include "terrain/error.h"

#include <cmath>
#include <limits>

namespace lodestone::terrain {

TinError measure(const Tin& tin, const TileLattice& lattice, double limit_m) {
  TinError error;
  constexpr double uncovered = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> off_m(std::size_t{size + 1} * (size + 1), uncovered);
  for (std::size_t t = 0; t < tin.triangles.size(); t += 3) {
    const Tin::Vertex& a = tin.vertices[tin.triangles[t]];
    const Tin::Vertex& b = tin.vertices[tin.triangles[t + 1]];
    const Tin::Vertex& c = tin.vertices[tin.triangles[t + 2]];
    if (area_of(a, b, c) <= 0) {
      error.sound = false;
      continue;
    }
    for_each_post(a, b, c, [&](int x, int y, double height_m) {
      double& off = off_m[static_cast<std::size_t>(y) * (size + 1) + static_cast<std::size_t>(x)];
      const double here = height_m - static_cast<double>(lattice.at(x, y));
      if (!(std::fabs(here) <= std::fabs(off))) off = here;
    });
  }
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      const double off = off_m[static_cast<std::size_t>(y) * (size + 1) + static_cast<std::size_t>(x)];
      if (std::isnan(off)) continue;
      ++error.covered_count;
      error.max_m = std::max(error.max_m, std::fabs(off));
      if (std::fabs(off) > limit_m) error.too_far.push_back({{x, y}, off});
    }
  }
  return error;
}

bool within(const Tin::Vertex& a, const Tin::Vertex& b, const Tin::Vertex& c, const TileLattice& lattice,
            double limit_m) {
  constexpr double posts_per_unit = static_cast<double>(size) / quantized_max, slack = 1e-6;
  struct Corner {
    double x, y;
  };
  const Corner at_a{a.u * posts_per_unit, a.v * posts_per_unit};
  Corner p = at_a, q{b.u * posts_per_unit, b.v * posts_per_unit}, r{c.u * posts_per_unit, c.v * posts_per_unit};
  const auto [x_min, x_max] = std::minmax({p.x, q.x, r.x});
  const int x_low = static_cast<int>(x_min + 1.0 - slack), x_high = static_cast<int>(x_max + slack);
  if (x_low > x_high) return true;  // between two columns of posts
  const double bx = q.x - p.x, by = q.y - p.y, cx = r.x - p.x, cy = r.y - p.y;
  const double inverse = 1.0 / (bx * cy - by * cx);
  const double zb = b.height_m - a.height_m, zc = c.height_m - a.height_m;
  const double rise_x = (zb * cy - zc * by) * inverse, rise_y = (zc * bx - zb * cx) * inverse;
  if (p.y > q.y) std::swap(p, q);
  if (q.y > r.y) std::swap(q, r);
  if (p.y > q.y) std::swap(p, q);
  const int last = static_cast<int>(r.y + slack);
  for (int y = static_cast<int>(p.y + 1.0 - slack); y <= last; ++y) {
    // Rows at the height of a corner may lie outside by `slack`: they are looked at as wide as the edges there are.
    const double on_long = r.y > p.y ? std::clamp((y - p.y) / (r.y - p.y), 0.0, 1.0) : 0.0;
    double left = p.x + on_long * (r.x - p.x), right = left;
    const auto reach = [&](const Corner& from, const Corner& to) {
      if (y < from.y - slack || y > to.y + slack) return;
      const auto take = [&](double x) {
        left = std::min(left, x);
        right = std::max(right, x);
      };
      if (to.y - from.y < slack) {
        take(from.x);
        take(to.x);
      } else {
        take(from.x + std::clamp((y - from.y) / (to.y - from.y), 0.0, 1.0) * (to.x - from.x));
      }
    };
    reach(p, q);
    reach(q, r);
    const int begin = std::max(static_cast<int>(left + 1.0 - slack), x_low);
    const int end = std::min(static_cast<int>(right + slack), x_high);
    const double row_m = a.height_m + (y - at_a.y) * rise_y - at_a.x * rise_x;
    for (int x = begin; x <= end; ++x) {
      if (std::fabs(row_m + x * rise_x - static_cast<double>(lattice.at(x, y))) > limit_m) return false;
    }
  }
  return true;
}

}  // namespace lodestone::terrain
