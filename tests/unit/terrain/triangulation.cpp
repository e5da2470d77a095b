// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <set>

#include "heights.h"
#include "terrain/delaunay.h"
#include "terrain/edge_collapse.h"
#include "terrain/greedy.h"

using namespace lodestone;
using namespace lodestone::terrain;
using lodestone::test::all_borders;
using lodestone::test::lattice_of;

namespace {

TileLattice hills() {
  return lattice_of([](int x, int y) { return test::ranges_m(0.02 * x + 40.0, 0.02 * y + 12.0); });
}

}  // namespace

TEST_CASE("no vertex lies inside the circle of a triangle, and the triangles tile the square") {
  const int side = 32;
  LatticeDelaunay triangulation{side};
  std::vector<std::uint8_t> taken(33 * 33);
  taken[0] = taken[side] = taken[33 * side] = taken[33 * side + side] = 1;
  std::uint64_t state = 7;
  for (int i = 0; i < 400; ++i) {
    state = mix64(state + 1);
    const Post p{static_cast<int>(state % 33), static_cast<int>(state / 64 % 33)};
    auto& at = taken[static_cast<std::size_t>(33 * p.y + p.x)];
    if (at != 0) continue;
    at = 1;
    triangulation.insert(p, static_cast<std::uint32_t>(state % triangulation.triangle_count()));
  }
  std::int64_t area = 0;
  const auto& posts = triangulation.posts();
  for (std::uint32_t t = 0; t < triangulation.triangle_count(); ++t) {
    const std::uint32_t* v = triangulation.corners().data() + 3 * t;
    const Post a = posts[v[0]], b = posts[v[1]], c = posts[v[2]];
    REQUIRE(cross(a, b, c) > 0);
    area += cross(a, b, c);
    for (const Post d : posts) {
      const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
      const double in = (ax * ax + ay * ay) * (bx * cy - by * cx) - (bx * bx + by * by) * (ax * cy - ay * cx) +
                        (cx * cx + cy * cy) * (ax * by - ay * bx);
      REQUIRE(in <= 0.0);
    }
    for (std::uint32_t e = 3 * t; e < 3 * t + 3; ++e) {
      const std::uint32_t twin = triangulation.twins()[e];
      if (twin == LatticeDelaunay::outside) continue;
      REQUIRE(triangulation.twins()[twin] == e);
      REQUIRE(triangulation.corners()[twin] == triangulation.corners()[e % 3 == 2 ? e - 2 : e + 1]);
    }
  }
  CHECK(area == 2 * side * side);
}

TEST_CASE("lines that are kept are edges, whatever is inserted afterwards") {
  LatticeDelaunay triangulation{1000};
  std::set<std::pair<int, int>> taken;
  const auto scatter = [&](int i) {
    const std::uint64_t random = mix64(static_cast<std::uint64_t>(i));
    const Post p{1 + static_cast<int>(random % 998), 1 + static_cast<int>(random / 1024 % 998)};
    if (taken.emplace(p.x, p.y).second) triangulation.insert(p, 0);
  };
  for (int i = 0; i < 300; ++i) scatter(i);
  // Lines that do not cross; every other one passes vertices on its way.
  std::vector<std::array<std::uint32_t, 2>> lines;
  for (int y = 99; y < 950; y += 100) {
    const bool level = y % 200 == 99;
    for (int x = 100; level && x < 900; x += 100) {
      if (taken.emplace(x, y).second) triangulation.insert({x, y}, 0);
    }
    lines.push_back({triangulation.insert({0, y}, 0), triangulation.insert({1000, y + (level ? 0 : 50)}, 0)});
    triangulation.keep_line(lines.back()[0], lines.back()[1]);
  }
  for (int i = 300; i < 900; ++i) scatter(i);
  const auto& posts = triangulation.posts();
  const auto& corners = triangulation.corners();
  std::int64_t area = 0, line_length = 0, kept_length = 0;
  for (const auto& [a, b] : lines) line_length += posts[b].x - posts[a].x;
  for (std::uint32_t e = 0; e < corners.size(); ++e) {
    const std::uint32_t next = LatticeDelaunay::next_of(e), prev = LatticeDelaunay::prev_of(e);
    if (e % 3 == 0) {
      REQUIRE(cross(posts[corners[e]], posts[corners[next]], posts[corners[prev]]) > 0);
      area += cross(posts[corners[e]], posts[corners[next]], posts[corners[prev]]);
    }
    if (triangulation.kept(e)) kept_length += std::abs(posts[corners[next]].x - posts[corners[e]].x);
  }
  CHECK(area == 2 * 1000 * 1000);
  CHECK(kept_length == 2 * line_length);  // met from both sides
}

