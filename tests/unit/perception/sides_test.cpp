// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>

#include <lodestone/edge_collapse.h>
#include <lodestone/perception.h>

#include "shapes.h"

using namespace lodestone;

namespace {

constexpr double degree = M_PI / 180.0;

// A box, 10 m by 4 m by 3 m, whose long side with `windows` small faces looks to `azimuth_rad`.
Mesh house(double azimuth_rad, int windows) {
  Mesh mesh;
  mesh.materials.emplace_back();
  const auto point = [&](double right, double out, double up) {
    // `out` points to the azimuth, `right` is to the right of who looks that way.
    const double x = out * std::sin(azimuth_rad) + right * std::cos(azimuth_rad);
    const double y = out * std::cos(azimuth_rad) - right * std::sin(azimuth_rad);
    mesh.vertices.positions.emplace_back(x, y, up);
    return mesh.vertex_count() - 1;
  };
  const auto quad = [&](VertexId a, VertexId b, VertexId c, VertexId d) {
    mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
  };
  const auto wall = [&](glm::dvec2 from, glm::dvec2 to) {
    quad(point(from.x, from.y, 0), point(to.x, to.y, 0), point(to.x, to.y, 3), point(from.x, from.y, 3));
  };
  wall({5, 2}, {-5, 2});  // front
  wall({-5, 2}, {-5, -2});
  wall({-5, -2}, {5, -2});
  wall({5, -2}, {5, 2});
  for (int i = 0; i < windows; ++i) {
    const double x = -4.0 + 8.0 * i / windows;
    quad(point(x + 0.3, 2.1, 1), point(x, 2.1, 1), point(x, 2.1, 2), point(x + 0.3, 2.1, 2));
  }
  return mesh;
}

double between(double a, double b) { return std::abs(std::remainder(a - b, 2.0 * M_PI)); }

ObjectPicture dotted(std::uint32_t size, std::uint8_t dark) {
  ObjectPicture picture{Image{size, size, 1, {}}, std::vector<std::uint8_t>(std::size_t{size} * size, 1)};
  for (std::uint32_t i = 0; i < size * size; ++i) picture.image.pixels.push_back(i % 2 == 0 ? dark : 200);
  return picture;
}

}  // namespace

TEST_CASE("the front of a building is the side with the most faces, however it is turned") {
  for (const double azimuth : {0.0, 17.0, 90.0, 133.0, 200.0, 311.0}) {
    const Sides sides = find_sides(house(azimuth * degree, 6));
    CHECK(between(sides.front_rad, azimuth * degree) < 0.5 * degree);
    CHECK(between(sides.back_rad(), (azimuth + 180.0) * degree) < 0.5 * degree);
    // Who stands before a front that faces north looks south: east is to the left.
    CHECK(between(sides.left_rad(), (azimuth + 90.0) * degree) < 0.5 * degree);
    CHECK(between(sides.right_rad(), (azimuth - 90.0) * degree) < 0.5 * degree);
    CHECK(sides.bounds.radius_m == Approx(std::sqrt(25.0 + 2.05 * 2.05 + 1.5 * 1.5)).epsilon(0.02));
  }
}

TEST_CASE("a mesh without walls is looked at from the south, an empty one has no extent") {
  CHECK(find_sides(test::grid(4, 4, 0.0F)).front_rad == Approx(M_PI));
  CHECK(find_sides(Mesh{}).bounds.radius_m == 0.0);
}

TEST_CASE("sides are pooled by pixels, not by their ratios") {
  const auto side = [](std::uint64_t first, std::uint64_t second, std::uint64_t lost) {
    return std::vector<DetailSample>{{10.0, 1.0, {first, 0}}, {20.0, 0.0, {second, lost}}};
  };
  const auto pooled = pool_sides({side(1000, 300, 100), side(100, 50, 50)});
  REQUIRE(pooled.size() == 2);
  CHECK(pooled[0].metric == 1.0);
  CHECK(pooled[1].metric == Approx((350.0 - 150.0) / 1100.0));
  CHECK(pooled[1].detail.object_pixels == 350);
}

