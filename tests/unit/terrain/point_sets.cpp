// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "heights.h"
#include "terrain/feature_lines.h"
#include "terrain/point_set.h"

using namespace lodestone;
using namespace lodestone::terrain;
using lodestone::test::all_borders;
using lodestone::test::lattice_of;

namespace {

// On the border, as (u, v, height).
std::set<std::array<double, 3>> border_of(const Tin& tin) {
  std::set<std::array<double, 3>> places;
  for (const Tin::Vertex& v : tin.vertices) {
    if (v.u == 0 || v.v == 0 || v.u == quantized_max || v.v == quantized_max) {
      places.insert({static_cast<double>(v.u), static_cast<double>(v.v), v.height_m});
    }
  }
  return places;
}

// A ridge northwards and one to the north-east, which end in each other.
double ridges_m(int x, int y) { return 3000.0 - 60.0 * std::min(std::abs(x - 90), std::abs(x - y + 10)); }

}  // namespace

TEST_CASE("point sets cover the cells with data and no other, with the border that all methods share") {
  const TerrainMethod method = GENERATE(TerrainMethod::PointsRandom, TerrainMethod::PointsGrid,
                                        TerrainMethod::PointsHierarchy, TerrainMethod::PointsWlop);
  const TileLattice lattice = lattice_of([](int x, int y) {
    const bool hole = (x - 100) * (x - 100) + (y - 90) * (y - 90) < 900 || x + y > 430 || (x == 30 && y % 7 == 0);
    return hole ? static_cast<double>(NAN) : test::ranges_m(0.02 * x + 40.0, 0.02 * y + 12.0);
  });
  const auto border = all_borders(lattice, 20.0);
  const std::vector<Post> rim = rim_posts(lattice);
  PointSetTask task{.method = method, .tolerance_m = 20.0, .step_m = 0.25, .inside = rim};
  task.samples.spacing_m = {1500.0, 2000.0};
  const auto [tin, error] = point_set_tin(lattice, border, task);
  CHECK(error.sound);
  std::int64_t area = 0, cells = 0;
  for (std::size_t t = 0; t < tin.triangles.size(); t += 3) {
    const Tin::Vertex &a = tin.vertices[tin.triangles[t]], &b = tin.vertices[tin.triangles[t + 1]],
                      &c = tin.vertices[tin.triangles[t + 2]];
    area += area_of(a, b, c);
    bool over_data = true;
    for_each_post(a, b, c, [&](int x, int y, double) { over_data = over_data && lattice.valid(x, y); });
    REQUIRE(over_data);
  }
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (lattice.cell(x, y)) cells += 2LL * (quantized(x + 1) - quantized(x)) * (quantized(y + 1) - quantized(y));
    }
  }
  CHECK(area == cells);
  CHECK(tin.vertices.size() < 20000);
  CHECK(border_of(tin) == border_of(greedy_insertion(lattice, border, {20.0, 0.25, rim}).tin));
}

TEST_CASE("crests are kept where few points are") {
  const TileLattice lattice = lattice_of(ridges_m);
  const auto worst_on_crest_m = [&](std::uint32_t least_edges) {
    PointSetTask task{.feature_angle_rad = 1.05, .feature_edges = least_edges, .tolerance_m = 40.0, .step_m = 0.25};
    task.samples.keep_ratio = 0.002;
    task.samples.spacing_m = {90.0, 90.0};
    const Tin tin = point_set_tin(lattice, all_borders(lattice, 40.0), task).tin;
    double most_m = 0.0;
    for (std::size_t t = 0; t < tin.triangles.size(); t += 3) {
      for_each_post(tin.vertices[tin.triangles[t]], tin.vertices[tin.triangles[t + 1]],
                    tin.vertices[tin.triangles[t + 2]], [&](int x, int y, double height_m) {
                      if (y > 20 && y < 230 && lattice.at(x, y) > 2975.0F) {
                        most_m = std::max(most_m, std::fabs(height_m - static_cast<double>(lattice.at(x, y))));
                      }
                    });
    }
    return most_m;
  };
  CHECK(worst_on_crest_m(5) < 120.0);
  CHECK(worst_on_crest_m(100000) > 300.0);
}

