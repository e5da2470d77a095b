// SPDX-License-Identifier: MIT
// Whole coordinates: the corners of a house's body are multiples of 1/1024 m, so that planes, T-junctions and
// triangulations are decided exactly, and floats hold them without rounding.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lodestone::generate {

using Point = glm::ivec3;   // 1/1024 m
using Point2 = glm::ivec2;  // 1/1024 m
using Loop = std::vector<Point>;
using Loop2 = std::vector<Point2>;

inline constexpr int lattice_per_m = 1024;

// Nearest lattice coordinate.
[[nodiscard]] inline int grid(double m) noexcept { return static_cast<int>(std::lround(m * lattice_per_m)); }
[[nodiscard]] inline double metres(int lattice) noexcept { return static_cast<double>(lattice) / lattice_per_m; }
[[nodiscard]] inline glm::dvec3 metres(const Point& p) noexcept { return {metres(p.x), metres(p.y), metres(p.z)}; }

// Twice the signed area of a, b, c; positive if counter-clockwise. Exact up to 2 km.
[[nodiscard]] inline std::int64_t orient(const Point2& a, const Point2& b, const Point2& c) noexcept {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
}

// Direction perpendicular to a planar loop (Newell), not of unit length, exact; towards the eye that sees the loop run
// counter-clockwise.
[[nodiscard]] inline glm::i64vec3 loop_normal(const Loop& loop) noexcept {
  glm::i64vec3 n{0};
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const glm::i64vec3 a{loop[i]};
    const glm::i64vec3 b{loop[(i + 1) % loop.size()]};
    n += glm::i64vec3{(a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y)};
  }
  return n;
}

// Triangles (indices into the points) of a polygon with holes, exact on whole coordinates: `rings` holds the outer
// ring, counter-clockwise, then holes, clockwise. Every edge of every ring, points on straight lines included, is an
// edge of the result, and no triangle is degenerate. O(n² log n) typical. Precondition: rings are simple and do not
// touch.
[[nodiscard]] std::vector<std::uint32_t> triangulate(const std::vector<Loop2>& rings);

}  // namespace lodestone::generate
