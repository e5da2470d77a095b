// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <lodestone/polygon.h>

#include "base/rng.h"

using namespace lodestone;

namespace {

using Ring = std::vector<glm::dvec2>;

struct Polygon {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> ring_ends;
};

// Laid on a slanted plane far from the origin, as roofs in map coordinates are.
Polygon lay(const std::vector<Ring>& rings) {
  const glm::dvec3 u = glm::normalize(glm::dvec3{1.0, 0.4, 0.7});
  const glm::dvec3 v = glm::normalize(glm::cross(glm::dvec3{0.3, -1.0, 0.2}, u));
  Polygon polygon;
  for (const Ring& ring : rings) {
    for (const glm::dvec2& p : ring)
      polygon.points.push_back(glm::dvec3{670000.0, 5400000.0, 370.0} + p.x * u + p.y * v);
    polygon.ring_ends.push_back(static_cast<std::uint32_t>(polygon.points.size()));
  }
  return polygon;
}

double ring_area(const Ring& ring) {
  double sum = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i];
    const glm::dvec2 b = ring[(i + 1) % ring.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return 0.5 * sum;
}

glm::dvec3 triangle_vector(const Polygon& polygon, const std::array<std::uint32_t, 3>& t) {
  const auto& p = polygon.points;
  return 0.5 * glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
}

// Triangles all turn like the outer ring, and their areas add up to the polygon's: they cannot overlap then.
void check_exact_cover(const std::vector<Ring>& rings) {
  const Polygon polygon = lay(rings);
  const auto triangles = triangulate_polygon(polygon.points, polygon.ring_ends);
  double expected = std::abs(ring_area(rings[0]));
  for (std::size_t h = 1; h < rings.size(); ++h) expected -= std::abs(ring_area(rings[h]));
  glm::dvec3 sum{0.0};
  double total = 0.0;
  for (const auto& t : triangles) {
    sum += triangle_vector(polygon, t);
    total += glm::length(triangle_vector(polygon, t));
    CHECK(glm::length(triangle_vector(polygon, t)) > 0.0);
  }
  CHECK(total == Approx(expected).epsilon(1e-6));
  CHECK(glm::length(sum) == Approx(expected).epsilon(1e-6));
  const glm::dvec3 up = glm::cross(glm::normalize(glm::dvec3{1.0, 0.4, 0.7}),
                                   glm::normalize(glm::cross(glm::dvec3{0.3, -1.0, 0.2}, glm::dvec3{1.0, 0.4, 0.7})));
  CHECK((glm::dot(sum, up) > 0.0) == (ring_area(rings[0]) > 0.0));
}

// Every side of every ring belongs to one triangle, every other edge to two: nothing is left open inside.
void check_watertight(const std::vector<Ring>& rings) {
  const Polygon polygon = lay(rings);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const auto& t : triangulate_polygon(polygon.points, polygon.ring_ends)) {
    for (std::size_t c = 0; c < 3; ++c) ++uses[std::minmax(t[c], t[(c + 1) % 3])];
  }
  std::uint32_t begin = 0;
  for (const std::uint32_t end : polygon.ring_ends) {
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t j = i + 1 == end ? begin : i + 1;
      CHECK(uses[std::minmax(i, j)] == 1);
      uses[std::minmax(i, j)] = 2;
    }
    begin = end;
  }
  for (const auto& [edge, count] : uses) CHECK(count == 2);
}

Ring circle(std::uint32_t n, double radius, glm::dvec2 center = {0.0, 0.0}, double wobble = 0.0) {
  Ring ring;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2.0 * std::numbers::pi * i / n;
    const double r = radius * (1.0 + wobble * std::sin(17.0 * a));
    ring.push_back(center + glm::dvec2{r * std::cos(a), r * std::sin(a)});
  }
  return ring;
}

Ring reversed(Ring ring) {
  std::reverse(ring.begin(), ring.end());
  return ring;
}

Ring square(double x, double y, double size) { return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}}; }

}  // namespace