TEST_CASE("simplified lines do not cross, and every post that was on one stays near it") {
  const TileLattice lattice = lattice_of([](int x, int y) {
    const auto rough = static_cast<double>(mix64(static_cast<std::uint64_t>(x / 3 * 1000 + y / 4)) % 100);
    return ridges_m(x, y) + 8.0 * rough;
  });
  const std::vector<FeatureLine> lines = feature_lines(lattice, 1.05, 5);
  auto simple = lines;
  const double tolerance_m = 150.0;
  simplify_lines(simple, lattice, {90.0, 90.0}, {}, tolerance_m);
  REQUIRE(lines.size() > 20);
  struct Segment {
    Post a, b;
  };
  std::vector<Segment> segments;
  std::size_t before = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    before += lines[k].size();
    CHECK(lines[k].size() > 5);
    CHECK(simple[k].front() == lines[k].front());
    CHECK(simple[k].back() == lines[k].back());
    for (std::size_t i = 1; i < simple[k].size(); ++i) segments.push_back({simple[k][i - 1], simple[k][i]});
  }
  CHECK(3 * segments.size() < 2 * before);
  const auto sign = [](std::int64_t value) { return value > 0 ? 1 : value < 0 ? -1 : 0; };
  int crossings = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto [a, b] = segments[i];
    for (std::size_t j = i + 1; j < segments.size(); ++j) {
      const auto [c, d] = segments[j];
      if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x)) continue;
      const int over_c = sign(cross(a, b, c)), over_d = sign(cross(a, b, d));
      const int over_a = sign(cross(c, d, a)), over_b = sign(cross(c, d, b));
      if (over_c * over_d < 0 && over_a * over_b < 0) ++crossings;
    }
  }
  CHECK(crossings == 0);
  const auto place_m = [&](Post p) { return glm::dvec3{90.0 * p.x, 90.0 * p.y, lattice.at(p.x, p.y)}; };
  double most_m = 0.0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    for (const Post p : lines[k]) {
      double least2 = 1e30;
      for (std::size_t i = 1; i < simple[k].size(); ++i) {
        const glm::dvec3 a = place_m(simple[k][i - 1]), ab = place_m(simple[k][i]) - a, ap = place_m(p) - a;
        const double t = std::clamp(glm::dot(ap, ab) / glm::dot(ab, ab), 0.0, 1.0);
        least2 = std::min(least2, glm::dot(ap - t * ab, ap - t * ab));
      }
      most_m = std::max(most_m, std::sqrt(least2));
    }
  }
  CHECK(most_m <= tolerance_m * (1.0 + 1e-9));
}

TEST_CASE("chance and grid keep as many posts as asked, one per cell") {
  const TileLattice lattice = lattice_of([](int x, int y) { return 2.0 * x + y; });
  const auto posts = sample_posts(lattice);
  CHECK(posts.size() == 255 * 255);
  CHECK(random_points(posts, {.keep_ratio = 0.1}).size() == 6503);
  CHECK(random_points(posts, {.keep_ratio = 1.0}).size() == posts.size());
  CHECK(random_points(posts, {.keep_ratio = 0.1, .seed = 1}) != random_points(posts, {.keep_ratio = 0.1, .seed = 2}));
  std::map<std::pair<int, int>, int> cells;
  for (const Post p : grid_points(posts, {.cell_posts = 8})) ++cells[{p.x / 8, p.y / 8}];
  CHECK(cells.size() == 32 * 32);
  CHECK(std::all_of(cells.begin(), cells.end(), [](const auto& cell) { return cell.second == 1; }));
}

TEST_CASE("clusters are no larger than asked, and smaller where the ground bends") {
  const TileLattice lattice =
      lattice_of([](int x, int y) { return x < 128 ? 0.0 : 900.0 * std::sin(0.3 * x) * std::sin(0.3 * y); });
  const auto kept = hierarchy_points(lattice, sample_posts(lattice), {.cluster_posts = 100, .spacing_m = {90.0, 90.0}});
  const auto west = std::count_if(kept.begin(), kept.end(), [](Post p) { return p.x < 120; });
  CHECK(kept.size() >= 255 * 255 / 100);
  CHECK(west >= 255 * 119 / 100);
  CHECK(static_cast<std::ptrdiff_t>(kept.size()) - west > 4 * west);
}

TEST_CASE("projected points are spread more evenly than by chance, and smooth noise") {
  const TileLattice lattice = lattice_of([](int x, int y) {
    return 5.0 * x + static_cast<double>(mix64(static_cast<std::uint64_t>(x * 1000 + y + 5)) % 100);
  });
  const auto posts = sample_posts(lattice);
  // With the second radius every third post stands for those around it.
  const bool few = GENERATE(false, true);
  const SampleOptions options{
      .keep_ratio = few ? 0.006 : 0.02, .radius_posts = few ? 26.0 : 14.0, .spacing_m = {90.0, 90.0}};
  std::vector<glm::dvec3> by_chance;
  for (const Post p : random_points(posts, options)) by_chance.emplace_back(p.x, p.y, lattice.at(p.x, p.y));
  const auto moved = wlop_points(lattice, posts, options);
  REQUIRE(moved.size() == by_chance.size());
  const auto closest = [](const std::vector<glm::dvec3>& points) {  // mean distance to the nearest other, in posts
    double sum = 0.0;
    for (const glm::dvec3& p : points) {
      double least = 1e30;
      for (const glm::dvec3& q : points) {
        if (&p != &q) least = std::min(least, std::hypot(p.x - q.x, p.y - q.y));
      }
      sum += least;
    }
    return sum / static_cast<double>(points.size());
  };
  CHECK(closest(moved) > 1.3 * closest(by_chance));
  const auto noise_m = [](const std::vector<glm::dvec3>& points) {
    double sum = 0.0;
    for (const glm::dvec3& p : points) sum += std::fabs(p.z - 5.0 * p.x - 49.5);
    return sum / static_cast<double>(points.size());
  };
  CHECK(noise_m(moved) < 0.5 * noise_m(by_chance));
}
