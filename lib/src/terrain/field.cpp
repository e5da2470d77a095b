// SPDX-License-Identifier: MIT
// Based on: Garland and Heckbert 1995, "Fast polygonal approximation of terrains and height fields" (scan conversion of
// each new triangle for its candidate).
// Differs: rows are compared with integer arithmetic that a compiler turns into vector instructions; planes go through
// the vertices where clients will decode them.
#include "terrain/field.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace lodestone::terrain {
namespace {

constexpr double scale_units = 1 << 28;
constexpr double posts_per_unit = static_cast<double>(size) / quantized_max;
// Posts on an edge belong to both triangles, whichever way sums are rounded.
constexpr double slack = 1e-6;

int ceil_of(double x) { return static_cast<int>(x + 1.0 - slack); }  // x >= 0
int floor_of(double x) { return static_cast<int>(x + slack); }

}  // namespace

HeightField::HeightField(const TileLattice& lattice, double step_m, bool on_posts)
    : lattice_{lattice}, step_m_{step_m}, on_posts_{on_posts}, heights_(std::size_t{stride} * stride) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  bool complete = true;
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      const float h = lattice.at(x, y);
      complete = complete && !std::isnan(h);
      if (h < low) low = h;
      if (h > high) high = h;
    }
  }
  if (low > high) low = high = 0.0F;
  base_m_ = std::floor(low / step_m) * step_m;
  const double range_m = std::max(static_cast<double>(high) - base_m_ + step_m, step_m);
  unit_m_ = std::exp2(std::ceil(std::log2(range_m / scale_units)));
  if (!complete) mask_.assign(heights_.size(), 0);
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      if (!lattice.valid(x, y)) continue;
      heights_[index(x, y)] = static_cast<std::int32_t>((lattice.at(x, y) - base_m_) / unit_m_ + 0.5);
      if (complete) continue;
      const bool used = (x < size && y < size && lattice.cell(x, y)) || (x > 0 && y < size && lattice.cell(x - 1, y)) ||
                        (x < size && y > 0 && lattice.cell(x, y - 1)) || (x > 0 && y > 0 && lattice.cell(x - 1, y - 1));
      mask_[index(x, y)] = used ? -1 : 0;
    }
  }
}

double HeightField::vertex_height_m(Post p) const noexcept { return snapped_m(lattice_.vertex_height_m(p), step_m_); }

// Posts begin..end of a row, and the plane's height at the first and its rise from post to post.
struct HeightField::Span {
  int y = 0;
  int begin = 0;
  int end = 0;
  std::int32_t height = 0;
  std::int32_t rise = 0;
};

void HeightField::scan_row(const Span& span, Worst& worst) const noexcept {
  const std::int32_t* heights = heights_.data() + index(span.begin, span.y);
  const int count = span.end - span.begin + 1;
  std::int32_t most = worst.error;
  constexpr int few = 8;  // not worth vector instructions
  if (count < few) {
    for (int i = 0; i < count; ++i) {
      const std::int32_t off = std::abs(heights[i] - (span.height + i * span.rise));
      if (off > worst.error && measured(span.begin + i, span.y)) worst = {off, {span.begin + i, span.y}};
    }
    return;
  }
  if (mask_.empty()) {
    for (int i = 0; i < count; ++i) most = std::max(most, std::abs(heights[i] - (span.height + i * span.rise)));
  } else {
    const std::int32_t* mask = mask_.data() + index(span.begin, span.y);
    for (int i = 0; i < count; ++i) {
      const std::int32_t off = std::abs(heights[i] - (span.height + i * span.rise));
      most = std::max(most, (off & mask[i]) | ~mask[i]);  // -1 where it does not count
    }
  }
  if (most == worst.error) return;
  for (int i = 0; i < count; ++i) {
    if (std::abs(heights[i] - (span.height + i * span.rise)) == most && measured(span.begin + i, span.y)) {
      worst = {most, {span.begin + i, span.y}};
      return;
    }
  }
}

Worst HeightField::worst_post(Post a, Post b, Post c, double za, double zb, double zc) const noexcept {
  const std::array<Post, 3> nearest{Post{nearest_post(a.x), nearest_post(a.y)},
                                    Post{nearest_post(b.x), nearest_post(b.y)},
                                    Post{nearest_post(c.x), nearest_post(c.y)}};
  // By Pick's theorem a triangle between posts of this area has no post but its corners.
  if (on_posts_ && cross(nearest[0], nearest[1], nearest[2]) == 1) return {};
  struct Corner {
    double x, y;
  };
  const Corner at_a{a.x * posts_per_unit, a.y * posts_per_unit};
  Corner p = at_a, q{b.x * posts_per_unit, b.y * posts_per_unit}, r{c.x * posts_per_unit, c.y * posts_per_unit};
  const double bx = q.x - p.x, by = q.y - p.y, cx = r.x - p.x, cy = r.y - p.y;
  const double inverse = 1.0 / (bx * cy - by * cx);
  const double rise_x = ((zb - za) * cy - (zc - za) * by) * inverse;
  const double rise_y = ((zc - za) * bx - (zb - za) * cx) * inverse;

  // By height: p lowest, r highest.
  if (p.y > q.y) std::swap(p, q);
  if (q.y > r.y) std::swap(q, r);
  if (p.y > q.y) std::swap(p, q);
  // Not a number for level edges, on which no row is looked at.
  const double long_slope = (r.x - p.x) / (r.y - p.y);
  const double low_slope = (q.x - p.x) / (q.y - p.y);
  const double high_slope = (r.x - q.x) / (r.y - q.y);

  Worst worst;
  const int last = std::min(floor_of(r.y), size - 1);
  for (int y = std::max(ceil_of(p.y), 1); y <= last; ++y) {
    double left = p.x + (y - p.y) * long_slope;
    double right = y < q.y ? p.x + (y - p.y) * low_slope : q.x + (y - q.y) * high_slope;
    if (std::fabs(y - q.y) < slack) right = q.x;
    if (left > right) std::swap(left, right);
    Span span{.y = y, .begin = std::max(ceil_of(left), 1), .end = std::min(floor_of(right), size - 1)};
    // Corners' own posts are met by their heights; inserting them again would not help.
    const auto is_corner = [&](int x) {
      const Post at{x, y};
      return at == nearest[0] || at == nearest[1] || at == nearest[2];
    };
    if (y == nearest[0].y || y == nearest[1].y || y == nearest[2].y) {
      while (span.begin <= span.end && is_corner(span.begin)) ++span.begin;
      while (span.begin <= span.end && is_corner(span.end)) --span.end;
    }
    if (span.begin > span.end) continue;
    span.height = static_cast<std::int32_t>(za + (span.begin - at_a.x) * rise_x + (y - at_a.y) * rise_y);
    // Steep slivers rise by more than an int holds from post to post, but have one post a row.
    if (span.end > span.begin) span.rise = static_cast<std::int32_t>(rise_x);
    scan_row(span, worst);
  }
  return worst;
}

}  // namespace lodestone::terrain