TEST_CASE("greedy insertion keeps every post within the tolerance, the coarser the fewer triangles") {
  const TileLattice lattice = hills();
  std::size_t before = 1U << 20U;
  for (const double tolerance_m : {1.0, 5.0, 25.0, 200.0}) {
    const auto [tin, error] = greedy_insertion(lattice, all_borders(lattice, tolerance_m), {tolerance_m, 0.25});
    CHECK(error.sound);
    CHECK(error.max_m <= tolerance_m + 0.125);
    CHECK(error.covered_count == 257 * 257);
    CHECK(tin.triangles.size() < before);
    before = tin.triangles.size();
  }
}

TEST_CASE("the tolerance holds on cliffs, where a vertex that is decoded beside its post moves the ground by more") {
  const bool noise = GENERATE(false, true);
  const TileLattice lattice = lattice_of([&](int x, int y) {
    const std::uint64_t random = mix64(static_cast<std::uint64_t>((y + 7) * 1000 + x + 7));
    if (noise) return static_cast<double>(random % 8192);
    return random % 61 == 0 ? 9000.0 : x + y > 300 ? 4000.0 * std::sin(0.9 * x) : 0.1 * x;
  });
  const double tolerance_m = 1.0;
  const auto [tin, error] = greedy_insertion(lattice, all_borders(lattice, tolerance_m), {tolerance_m, 0.25});
  CHECK(error.sound);
  CHECK(error.max_m <= tolerance_m + 0.125);
  CHECK(error.covered_count == 257 * 257);
}

TEST_CASE("the measured error of a flat tin is the height of its posts") {
  const TileLattice lattice = lattice_of([](int x, int y) { return x == 77 && y == 200 ? 12.5 : 0.0; });
  Tin tin;
  const int m = quantized_max;
  tin.vertices = {{0, 0, 0.0}, {m, 0, 0.0}, {m, m, 0.0}, {0, m, 0.0}};
  tin.triangles = {0, 1, 2, 0, 2, 3};
  const TinError error = measure(tin, lattice, 1.0);
  CHECK(error.max_m == 12.5);
  CHECK(error.covered_count == 257 * 257);
  REQUIRE(error.too_far.size() == 1);
  CHECK(error.too_far[0].post == Post{77, 200});
  CHECK(error.too_far[0].off_m == -12.5);
  tin.triangles = {0, 2, 1, 0, 2, 3};
  CHECK_FALSE(measure(tin, lattice, 1.0).sound);
}

TEST_CASE("no triangle covers a cell without data, and all others are covered") {
  const TileLattice lattice = lattice_of([](int x, int y) {
    const bool hole = (x - 100) * (x - 100) + (y - 90) * (y - 90) < 900 || x + y > 400 || (x == 30 && y % 7 == 0);
    return hole ? static_cast<double>(NAN) : 300.0 * std::sin(x * 0.05) * std::cos(y * 0.07);
  });
  const std::vector<Post> rim = rim_posts(lattice);
  const auto [tin, error] = greedy_insertion(lattice, all_borders(lattice, 3.0), {3.0, 0.25, rim});
  CHECK(error.max_m <= 3.125);
  std::int64_t area = 0;
  for (std::size_t t = 0; t < tin.triangles.size(); t += 3) {
    const Tin::Vertex &a = tin.vertices[tin.triangles[t]], &b = tin.vertices[tin.triangles[t + 1]],
                      &c = tin.vertices[tin.triangles[t + 2]];
    REQUIRE_FALSE(std::isnan(a.height_m + b.height_m + c.height_m));
    area += area_of(a, b, c);
    for_each_post(a, b, c, [&](int x, int y, double) { REQUIRE(lattice.valid(x, y)); });
  }
  std::int64_t cells = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (!lattice.cell(x, y)) continue;
      cells += 2LL * (quantized(x + 1) - quantized(x)) * (quantized(y + 1) - quantized(y));
    }
  }
  CHECK(area == cells);
}

