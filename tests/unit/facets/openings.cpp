// SPDX-License-Identifier: MIT
#include <lodestone/facet_shift.h>
#include <lodestone/metrics.h>

#include <catch2/catch.hpp>

#include "shapes.h"

namespace lodestone {
namespace {

void add_quad(Mesh& mesh, MaterialId material, const std::array<glm::vec3, 4>& corners) {
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  mesh.vertices.positions.insert(mesh.vertices.positions.end(), corners.begin(), corners.end());
  mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  mesh.face_materials.insert(mesh.face_materials.end(), 2, material);
}

// A wall of 10 m by 6 m in the plane y = 0 with a window hole of 1 m by 1.5 m; in it, sharing no point with the wall, a
// pane `depth` behind the wall with a frame of four bars before it.
Mesh wall_with_loose_window(float depth) {
  Mesh mesh;
  mesh.materials.resize(2);
  add_quad(mesh, 0, {{{0, 0, 0}, {10, 0, 0}, {5, 0, 2}, {4, 0, 2}}});
  add_quad(mesh, 0, {{{10, 0, 0}, {10, 0, 6}, {5, 0, 3.5F}, {5, 0, 2}}});
  add_quad(mesh, 0, {{{10, 0, 6}, {0, 0, 6}, {4, 0, 3.5F}, {5, 0, 3.5F}}});
  add_quad(mesh, 0, {{{0, 0, 6}, {0, 0, 0}, {4, 0, 2}, {4, 0, 3.5F}}});
  const auto front = [&](MaterialId material, float x0, float x1, float z0, float z1, float y) {
    add_quad(mesh, material, {{{x0, y, z0}, {x1, y, z0}, {x1, y, z1}, {x0, y, z1}}});
  };
  front(1, 4.01F, 4.99F, 2.01F, 3.49F, depth);
  front(0, 4.02F, 4.06F, 2.02F, 3.48F, depth - 0.02F);
  front(0, 4.94F, 4.98F, 2.02F, 3.48F, depth - 0.02F);
  return mesh;
}

double area_of(const Mesh& mesh, MaterialId material) {
  double sum = 0.0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    if (mesh.face_material(f) != material) continue;
    const auto at = [&](std::uint32_t k) {
      return glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
    };
    sum += 0.5 * glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
  }
  return sum;
}

TEST_CASE("a loose window comes forward, is sewn to its hole, and goes whole at the error of its own size") {
  const Mesh mesh = wall_with_loose_window(0.1F);
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(compare_with_source(*built->model, mesh) == "");
  CHECK(built->report.openings_flattened == 1);
  CHECK(built->report.openings_filled == 1);
  bool flush = false;
  for (Level level = 0; level <= built->model->record_count(); ++level) {
    CAPTURE(level);
    const Mesh shown = built->model->extract(level);
    CHECK(normal_deviation_rad(mesh, shown) < 1e-6);
    const double window = area_of(shown, 1);
    // A window has its own outline or is gone: nothing of its colour in between.
    CHECK((window == Approx(1.5).epsilon(1e-4) || window == Approx(0.98 * 1.48).epsilon(1e-4) || window == 0.0));
    // The wall never covers a window that is there, and covers all where it is not.
    if (window == 0.0) {
      CHECK(area_of(shown, 0) == Approx(60.0).epsilon(1e-4));
      CHECK(built->model->error_m(level) > 0.3);
    }
    flush = flush || (window == Approx(1.5).epsilon(1e-4) && area_of(shown, 0) == Approx(58.5).epsilon(1e-4));
  }
  CHECK(flush);
}

TEST_CASE("the bars of a deep window give way to its pane before that comes forward") {
  Mesh mesh = wall_with_loose_window(0.2F);
  for (const float x : {4.2F, 4.4F, 4.6F, 4.8F}) {
    add_quad(mesh, 0, {{{x, 0.18F, 2.02F}, {x + 0.03F, 0.18F, 2.02F}, {x + 0.03F, 0.18F, 3.48F}, {x, 0.18F, 3.48F}}});
  }
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(built->report.openings_recessed == 1);
  CHECK(built->report.openings_flattened == 1);
  // All but the wall of eight and a pane of two is gone at the depth of the bars, and the pane is where the source's
  // is.
  const Mesh shown = built->model->extract(built->model->level_of_triangles(10));
  REQUIRE(shown.triangle_count() == 10);
  CHECK(built->model->error_m(built->model->level_of_triangles(10)) < 0.1F);
  CHECK(normal_deviation_rad(mesh, shown) < 1e-6);
  CHECK(compare(mesh, shown, {.samples = 20'000})->hausdorff_m < 0.05);
}

TEST_CASE("a window whose sash stands open closes at the error of the hole that one saw through") {
  Mesh mesh = wall_with_loose_window(0.1F);
  // The pane covers a third of the hole and hangs on a leaf of many faces that stands into the room.
  mesh.indices.resize(std::size_t{3} * 8);
  mesh.face_materials.resize(8);
  add_quad(mesh, 1, {{{4.0F, 0.1F, 2}, {4.35F, 0.1F, 2}, {4.35F, 0.1F, 3.5F}, {4.0F, 0.1F, 3.5F}}});
  for (const float x : {4.35F, 4.4F, 4.45F}) {
    add_quad(mesh, 1, {{{x, 0.1F, 2}, {x, 0.6F, 2}, {x, 0.6F, 3.5F}, {x, 0.1F, 3.5F}}});
  }
  add_quad(mesh, 1, {{{4.35F, 0.6F, 2}, {4.45F, 0.6F, 2}, {4.45F, 0.6F, 3.5F}, {4.35F, 0.6F, 3.5F}}});
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(compare_with_source(*built->model, mesh) == "");
  bool closed = false;
  for (Level level = 0; level <= built->model->record_count(); ++level) {
    if (area_of(built->model->extract(level), 1) != Approx(1.5).epsilon(1e-4)) continue;
    closed = true;
    CHECK(built->model->error_m(level) > 0.59F);
  }
  CHECK(closed);
}

TEST_CASE("of two windows the one whose texture looks like the wall's goes first") {
  Mesh mesh = wall_with_loose_window(0.1F);
  const Mesh other = wall_with_loose_window(0.1F);
  const auto first = static_cast<VertexId>(mesh.vertices.size());
  for (const glm::vec3& p : other.vertices.positions) mesh.vertices.positions.push_back(p + glm::vec3{20, 0, 0});
  for (const VertexId v : other.indices) mesh.indices.push_back(first + v);
  for (const MaterialId m : other.face_materials) mesh.face_materials.push_back(2 * m);
  mesh.materials.resize(3);
  mesh.textures.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) mesh.materials[i].texture = i;
  const auto first_to_go = [&](const std::vector<glm::vec3>& colors) {
    const auto built = build_by_facet_shift(mesh, {.texture_colors = colors});
    REQUIRE(built.ok());
    for (Level level = built->model->record_count() + 1; level-- > 0;) {
      const Mesh shown = built->model->extract(level);
      if (area_of(shown, 1) == 0.0) return 1;
      if (area_of(shown, 2) == 0.0) return 2;
    }
    return 0;
  };
  constexpr glm::vec3 white{1.0F};
  constexpr glm::vec3 black{0.0F};
  CHECK(first_to_go({white, white, black}) == 1);
  CHECK(first_to_go({white, black, white}) == 2);
}

TEST_CASE("an opening with nothing in it stays open as long as a window would stay") {
  Mesh mesh = wall_with_loose_window(0.1F);
  mesh.indices.resize(3 * 8);
  mesh.face_materials.resize(8);
  const auto built = build_by_facet_shift(mesh, {.max_error_m = 0.3});
  REQUIRE(built.ok());
  CHECK(area_of(built->model->extract(0), 0) == Approx(58.5).epsilon(1e-4));
}

TEST_CASE("a pane that lies flat in the wall without its frame is of the colour that fills most of the window") {
  Mesh mesh = wall_with_loose_window(0.1F);
  mesh.materials.resize(3);
  mesh.materials[0].base_color = {0.2F, 0.2F, 0.2F, 1.0F};
  mesh.materials[1].base_color = {0.4F, 0.5F, 0.9F, 1.0F};
  mesh.materials[2].base_color = {1.0F, 1.0F, 1.0F, 1.0F};
  // In place of the two narrow bars, four white ones of 15 cm, all around, boxes without their backs.
  mesh.indices.resize(std::size_t{3} * 10);
  mesh.face_materials.resize(10);
  const auto bar = [&](float x0, float x1, float z0, float z1) {
    constexpr float y0 = 0.04F;
    constexpr float y1 = 0.09F;
    add_quad(mesh, 2, {{{x0, y0, z0}, {x1, y0, z0}, {x1, y0, z1}, {x0, y0, z1}}});
    add_quad(mesh, 2, {{{x0, y1, z0}, {x0, y0, z0}, {x0, y0, z1}, {x0, y1, z1}}});
    add_quad(mesh, 2, {{{x1, y0, z0}, {x1, y1, z0}, {x1, y1, z1}, {x1, y0, z1}}});
  };
  bar(4.0F, 4.15F, 2.0F, 3.5F);
  bar(4.85F, 5.0F, 2.0F, 3.5F);
  bar(4.15F, 4.85F, 2.0F, 2.15F);
  bar(4.15F, 4.85F, 3.35F, 3.5F);
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(compare_with_source(*built->model, mesh) == "");
  bool plain = false;
  for (Level level = 0; level <= built->model->record_count(); ++level) {
    const Mesh shown = built->model->extract(level);
    if (bounds(shown).max.y > 1e-6 || area_of(shown, 2) > 1e-6) continue;
    const double pane = area_of(shown, 1);
    plain = plain || pane > 0.0;
    CHECK((pane == 0.0 || pane == Approx(1.5).epsilon(1e-3)));
  }
  CHECK(plain);
}

TEST_CASE("walls in pieces are sewn at T-junctions, and the finest level still counts as the source") {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_quad(mesh, 0, {{{0, 0, 0}, {4, 0, 0}, {4, 0, 2}, {0, 0, 2}}});
  add_quad(mesh, 0, {{{0, 0, 2}, {1, 0, 2}, {1, 0, 4}, {0, 0, 4}}});
  add_quad(mesh, 0, {{{1, 0, 2}, {4, 0, 2}, {4, 0, 4}, {1, 0, 4}}});
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(built->report.closed_t_junctions == 1);
  CHECK(compare_with_source(*built->model, mesh) == "");
  CHECK(built->model->extract(built->model->level_of_triangles(2)).triangle_count() == 2);
  const auto left = build_by_facet_shift(mesh, {.t_junction_tolerance_m = 0.0});
  REQUIRE(left.ok());
  CHECK(left->model->info(left->model->record_count()).triangles == mesh.triangle_count());
  // A triangle more, or one that is somewhere else, is still told.
  Mesh other = mesh;
  other.vertices.positions[4].z += 0.01F;
  CHECK(compare_with_source(*built->model, other) != "");
  other = mesh;
  other.indices.resize(other.indices.size() - 3);
  other.face_materials.pop_back();
  CHECK(compare_with_source(*built->model, other) != "");
}

}  // namespace
}  // namespace lodestone
