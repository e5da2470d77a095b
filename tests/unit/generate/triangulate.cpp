// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>

#include "base/rng.h"
#include "generate/lattice.h"

using namespace lodestone;
using namespace lodestone::generate;

namespace {

std::int64_t twice_area(const Loop2& ring) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2& a = ring[i];
    const Point2& b = ring[(i + 1) % ring.size()];
    sum += std::int64_t{a.x} * b.y - std::int64_t{b.x} * a.y;
  }
  return sum;
}

// Area kept, no triangle degenerate or turned over, and the only open edges are those of the rings.
void check(const std::vector<Loop2>& rings) {
  Loop2 points;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::int64_t area = 0;
  for (const Loop2& ring : rings) {
    const auto first = static_cast<std::uint32_t>(points.size());
    const auto size = static_cast<std::uint32_t>(ring.size());
    for (std::uint32_t i = 0; i < size; ++i) edges[{first + (i + 1) % size, first + i}] += 1;
    points.insert(points.end(), ring.begin(), ring.end());
    area += twice_area(ring);
  }
  const std::vector<std::uint32_t> triangles = triangulate(rings);
  REQUIRE(triangles.size() == 3 * (points.size() + 2 * (rings.size() - 1) - 2));
  std::int64_t covered = 0;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const std::int64_t part = orient(points[triangles[t]], points[triangles[t + 1]], points[triangles[t + 2]]);
    REQUIRE(part > 0);
    covered += part;
    for (std::size_t k = 0; k < 3; ++k) edges[{triangles[t + k], triangles[t + (k + 1) % 3]}] += 1;
  }
  REQUIRE(covered == area);
  for (const auto& [edge, uses] : edges) {
    REQUIRE(uses == 1);
    REQUIRE(edges.count({edge.second, edge.first}) == 1);
  }
}

Loop2 rectangle(int x0, int y0, int x1, int y1, bool hole) {
  Loop2 ring{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  if (hole) std::reverse(ring.begin(), ring.end());
  return ring;
}

}  // namespace

TEST_CASE("points in the middle of straight edges become corners of triangles") {
  check({{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {2, 3}, {1, 3}, {0, 3}, {0, 1}}});
}

TEST_CASE("a wall with a grid of windows is covered exactly") {
  std::vector<Loop2> rings{rectangle(0, 0, 2000, 700, false)};
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 3; ++y)
      rings.push_back(rectangle(100 + 200 * x, 50 + 200 * y, 200 + 200 * x, 150 + 200 * y, true));
  }
  check(rings);
}

TEST_CASE("random star polygons with holes are covered exactly") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Rng rng{seed};
    Loop2 star;
    const std::uint32_t corners = 5 + rng.below(40);
    for (std::uint32_t i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * i / corners;
      const double radius = rng.uniform(4000.0, 9000.0);
      star.emplace_back(static_cast<int>(radius * std::cos(angle)), static_cast<int>(radius * std::sin(angle)));
    }
    std::vector<Loop2> rings{star};
    for (int k = 0; k < 4; ++k) {
      const int x = k % 2 == 0 ? -900 : 100;
      const int y = k < 2 ? -900 : 100;
      rings.push_back(
          rectangle(x, y, x + 50 + static_cast<int>(rng.below(700)), y + 50 + static_cast<int>(rng.below(700)), true));
    }
    CAPTURE(seed);
    check(rings);
  }
}