TEST_CASE("proper polygons are covered exactly and without T-junctions") {
  const Ring comb{{0, 0}, {9, 0}, {9, 3}, {8, 3}, {8, 1}, {7, 1}, {7, 3}, {4, 3}, {4, 1}, {3, 1}, {3, 3}, {0, 3}};
  const Ring straight{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {3, 2}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  const std::vector<std::vector<Ring>> cases{
      {square(0, 0, 2)},
      {{{0, 0}, {4, 0}, {1, 1}, {0, 4}}},  // a dart
      {comb},
      {reversed(comb)},
      {straight},
      {circle(1000, 5.0, {1, 2}, 0.3)},
      {square(0, 0, 10), square(2, 2, 1)},
      {square(0, 0, 10), reversed(square(2, 2, 1)), square(5, 2, 1), square(2, 5, 1), square(5, 5, 1)},
      {circle(64, 9.0), circle(40, 3.0), circle(12, 1.0, {5, 0}), circle(12, 1.0, {-5, 0}), circle(7, 1.0, {0, 5})},
      {reversed(circle(64, 9.0)), circle(40, 3.0, {1, 1}, 0.2)},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    INFO("case " << i);
    check_exact_cover(cases[i]);
    check_watertight(cases[i]);
  }
}

TEST_CASE("a facade of many windows is covered exactly") {
  std::vector<Ring> rings{{{0, 0}, {60, 0}, {60, 40}, {0, 40}}};
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 30; ++x) rings.push_back(reversed(square(2.0 * x + 0.4, 2.0 * y + 0.4, 1.2)));
  }
  check_exact_cover(rings);
  check_watertight(rings);
}

TEST_CASE("repeated points, and rings that close themselves, do no harm") {
  check_exact_cover({{{0, 0}, {4, 0}, {4, 0}, {4, 3}, {0, 3}, {0, 0}}});
  check_exact_cover({{{0, 0}, {4, 0}, {4, 3}, {0, 3}, {0, 0}}, {{1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}}});
}

TEST_CASE("holes that touch the outer ring or each other are covered exactly") {
  check_exact_cover({square(0, 0, 10), {{0, 0}, {2, 1}, {1, 2}}});                // at a corner
  check_exact_cover({square(0, 0, 10), {{10, 5}, {8, 6}, {8, 4}}});               // on a side
  check_exact_cover({square(0, 0, 10), square(2, 2, 2), square(4, 4, 2)});        // corner to corner
  check_exact_cover({{{0, 0}, {4, 0}, {4, 4}, {2, 2}, {1, 3}, {2, 2}, {0, 4}}});  // a spike inwards
  check_exact_cover({{{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}});          // two triangles at one point
}

TEST_CASE("random star polygons with holes are covered exactly") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    INFO("seed " << seed);
    Rng rng{seed};
    std::vector<Ring> rings{{}};
    const std::uint32_t n = 4 + rng.below(60);
    for (std::uint32_t i = 0; i < n; ++i) {
      const double a = 2.0 * std::numbers::pi * (i + 0.8 * rng.unit()) / n;
      const double r = rng.uniform(6.0, 20.0);
      rings[0].emplace_back(r * std::cos(a), r * std::sin(a));
    }
    for (int h = 0; h < 5; ++h) {
      const double a = 2.0 * std::numbers::pi * h / 5.0;
      rings.push_back(circle(3 + rng.below(5), rng.uniform(0.1, 0.5), {1.5 * std::cos(a), 1.5 * std::sin(a)}));
    }
    // A star with few vertices may cut its own holes.
    if (n < 12) rings.resize(1);
    check_exact_cover(rings);
    check_watertight(rings);
  }
}

TEST_CASE("what is no polygon gives nothing, or as much as it can") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::uint32_t> four{4};
  CHECK(triangulate_polygon({}, {}).empty());
  CHECK(triangulate_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, four).empty());
  CHECK(triangulate_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {nan, 0, 0}, {3, 1, 0}}, four).empty());
  CHECK(triangulate_polygon(std::vector<glm::dvec3>(4, glm::dvec3{5.0}), four).empty());
  // A figure of eight: both loops.
  const Polygon eight = lay({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}});
  CHECK_FALSE(triangulate_polygon(eight.points, eight.ring_ends).empty());
  // A hole outside is ignored.
  const Polygon outside = lay({square(0, 0, 1), square(5, 5, 1)});
  CHECK(triangulate_polygon(outside.points, outside.ring_ends).size() == 2);
}

TEST_CASE("random scribbles end soon") {
  Rng rng{3};
  for (const std::uint32_t n : {5U, 50U, 500U, 20'000U}) {
    Ring ring;
    for (std::uint32_t i = 0; i < n; ++i) ring.emplace_back(rng.below(40), rng.below(40));
    const Polygon polygon = lay({ring, reversed(ring)});
    const auto start = std::chrono::steady_clock::now();
    const auto triangles = triangulate_polygon(polygon.points, polygon.ring_ends);
    for (const auto& t : triangles) CHECK(std::max({t[0], t[1], t[2]}) < polygon.points.size());
    CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < 20.0);
  }
}

TEST_CASE("a hundred thousand corners take well under a second") {
  const Polygon polygon = lay({circle(100'000, 5.0, {}, 0.3)});
  const auto start = std::chrono::steady_clock::now();
  CHECK(triangulate_polygon(polygon.points, polygon.ring_ends).size() == 99'998);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CAPTURE(seconds);
  CHECK(seconds < 5.0);
}