TEST_CASE("further sides are sampled at the distances of the first, which must ascend from above 0") {
  const VisionModel vision{Display{}};
  const auto render = [](double distance_m) -> Result<ObjectPicture> {
    return dotted(static_cast<std::uint32_t>(400.0 / distance_m), 150);
  };
  const auto samples = sample_metric_at({10.0, 17.0, 40.0}, vision, render);
  REQUIRE(samples.ok());
  CHECK(samples->at(1).distance_m == 17.0);
  CHECK(samples->at(0).detail.object_pixels == 1600);
  CHECK(samples->at(2).detail.object_pixels == 100);
  for (const std::vector<double>& wrong : {std::vector<double>{}, {0.0, 1.0}, {2.0, 1.0}, {std::nan(""), 1.0}}) {
    CHECK_FALSE(sample_metric_at(wrong, vision, render).ok());
  }
}

TEST_CASE("a picture of one colour has no object, samples that never change have no fit") {
  const VisionModel vision{Display{}};
  ObjectPicture blank{Image{64, 64, 3, std::vector<std::uint8_t>(64 * 64 * 3, 255)},
                      std::vector<std::uint8_t>(64 * 64)};
  const auto detail = visible_detail(blank, vision);
  REQUIRE_FALSE(detail.ok());
  CHECK(detail.error().message.find("belongs to the object") != std::string::npos);
  CHECK_FALSE(check_simulation(blank, vision).ok());
  CHECK_FALSE(difference_map(blank, vision).ok());
  std::vector<DetailSample> same;
  for (int i = 0; i < 10; ++i) same.push_back({10.0 + i, 0.5, {}});
  const auto fit = fit_detail(same);
  REQUIRE_FALSE(fit.ok());
  CHECK(fit.error().code == ErrorCode::BadArgument);
}

TEST_CASE("the check of the vision model sees fine dots go and coarse ones stay") {
  Display far;
  far.viewing_distance_m = 2.0;
  const auto fine = check_simulation(dotted(64, 100), VisionModel{far});
  const auto near = check_simulation(dotted(64, 100), VisionModel{Display{}});
  REQUIRE(fine.ok());
  REQUIRE(near.ok());
  CHECK(fine->ssim < 0.5);
  CHECK(near->ssim > fine->ssim);
  const auto map = difference_map(dotted(64, 100), VisionModel{far});
  REQUIRE(map.ok());
  CHECK(*map->at(30, 30) < 100);
}

TEST_CASE("levels are made as fine as the cost of another plan allows, and no finer") {
  const auto built = build_by_edge_collapse(test::sphere(48, 96));
  REQUIRE(built.ok());
  const ProgressiveModel& model = *built->model;
  DetailFit fit;
  fit.a = 0.7;
  fit.b = -0.5;
  fit.c = 0.2;
  fit.d = -0.1;
  const double first_m = 4.0;
  const double last_m = 2000.0;
  const double focal_px = 1700.0;
  SwitchPlan plan = equal_intervals(fit, 4, 5.0, last_m);
  add_cost(plan, model, first_m, last_m, focal_px);
  CHECK(plan.levels.size() == 4);
  CHECK(std::is_sorted(plan.triangles.rbegin(), plan.triangles.rend()));
  SwitchPlan cheaper = plan;
  match_cost(cheaper, 0.5 * plan.cost, model, first_m, last_m, focal_px);
  CHECK(cheaper.cost <= 0.5 * plan.cost);
  CHECK(cheaper.allowed_px > plan.allowed_px);
  SwitchPlan finer = cheaper;
  finer.allowed_px *= 0.98;
  add_cost(finer, model, first_m, last_m, focal_px);
  CHECK(finer.cost > 0.5 * plan.cost);
  SwitchPlan dearer = plan;
  match_cost(dearer, 2.0 * plan.cost, model, first_m, last_m, focal_px);
  CHECK(dearer.allowed_px < plan.allowed_px);
}