TEST_CASE("edge collapse needs fewer triangles than greedy insertion for the same error, and keeps the border") {
  const TileLattice lattice = hills();
  const double tolerance_m = 25.0;
  const auto border = all_borders(lattice, tolerance_m);
  const Tin greedy = greedy_insertion(lattice, border, {tolerance_m, 0.25}).tin;
  const Tin fine = greedy_insertion(lattice, border, {0.75 * tolerance_m, 0.25}).tin;
  const Tin tin = collapse_edges(fine, lattice, {.limit_m = tolerance_m, .step_m = 0.25});
  const TinError error = measure(tin, lattice, tolerance_m);
  CHECK(error.sound);
  CHECK(error.max_m <= tolerance_m);
  CHECK(error.covered_count == 257 * 257);
  CHECK(10 * tin.triangles.size() < 9 * greedy.triangles.size());
  // Between posts, where the error in height does not look, vertices do not stick out either.
  double most_m = 0.0;
  for (const Tin::Vertex& v : tin.vertices) {
    const double east = v.u * 256.0 / quantized_max, north = v.v * 256.0 / quantized_max;
    const int x = std::min(static_cast<int>(east), size - 1), y = std::min(static_cast<int>(north), size - 1);
    const auto row_m = [&](int row) { return std::lerp(lattice.at(x, row), lattice.at(x + 1, row), east - x); };
    most_m = std::max(most_m, std::fabs(v.height_m - std::lerp(row_m(y), row_m(y + 1), north - y)));
  }
  CHECK(most_m <= tolerance_m + 0.5);
  const auto on_border = [](const Tin& of) {
    std::vector<std::array<double, 3>> places;
    for (const Tin::Vertex& v : of.vertices) {
      if (v.u == 0 || v.v == 0 || v.u == quantized_max || v.v == quantized_max) {
        places.push_back({static_cast<double>(v.u), static_cast<double>(v.v), v.height_m});
      }
    }
    std::sort(places.begin(), places.end());
    return places;
  };
  CHECK(on_border(tin) == on_border(fine));
}

TEST_CASE("edge collapse by count stops at the number of edges") {
  const TileLattice lattice = hills();
  const Tin fine = greedy_insertion(lattice, all_borders(lattice, 50.0), {5.0, 0.25}).tin;
  const Tin tin = collapse_edges(fine, lattice, {.target_edges = 2000, .step_m = 0.25});
  const TinError error = measure(tin, lattice, 1e9);
  CHECK(error.sound);
  CHECK(error.covered_count == 257 * 257);
  const std::size_t border = all_borders(lattice, 50.0).size() - 4;  // corners are there twice
  const std::size_t edges = (tin.triangles.size() + border) / 2;
  CHECK(edges <= 2000);
  CHECK(edges > 1990);
}

TEST_CASE("volume and shape weigh against each other as asked") {
  const TileLattice lattice = hills();
  const Tin fine = greedy_insertion(lattice, all_borders(lattice, 50.0), {5.0, 0.25}).tin;
  struct Quality {
    double unevenness = 0.0;  // mean squared area of triangles over their squared mean area
    double error_m = 0.0;
  };
  const auto quality = [&](double volume_weight, double shape_weight) {
    const Tin tin = collapse_edges(
        fine, lattice,
        {.target_edges = 2000, .step_m = 0.25, .volume_weight = volume_weight, .shape_weight = shape_weight});
    double sum = 0.0, squares = 0.0;
    for (std::size_t t = 0; t < tin.triangles.size(); t += 3) {
      const auto area = static_cast<double>(area_of(tin.vertices[tin.triangles[t]], tin.vertices[tin.triangles[t + 1]],
                                                    tin.vertices[tin.triangles[t + 2]]));
      sum += area;
      squares += area * area;
    }
    const auto count = static_cast<double>(tin.triangles.size() / 3);
    return Quality{squares * count / (sum * sum), measure(tin, lattice, 1e9).max_m};
  };
  // The shape term makes short edges go first.
  const Quality volume = quality(0.5, 1e-10), shape = quality(1e-6, 1.0);
  INFO(volume.unevenness << " " << shape.unevenness << " " << volume.error_m << " " << shape.error_m);
  CHECK(volume.unevenness > 1.05 * shape.unevenness);
  CHECK(volume.error_m < 0.8 * shape.error_m);
}
