// SPDX-License-Identifier: MIT
// The posts of one tile with a rim of one post around them, and what follows from them alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <lodestone/terrain.h>

namespace lodestone::terrain {

inline constexpr int size = tile_intervals;  // posts 0..size along a side

// In posts of the tile, or in quantised units.
struct Post {
  int x = 0;
  int y = 0;
  friend bool operator==(const Post&, const Post&) = default;
};

// Twice the area of a triangle, above 0 if counter-clockwise.
[[nodiscard]] constexpr std::int64_t cross(Post a, Post b, Post c) noexcept {
  return static_cast<std::int64_t>(b.x - a.x) * (c.y - a.y) - static_cast<std::int64_t>(b.y - a.y) * (c.x - a.x);
}

// Posts whose coordinate is exact in 0..32767 are none but the corners; this is where clients will put the others.
[[nodiscard]] constexpr int quantized(int post) noexcept { return post <= size / 2 ? 128 * post : 128 * post - 1; }
// How far that is from the post, in posts; below 1/256.
[[nodiscard]] constexpr double quantized_shift(int post) noexcept {
  return static_cast<double>(post <= size / 2 ? post : post - size) / quantized_max;
}

// The post nearest to a quantised coordinate.
[[nodiscard]] constexpr int nearest_post(int quantised) noexcept { return (quantised + 64) / 128; }

// The column or row of cells that a quantised coordinate lies in.
[[nodiscard]] constexpr int cell_of(int quantised) noexcept {
  return std::min(quantised < 128 * (size / 2 + 1) - 1 ? quantised / 128 : (quantised + 1) / 128, size - 1);
}

class TileLattice {
 public:
  static constexpr int stride = size + 3;

  TileLattice() : heights_(std::size_t{stride} * stride) {}
  [[nodiscard]] std::vector<float>& heights() noexcept { return heights_; }

  // -1 <= x, y <= size + 1
  [[nodiscard]] float at(int x, int y) const noexcept { return heights_[index(x, y)]; }
  void set(int x, int y, float height_m) noexcept { heights_[index(x, y)] = height_m; }
  [[nodiscard]] bool valid(int x, int y) const noexcept { return !std::isnan(at(x, y)); }
  // The cell whose south-west post is (x, y): all four posts have data.
  [[nodiscard]] bool cell(int x, int y) const noexcept {
    return valid(x, y) && valid(x + 1, y) && valid(x, y + 1) && valid(x + 1, y + 1);
  }
  // All cells of the tile itself have data.
  [[nodiscard]] bool complete() const noexcept;

  // Height of a vertex at a post. Clients decode the vertex up to 1/256 post beside the post, which is then covered by
  // the triangle behind it: the height goes on as it rose up to the post, so that this triangle still meets the post.
  // On a border it depends on the border's posts only.
  [[nodiscard]] double vertex_height_m(Post p) const noexcept;

 private:
  [[nodiscard]] static std::size_t index(int x, int y) noexcept {
    return static_cast<std::size_t>(y + 1) * stride + static_cast<std::size_t>(x + 1);
  }
  std::vector<float> heights_;
};

// A multiple of a power of two.
[[nodiscard]] inline double snapped_m(double height_m, double step_m) noexcept {
  return std::floor(height_m / step_m + 0.5) * step_m;
}

// A TIN before it is put into a tile: places in quantised units, heights in metres (multiples of the zoom's step).
struct Tin {
  struct Vertex {
    int u = 0;
    int v = 0;
    double height_m = 0.0;
  };
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> triangles;
};

}  // namespace lodestone::terrain
