// SPDX-License-Identifier: MIT
#include <lodestone/cursor.h>
#include <lodestone/facet_shift.h>
#include <lodestone/generate.h>
#include <lodestone/metrics.h>

#include <atomic>
#include <catch2/catch.hpp>

#include "checked_model.h"
#include "crossings.h"
#include "shapes.h"
#include "small_house.h"
#include "walls.h"

namespace lodestone {
namespace {

TEST_CASE("a bulge and a depression come into the wall in one record, at the distance they move") {
  for (const float depth_m : {0.2F, -0.3F}) {
    CAPTURE(depth_m);
    const Mesh mesh = test::wall_with_panel(depth_m);
    const auto built = build_by_facet_shift(mesh);
    REQUIRE(built.ok());
    test::check_model(*built->model, mesh);
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

TEST_CASE("a detached part that goes with no plane to sink into has shrunk to nothing when it is gone") {
  Mesh mesh;
  mesh.materials.emplace_back();
  mesh.vertices.positions = {{0, 0, 0}, {10, 0, 0}, {10, 0, 6}, {0, 0, 6}};
  for (const glm::vec3& p : {glm::vec3{10.02F, 0, 2}, {10.32F, 0, 2}, {10.02F, 0, 2.3F}}) {
    mesh.vertices.positions.push_back(p);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3, 4, 5, 6};
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  REQUIRE(built->report.parts_vanished == 1);
  CHECK(built->report.parts_sunk == 0);
  const Level whole = built->model->record_count();
  Cursor cursor{built->model, {.morph_seconds = 1.0, .start_level = whole}};
  const auto drawn_m2 = [&] {
    double sum = 0.0;
    for (const DrawRange& range : cursor.draws()) {
      for (std::uint32_t i = range.first_index; i < range.first_index + range.index_count; i += 3) {
        const auto at = [&](std::uint32_t k) { return glm::dvec3{cursor.positions()[cursor.index(i + k)]}; };
        sum += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
      }
    }
    return sum;
  };
  CHECK(drawn_m2() == Approx(60.045));
  cursor.set_target(Target::level(whole - 1));
  double before = 0.0;
  while (!cursor.step({}, 0.01).arrived) before = drawn_m2();
  CHECK(before == Approx(60.0).margin(0.001));
  CHECK(drawn_m2() == Approx(60.0).margin(1e-6));
}

TEST_CASE("every family of meshes builds, exact and monotone") {
  for (const auto& [name, mesh] : test::mesh_families()) {
    CAPTURE(name);
    const auto built = build_by_facet_shift(mesh);
    REQUIRE(built.ok());
    test::check_model(*built->model, mesh);
  }
}

TEST_CASE("houses of every roof keep their planes and stay closed") {
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    CAPTURE(static_cast<int>(roof));
    const Mesh house = test::small_house(10'000, roof);
    const auto built = build_by_facet_shift(house);
    REQUIRE(built.ok());
    test::check_model(*built->model, house);
    for (const double ratio : {0.5, 0.2, 0.1, 0.05}) {
      const auto wanted = static_cast<std::uint32_t>(ratio * house.triangle_count());
      const Mesh level = built->model->extract(built->model->level_of_triangles(wanted));
      CAPTURE(ratio);
      CHECK(inspect(level).boundary_edges == 0);
      CHECK(normal_deviation_rad(house, level) < glm::radians(ratio < 0.1 ? 0.7 : 0.1));
    }
  }
}

TEST_CASE("closed houses stay closed and pass through themselves nowhere where they did not from the start") {
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    CAPTURE(static_cast<int>(roof));
    const Mesh house = test::small_house(2000, roof);
    // A finial stands in its roof from the start.
    const std::uint32_t from_the_start = test::count_crossings(house);
    const auto built = build_by_facet_shift(house);
    REQUIRE(built.ok());
    constexpr std::uint32_t steps = 20;
    for (std::uint32_t i = 0; i <= steps; ++i) {
      const Level level = built->model->record_count() * i / steps;
      CAPTURE(level);
      const Mesh shown = built->model->extract(level);
      CHECK(inspect(shown).boundary_edges == 0);
      CHECK(test::count_crossings(shown) <= from_the_start);
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

TEST_CASE("points within the tolerance move as one, and the finest level keeps them apart") {
  // The same panel, with every triangle's corners moved by up to half a millimetre.
  Mesh mesh = test::unwelded(test::wall_with_panel(0.2F));
  mesh.vertices.normals.clear();
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    mesh.vertices.positions[v].x += 0.00005F * static_cast<float>(v % 7);
    mesh.vertices.positions[v].z -= 0.00005F * static_cast<float>(v % 5);
  }
  const auto apart = build_by_facet_shift(mesh, {.t_junction_tolerance_m = 0.0});
  REQUIRE(apart.ok());
  CHECK(apart->report.shifts + apart->report.openings_flattened == 0);
  const auto welded = build_by_facet_shift(mesh, {.weld_tolerance_m = 0.002, .t_junction_tolerance_m = 0.0});
  REQUIRE(welded.ok());
  test::check_model(*welded->model, mesh);
  CHECK(welded->report.shifts + welded->report.openings_flattened == 1);
  const Level flat = welded->model->level_of_triangles(2);
  CHECK(welded->model->extract(flat).triangle_count() == 2);
  CHECK(welded->model->error_m(flat) == Approx(0.2).epsilon(0.02));
  CHECK(welded->model->error_m(welded->model->record_count() - 1) >= 0.002);
}

TEST_CASE("together, the windows of a facade are one record, and the model ends as before") {
  const Mesh house = test::small_house(3000);
  const auto single = build_by_facet_shift(house);
  const auto joined = build_by_facet_shift(house, {.order = ShiftOrder::Together});
  REQUIRE((single.ok() && joined.ok()));
  test::check_model(*joined->model, house);
  const std::uint32_t openings = joined->report.openings_flattened + joined->report.openings_filled;
  CHECK(openings > 10);
  CHECK(joined->model->record_count() + openings / 2 < single->model->record_count());
  CHECK(joined->report.reached_block);
  CHECK(joined->model->info(0).triangles == single->model->info(0).triangles);
}

TEST_CASE("rooms that cannot be seen go first, at no error, and nothing else does") {
  Mesh house = test::small_house(3000);
  const std::uint32_t outside = house.triangle_count();
  const auto room_feature = static_cast<FeatureId>(house.features.size());
  house.features.push_back({"room", "Room", none});
  // A closed room in the middle of the body, seen from within.
  const Mesh cube = test::cube();
  const Box box = bounds(house);
  const glm::vec3 middle{0.5F * glm::vec3{box.min + box.max}};
  const VertexId first = house.vertex_count();
  for (const glm::vec3& p : cube.vertices.positions) {
    house.vertices.positions.push_back({middle.x + p.x, middle.y + p.y, float(box.min.z) + 2.0F + 0.5F * p.z});
    house.vertices.normals.push_back({0, 0, 1});
    house.vertices.uvs.push_back({0, 0});
  }
  for (FaceId f = 0; f < cube.triangle_count(); ++f) {
    for (const std::uint32_t k : {0U, 2U, 1U}) house.indices.push_back(first + cube.indices[3 * f + k]);
    house.face_materials.push_back(0);
    house.face_features.push_back(room_feature);
  }
  const auto rooms_in = [&](const Mesh& mesh) {
    return std::count(mesh.face_features.begin(), mesh.face_features.end(), room_feature);
  };
  // Through the glass of the windows it is seen.
  CHECK(build_by_facet_shift(house, {.interior = Interior::DropFirst})->report.interior_faces < 12);
  for (Material& material : house.materials) material.base_color.a = 1.0F;
  const auto built = build_by_facet_shift(house, {.interior = Interior::DropFirst});
  REQUIRE(built.ok());
  test::check_model(*built->model, house);
  CHECK(built->report.interior_faces >= 12);
  CHECK(built->report.interior_faces < outside / 4);
  const Level level = built->model->level_of_triangles(house.triangle_count() - built->report.interior_faces);
  CHECK(built->model->error_m(level) == 0.0);
  CHECK(rooms_in(built->model->extract(level)) == 0);
  CHECK(rooms_in(built->model->extract(built->model->record_count())) == 12);
}

}  // namespace
}  // namespace lodestone
