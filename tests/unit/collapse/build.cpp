// SPDX-License-Identifier: MIT
#include <lodestone/edge_collapse.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>

#include "shapes.h"

namespace lodestone {
namespace {

TEST_CASE("every family builds down to its end, exact and monotone") {
  for (const auto& [name, mesh] : test::mesh_families()) {
    for (const Placement placement :
         {Placement::Optimal, Placement::OnEdge, Placement::Midpoint, Placement::EndPoint, Placement::Subset}) {
      CAPTURE(name, static_cast<int>(placement));
      const auto built = build_by_edge_collapse(mesh, {.placement = placement});
      if (!built.ok()) FAIL(to_line(built.error()));
      const ModelReport report = validate(*built->model);
      CHECK(report.fault.empty());
      CHECK(report.exact);
      CHECK(report.monotone);
      CHECK(report.in_use_consistent);
      CHECK(compare_with_source(*built->model, mesh).empty());
    }
  }
}

TEST_CASE("the finest level is the source where nothing may collapse") {
  const Mesh mesh = test::sphere(8, 12);
  EdgeCollapseOptions options;
  options.frozen.assign(mesh.vertex_count(), 1);
  const auto built = build_by_edge_collapse(mesh, options);
  REQUIRE(built.ok());
  CHECK(built->model->record_count() == 0);
  CHECK_FALSE(built->report.target_reached);
}

TEST_CASE("the same bytes come from 1, 2 and 8 workers") {
  const Mesh mesh = test::sphere(240, 320);
  std::vector<ModelData> models;
  for (const unsigned workers : {1U, 2U, 8U}) {
    Context context;
    context.max_workers = workers;
    const auto built = build_by_edge_collapse(mesh, {.target_triangles = 2000}, context);
    REQUIRE(built.ok());
    models.push_back(built->model->data());
  }
  for (const ModelData& data : {models[1], models[2]}) {
    CHECK(data.vertices == models[0].vertices);
    CHECK(data.shapes == models[0].shapes);
    CHECK(data.fan_corners == models[0].fan_corners);
    CHECK(data.edits == models[0].edits);
    CHECK(data.value_xor == models[0].value_xor);
    CHECK(data.errors == models[0].errors);
    CHECK(data.base_indices == models[0].base_indices);
  }
}

TEST_CASE("a vertex of very many faces costs no more than its faces") {
  // With the square of them the first would take minutes, with the cube the second an hour.
  constexpr std::uint32_t rim = 20'000;
  Mesh fan;
  fan.materials.emplace_back();
  fan.vertices.positions.emplace_back(0.0F, 0.0F, 1.0F);
  for (std::uint32_t i = 0; i < rim; ++i) {
    const double angle = 6.283185307179586 * i / rim;
    fan.vertices.positions.emplace_back(10.0 * std::cos(angle), 10.0 * std::sin(angle), 0.0);
    fan.indices.insert(fan.indices.end(), {0, i + 1, (i + 1) % rim + 1});
  }
  const auto open = build_by_edge_collapse(fan, {.target_triangles = 10});
  REQUIRE(open.ok());
  CHECK(open->report.target_reached);
  const auto locked = build_by_edge_collapse(fan, {.borders = Borders::Lock, .target_triangles = 10});
  REQUIRE(locked.ok());
  CHECK_FALSE(locked->report.target_reached);
  CHECK_FALSE(locked->report.sentence.empty());
}

TEST_CASE("building stops soon after it is cancelled") {
  std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  const auto built = build_by_edge_collapse(test::sphere(50, 50), {}, context);
  REQUIRE_FALSE(built.ok());
  CHECK(built.error().code == ErrorCode::Cancelled);
}

}  // namespace
}  // namespace lodestone
