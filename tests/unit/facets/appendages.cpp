// SPDX-License-Identifier: MIT
// What hangs on a building free of it: it shifts flat onto that and goes behind.
#include <lodestone/cursor.h>
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>

#include <catch2/catch.hpp>

#include "data.h"
#include "small_house.h"

namespace lodestone {
namespace {

void add_quad(Mesh& mesh, const std::array<glm::vec3, 4>& corners) {
  const VertexId first = mesh.vertex_count();
  mesh.vertices.positions.insert(mesh.vertices.positions.end(), corners.begin(), corners.end());
  for (const VertexId k : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + k);
}

// Closed, turned outwards, the corners shared.
void add_box(Mesh& mesh, const glm::vec3& low, const glm::vec3& high) {
  const VertexId first = mesh.vertex_count();
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.positions.push_back(
        {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z});
  }
  for (const auto& q : {std::array{0U, 2U, 3U, 1U},
                        {4U, 5U, 7U, 6U},
                        {0U, 1U, 5U, 4U},
                        {2U, 6U, 7U, 3U},
                        {0U, 4U, 6U, 2U},
                        {1U, 3U, 7U, 5U}}) {
    for (const std::size_t k : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + q[k]);
  }
}

// 10 m wide and 6 m high in the plane y = 0, seen from y < 0.
Mesh plain_wall() {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_quad(mesh, {{{0, 0, 0}, {10, 0, 0}, {10, 0, 6}, {0, 0, 6}}});
  return mesh;
}

// What stands before the wall is as far out as at first or flat in the wall, at every level; and flat at one at least.
void check_sinks(const Mesh& mesh, const FacetShiftResult& built) {
  CHECK(compare_with_source(*built.model, mesh) == "");
  CHECK(built.report.parts_vanished == 1);
  CHECK(built.report.parts_sunk == 1);
  const double out_m = bounds(mesh).min.y;
  bool flat = false;
  for (Level level = 0; level <= built.model->record_count(); ++level) {
    const Mesh shown = built.model->extract(level);
    const Box box = bounds(shown);
    flat = flat || (shown.triangle_count() > 2 && box.min.y > -1e-6);
    CHECK((box.min.y < 0.7 * out_m || box.min.y > -1e-6));
  }
  CHECK(flat);
}

TEST_CASE("a box that is let into the wall goes back into it in one record, each corner to its own foot") {
  Mesh mesh = plain_wall();
  add_box(mesh, {4, -0.2F, 2}, {5, 0.05F, 2.8F});
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(compare_with_source(*built->model, mesh) == "");
  const ProgressiveModel& model = *built->model;
  Cursor cursor{built->model, {.morph_seconds = 1.0, .start_level = model.record_count()}};
  cursor.set_target(Target::level(model.level_of_triangles(2)));
  double last_m = 1.0;
  while (!cursor.step({}, 0.01).arrived) {
    last_m = 0.0;
    for (const DrawRange& range : cursor.draws()) {
      for (std::uint32_t i = range.first_index; i < range.first_index + range.index_count; ++i) {
        const glm::vec3 p = cursor.positions()[cursor.index(i)];
        last_m = std::max(last_m, -double{p.y});
        if (p.x < 1.0F || p.x > 9.0F) continue;
        // Neither wider nor lower on its way.
        CHECK(std::min(std::abs(p.x - 4.0F), std::abs(p.x - 5.0F)) < 1e-4F);
        CHECK(std::min(std::abs(p.z - 2.0F), std::abs(p.z - 2.8F)) < 1e-4F);
      }
    }
  }
  CHECK(last_m < 1e-3);
  CHECK(model.error_m(model.level_of_triangles(2)) < 0.26);
}

TEST_CASE("a pipe that hangs free before the wall goes flat onto it and vanishes behind it") {
  Mesh mesh = plain_wall();
  constexpr std::uint32_t sides = 8;
  const VertexId first = mesh.vertex_count();
  for (const float z : {0.5F, 5.5F}) {
    for (std::uint32_t i = 0; i < sides; ++i) {
      const float angle = 6.2831853F * static_cast<float>(i) / sides;
      mesh.vertices.positions.push_back({8.0F + 0.06F * std::cos(angle), -0.11F + 0.06F * std::sin(angle), z});
    }
  }
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t j = (i + 1) % sides;
    for (const std::uint32_t k : {i, j, sides + j, i, sides + j, sides + i}) mesh.indices.push_back(first + k);
  }
  // The pipe may lose sides first; what is left of it sinks.
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  check_sinks(mesh, *built);
}

TEST_CASE("a pole on the ridge of a roof goes straight down into it and does not lean over") {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_quad(mesh, {{{0, 0, 3}, {10, 0, 3}, {10, 4, 6}, {0, 4, 6}}});
  add_quad(mesh, {{{10, 8, 3}, {0, 8, 3}, {0, 4, 6}, {10, 4, 6}}});
  add_box(mesh, {4.99F, 3.99F, 5.9F}, {5.01F, 4.01F, 7.5F});
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(built->report.parts_sunk == 1);
  const ProgressiveModel& model = *built->model;
  Cursor cursor{built->model, {.morph_seconds = 1.0, .start_level = model.record_count()}};
  cursor.set_target(Target::level(model.level_of_triangles(4)));
  while (!cursor.step({}, 0.01).arrived) {
    for (const DrawRange& range : cursor.draws()) {
      for (std::uint32_t i = range.first_index; i < range.first_index + range.index_count; ++i) {
        const glm::vec3 p = cursor.positions()[cursor.index(i)];
        if (p.x < 1.0F || p.x > 9.0F) continue;
        CHECK(std::abs(p.y - 4.0F) < 0.02F);
      }
    }
  }
}

TEST_CASE("balconies, railings and ornaments of generated houses sink into what they hang on") {
  const Mesh house = test::small_house(20'000);
  const auto built = build_by_facet_shift(house);
  REQUIRE(built.ok());
  CHECK(built->report.parts_vanished > 50);
  CHECK(built->report.parts_sunk > 0.8 * built->report.parts_vanished);
  const ModelReport report = validate(*built->model);
  CHECK(report.fault.empty());
  CHECK((report.exact && report.monotone && report.in_use_consistent));
}

TEST_CASE("so do the railings of a real building") {
  LODESTONE_REQUIRE_DATA(root);
  const auto loaded = read_mesh(root / "buildings/4018210/4018210.obj", {.textures = LoadTextures::Reference});
  REQUIRE(loaded.ok());
  const auto built = build_by_facet_shift(loaded->mesh);
  REQUIRE(built.ok());
  CHECK(built->report.parts_vanished > 3);
  CHECK(built->report.parts_sunk > 0.8 * built->report.parts_vanished);
}

}  // namespace
}  // namespace lodestone
