// SPDX-License-Identifier: MIT
// Doors and gates that reach the foot of their wall.
#include <lodestone/facet_shift.h>
#include <lodestone/polygon.h>

#include <catch2/catch.hpp>

#include "crossings.h"

namespace lodestone {
namespace {

// A polygon with a new vertex at each corner, turning left as seen from its front.
void add_polygon(Mesh& mesh, MaterialId material, const std::vector<glm::dvec3>& corners) {
  const VertexId first = mesh.vertex_count();
  for (const glm::dvec3& c : corners) mesh.vertices.positions.emplace_back(c);
  const std::vector<std::uint32_t> ends{static_cast<std::uint32_t>(corners.size())};
  for (const auto& t : triangulate_polygon(corners, ends)) {
    for (const std::uint32_t k : t) mesh.indices.push_back(first + k);
    mesh.face_materials.push_back(material);
  }
}

Mesh empty_mesh() {
  Mesh mesh;
  mesh.materials.resize(2);
  mesh.materials[0].base_color = {0.8F, 0.8F, 0.7F, 1.0F};
  mesh.materials[1].base_color = {0.4F, 0.2F, 0.1F, 1.0F};
  return mesh;
}

constexpr double left = 4.0;
constexpr double right = 5.2;
constexpr double top = 2.1;

// A front of 10 m by 6 m in the plane y = 0, seen from y < 0, with a notch for a door.
void add_front(Mesh& mesh) {
  add_polygon(
      mesh, 0,
      {{0, 0, 0}, {left, 0, 0}, {left, 0, top}, {right, 0, top}, {right, 0, 0}, {10, 0, 0}, {10, 0, 6}, {0, 0, 6}});
}

void add_door(Mesh& mesh, double depth) {
  add_polygon(mesh, 1, {{left, depth, 0}, {right, depth, 0}, {right, depth, top}, {left, depth, top}});
}

// Of the faces that look along -y.
double front_m2(const Mesh& mesh, MaterialId material) {
  double sum = 0.0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const auto at = [&](std::uint32_t k) { return glm::dvec3{mesh.vertices.positions[mesh.indices[3 * f + k]]}; };
    const glm::dvec3 n = glm::cross(at(1) - at(0), at(2) - at(0));
    if (mesh.face_material(f) == material && n.y < -0.99 * glm::length(n)) sum += 0.5 * glm::length(n);
  }
  return sum;
}

// The door is there whole, in the wall or as deep as it was, or gone with the wall over it; each at some level.
void check_door(const Mesh& mesh, const FacetShiftResult& built, double depth, double wall_m2) {
  CHECK(compare_with_source(*built.model, mesh) == "");
  bool flush = false;
  bool closed = false;
  for (Level level = 0; level <= built.model->record_count(); ++level) {
    CAPTURE(level);
    const Mesh shown = built.model->extract(level);
    const double door_m2 = front_m2(shown, 1);
    if (door_m2 == 0.0) {
      closed = closed || front_m2(shown, 0) == Approx(wall_m2).epsilon(1e-4);
      continue;
    }
    CHECK(door_m2 == Approx((right - left) * top).epsilon(1e-3));
    double deep = 0.0;
    for (FaceId f = 0; f < shown.triangle_count(); ++f) {
      if (shown.face_material(f) != 1) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        deep = std::max(deep, double{shown.vertices.positions[shown.indices[3 * f + k]].y});
      }
    }
    CHECK((deep < 1e-6 || deep == Approx(depth).margin(0.11)));
    flush = flush || deep < 1e-6;
  }
  CHECK(flush);
  CHECK(closed);
}

TEST_CASE("a loose door in a notch of the wall comes forward, and later the wall closes over it") {
  Mesh mesh = empty_mesh();
  add_front(mesh);
  add_door(mesh, 0.2);
  // A knob, a lock and a plate, so that there is something to hide.
  for (const double z : {0.9, 1.1, 1.3}) {
    add_polygon(mesh, 1, {{4.1, 0.15, z}, {4.2, 0.15, z}, {4.2, 0.15, z + 0.1}, {4.1, 0.15, z + 0.1}});
  }
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(built->report.openings_flattened == 1);
  CHECK(built->report.openings_filled == 1);
  CHECK(compare_with_source(*built->model, mesh) == "");
  bool closed = false;
  for (Level level = 0; level <= built->model->record_count(); ++level) {
    closed = closed || front_m2(built->model->extract(level), 0) == Approx(60.0).epsilon(1e-4);
  }
  CHECK(closed);
}

TEST_CASE("a gate through which one sees closes as a hole of its size does") {
  Mesh mesh = empty_mesh();
  add_front(mesh);
  const auto built = build_by_facet_shift(mesh, {.max_error_m = 3.0});
  REQUIRE(built.ok());
  CHECK(built->report.openings_filled == 1);
  const Level closed = built->model->level_of_triangles(2);
  CHECK(front_m2(built->model->extract(closed), 0) == Approx(60.0).epsilon(1e-4));
  CHECK(built->model->error_m(closed) > 0.9);
  CHECK(built->model->error_m(closed) < 1.0);
}

TEST_CASE("a step in the foot of a wall is no gate") {
  Mesh mesh = empty_mesh();
  add_polygon(mesh, 0, {{0, 0, 0}, {4, 0, 0}, {4, 0, 1}, {7, 0, 1}, {7, 0, 2}, {10, 0, 2}, {10, 0, 6}, {0, 0, 6}});
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(built->report.openings_filled == 0);
}

TEST_CASE("a closed house with a recessed door at its foot: the door comes forward, goes, and the house stays closed") {
  Mesh mesh = empty_mesh();
  constexpr double deep = 0.25;
  add_front(mesh);
  add_door(mesh, deep);
  add_polygon(mesh, 0, {{left, 0, 0}, {left, deep, 0}, {left, deep, top}, {left, 0, top}});
  add_polygon(mesh, 0, {{right, deep, 0}, {right, 0, 0}, {right, 0, top}, {right, deep, top}});
  add_polygon(mesh, 0, {{left, deep, top}, {right, deep, top}, {right, 0, top}, {left, 0, top}});
  add_polygon(mesh, 0, {{10, 0, 0}, {10, 8, 0}, {10, 8, 6}, {10, 0, 6}});
  add_polygon(mesh, 0, {{10, 8, 0}, {0, 8, 0}, {0, 8, 6}, {10, 8, 6}});
  add_polygon(mesh, 0, {{0, 8, 0}, {0, 0, 0}, {0, 0, 6}, {0, 8, 6}});
  add_polygon(mesh, 0, {{0, 0, 6}, {10, 0, 6}, {10, 8, 6}, {0, 8, 6}});
  add_polygon(
      mesh, 0,
      {{0, 0, 0}, {0, 8, 0}, {10, 8, 0}, {10, 0, 0}, {right, 0, 0}, {right, deep, 0}, {left, deep, 0}, {left, 0, 0}});
  REQUIRE(inspect(mesh).boundary_edges == 0);
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  for (Level level = 0; level <= built->model->record_count(); ++level) {
    const Mesh shown = built->model->extract(level);
    CHECK(inspect(shown).boundary_edges == 0);
    CHECK(test::count_crossings(shown) == 0);
  }
  check_door(mesh, *built, deep, 60.0);
}

}  // namespace
}  // namespace lodestone
