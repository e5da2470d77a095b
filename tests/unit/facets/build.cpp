// SPDX-License-Identifier: MIT
#include <lodestone/facet_shift.h>
#include <lodestone/generate.h>
#include <lodestone/metrics.h>

#include <atomic>
#include <catch2/catch.hpp>

#include "crossings.h"
#include "shapes.h"
#include "walls.h"

namespace lodestone {
namespace {

void check_model(const ProgressiveModel& model, const Mesh& source) {
  const ModelReport report = validate(model);
  CHECK(report.fault.empty());
  CHECK(report.exact);
  CHECK(report.monotone);
  CHECK(report.in_use_consistent);
  CHECK(compare_with_source(model, source) == "");
}

TEST_CASE("a bulge and a depression come into the wall in one record, at the distance they move") {
  for (const float depth_m : {0.2F, -0.3F}) {
    CAPTURE(depth_m);
    const Mesh mesh = test::wall_with_panel(depth_m);
    const auto built = build_by_facet_shift(mesh);
    REQUIRE(built.ok());
    check_model(*built->model, mesh);
    CHECK(built->report.shifts + built->report.openings_flattened == 1);
    const Level flat = built->model->level_of_triangles(2);
    const Mesh end = built->model->extract(flat);
    CHECK(end.triangle_count() == 2);
    for (const glm::vec3& p : end.vertices.positions) CHECK(p.y == 0.0F);
    CHECK(built->model->error_m(flat) == Approx(std::abs(depth_m)).epsilon(0.01));
    // No level shows a tilted panel.
    for (Level level = 0; level <= built->model->record_count(); ++level) {
      CHECK(normal_deviation_rad(mesh, built->model->extract(level)) < 1e-6);
    }
  }
}

TEST_CASE("every family of meshes builds, exact and monotone") {
  for (const auto& [name, mesh] : test::mesh_families()) {
    CAPTURE(name);
    const auto built = build_by_facet_shift(mesh);
    REQUIRE(built.ok());
    check_model(*built->model, mesh);
  }
}

TEST_CASE("houses of every roof keep their planes and stay closed") {
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    CAPTURE(static_cast<int>(roof));
    HouseOptions options;
    options.triangles = 10'000;
    options.roof = roof;
    options.pixels = Pixels::Skip;
    const auto house = generate_house(options);
    REQUIRE(house.ok());
    const auto built = build_by_facet_shift(*house);
    REQUIRE(built.ok());
    check_model(*built->model, *house);
    for (const double ratio : {0.5, 0.2, 0.1, 0.05}) {
      const auto wanted = static_cast<std::uint32_t>(ratio * house->triangle_count());
      const Mesh level = built->model->extract(built->model->level_of_triangles(wanted));
      CAPTURE(ratio);
      CHECK(inspect(level).boundary_edges == 0);
      CHECK(normal_deviation_rad(*house, level) < glm::radians(ratio < 0.1 ? 0.7 : 0.1));
    }
  }
}

TEST_CASE("closed houses stay closed and pass through themselves at no level") {
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    CAPTURE(static_cast<int>(roof));
    HouseOptions options;
    options.triangles = 2000;
    options.roof = roof;
    options.pixels = Pixels::Skip;
    const auto house = generate_house(options);
    REQUIRE(house.ok());
    REQUIRE(test::count_crossings(*house) == 0);
    const auto built = build_by_facet_shift(*house);
    REQUIRE(built.ok());
    constexpr std::uint32_t steps = 20;
    for (std::uint32_t i = 0; i <= steps; ++i) {
      const Level level = built->model->record_count() * i / steps;
      CAPTURE(level);
      const Mesh shown = built->model->extract(level);
      CHECK(inspect(shown).boundary_edges == 0);
      CHECK(test::count_crossings(shown) == 0);
    }
  }
}

TEST_CASE("building stops at the target, at the error, and when cancelled") {
  const Mesh mesh = test::wall_with_panel(0.2F);
  const auto at_target = build_by_facet_shift(mesh, {.target_triangles = 10});
  REQUIRE(at_target.ok());
  CHECK(at_target->model->info(0).triangles <= 10);
  const auto at_error = build_by_facet_shift(mesh, {.max_error_m = 0.1});
  REQUIRE(at_error.ok());
  CHECK(at_error->model->error_m(0) <= 0.1);
  CHECK(at_error->report.shifts == 0);
  std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  const auto cancelled = build_by_facet_shift(mesh, {}, context);
  REQUIRE_FALSE(cancelled.ok());
  CHECK(cancelled.error().code == ErrorCode::Cancelled);
}

}  // namespace
}  // namespace lodestone
