// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include <lodestone/mesh.h>

#include "mesh/weld.h"
#include "shapes.h"

using namespace lodestone;

TEST_CASE("bounds are those of the positions") {
  CHECK(bounds(Mesh{}).empty());
  const Box box = bounds(test::cube());
  CHECK(box.min == glm::dvec3{-1.0});
  CHECK(box.max == glm::dvec3{1.0});
}

TEST_CASE("every family is valid") {
  for (const auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    CHECK(validate(mesh).ok());
  }
}

TEST_CASE("validate refuses each broken invariant and names the place") {
  Mesh mesh = test::seamed_grid(4, 4);
  const auto refused = [&](const char* where) {
    const Status status = validate(mesh);
    REQUIRE_FALSE(status.ok());
    CHECK(status.error().code == ErrorCode::BadData);
    CHECK(status.error().where == where);
    mesh = test::seamed_grid(4, 4);
  };
  mesh.indices[5] = 1000;
  refused("corner 5");
  mesh.indices.pop_back();
  refused("");
  mesh.vertices.positions[3].y = std::numeric_limits<float>::quiet_NaN();
  refused("vertex 3");
  mesh.vertices.uvs[2].x = std::numeric_limits<float>::infinity();
  refused("vertex 2");
  mesh.vertices.normals.resize(2);
  refused("");
  mesh.face_materials[7] = 2;
  refused("triangle 7");
  mesh.face_materials.pop_back();
  refused("");
  mesh.face_features.assign(mesh.triangle_count(), 0);
  refused("triangle 0");
  mesh.materials[1].texture = 0;
  refused("material 1");
  mesh.features = {{.id = "a", .parent = 1}, {.id = "b", .parent = 0}};
  refused("feature 1");
  mesh.features = {{.id = "a", .parent = 0}};
  refused("feature 0");
  mesh.features = {{.id = "a"}, {.id = "b", .parent = 9}};
  refused("feature 1");
}

TEST_CASE("features may share parents and be unknown") {
  Mesh mesh = test::cube();
  mesh.features = {
      {.id = "wall", .parent = 2}, {.id = "window", .parent = 0}, {.id = "house"}, {.id = "x", .parent = 0}};
  mesh.face_features.assign(mesh.triangle_count(), none);
  mesh.face_features[3] = 1;
  CHECK(validate(mesh).ok());
}

TEST_CASE("welding joins equal positions only, -0 with 0") {
  const std::vector<glm::vec3> p{
      {0, 0, 0}, {1, 0, 0}, {-0.0F, 0, -0.0F}, {1, 0, std::numeric_limits<float>::min()}, {1, 0, 0}};
  const Weld weld = weld_by_position(p);
  CHECK(weld.point_of == std::vector<std::uint32_t>{0, 1, 0, 2, 1});
  CHECK(weld.first_vertex == std::vector<VertexId>{0, 1, 3});
}

TEST_CASE("inspect counts by position") {
  const MeshReport cube = inspect(test::cube());
  CHECK(cube.corner_points == 8);
  CHECK(cube.components == 1);
  CHECK(cube.boundary_edges == 0);
  CHECK(cube.non_manifold_edges == 0);
  const MeshReport soup = inspect(test::unwelded(test::cube()));
  CHECK(soup.corner_points == 8);
  CHECK(soup.components == 1);
  CHECK(soup.boundary_edges == 0);

  CHECK(inspect(test::grid(5, 3)).boundary_edges == 16);
  CHECK(inspect(test::seamed_grid(6, 3)).boundary_edges == 18);
  CHECK(inspect(test::fins(5)).non_manifold_edges == 8);
  CHECK(inspect(test::scattered_cubes(40, 7)).components == 40);
  for (const auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    const MeshReport report = inspect(mesh);
    CHECK(report.duplicate_triangles == (name == "duplicate faces"         ? 30
                                         : report.degenerate_triangles > 0 ? report.duplicate_triangles
                                                                           : 0));
    CHECK((report.degenerate_triangles > 0) == (name == "degenerate"));
  }
}

TEST_CASE("triangles of zero area are degenerate even with three different corners") {
  Mesh mesh = test::cube();
  mesh.vertices.positions = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}};
  mesh.indices = {0, 1, 2};
  CHECK(inspect(mesh).degenerate_triangles == 1);
}

TEST_CASE("remove_unused drops what nothing refers to and keeps the rest in order") {
  Mesh mesh = test::seamed_grid(4, 4);
  const Mesh before = mesh;
  mesh.vertices.positions.insert(mesh.vertices.positions.begin(), glm::vec3{9.0F});
  mesh.vertices.uvs.insert(mesh.vertices.uvs.begin(), glm::vec2{9.0F});
  for (VertexId& v : mesh.indices) ++v;
  mesh.materials.insert(mesh.materials.begin(), Material{.name = "unused", .texture = 0});
  mesh.materials[2].texture = 1;
  for (MaterialId& m : mesh.face_materials) ++m;
  mesh.textures = {{.name = "drop"}, {.name = "keep"}};
  remove_unused(mesh);
  CHECK(mesh.vertices == before.vertices);
  CHECK(mesh.indices == before.indices);
  CHECK(mesh.face_materials == before.face_materials);
  REQUIRE(mesh.materials.size() == 2);
  CHECK(mesh.materials[1].texture == 0);
  REQUIRE(mesh.textures.size() == 1);
  CHECK(mesh.textures[0].name == "keep");
}

TEST_CASE("merge_identical_vertices undoes unwelding but keeps creases") {
  Mesh soup = test::unwelded(test::cube());
  CHECK(merge_identical_vertices(soup) == 12);  // the two triangles of a side share two vertices
  CHECK(soup.vertex_count() == 24);
  soup.vertices.normals.clear();
  CHECK(merge_identical_vertices(soup) == 16);
  CHECK(soup.vertex_count() == 8);
  CHECK(inspect(soup).boundary_edges == 0);
  CHECK(merge_identical_vertices(soup) == 0);
}

TEST_CASE("normals of a sphere point outwards and of a cube along its axes") {
  Mesh ball = test::sphere(32, 64);
  const std::uint32_t vertices = ball.vertex_count();
  compute_normals(ball);
  CHECK(ball.vertex_count() == vertices);
  for (VertexId v = 0; v < vertices; ++v) {
    CHECK(glm::dot(ball.vertices.normals[v], glm::normalize(ball.vertices.positions[v])) > 0.995F);
  }
  Mesh box = test::cube();
  compute_normals(box);
  CHECK(box.vertex_count() == 24);
  for (FaceId f = 0; f < box.triangle_count(); ++f) {
    const auto n = glm::vec3{glm::normalize(area_vector(box, f))};
    for (int c = 0; c < 3; ++c) CHECK(glm::distance(box.vertices.normals[box.indices[3 * f + c]], n) < 1e-6F);
  }
  Mesh round = test::cube();
  compute_normals(round, 3.0);
  CHECK(round.vertex_count() == 8);
}

TEST_CASE("normals are of unit length and welded ones equal on every family") {
  for (auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    const std::uint32_t triangles = mesh.triangle_count();
    compute_normals(mesh);
    CHECK(validate(mesh).ok());
    CHECK(mesh.triangle_count() == triangles);
    REQUIRE(mesh.vertices.normals.size() == mesh.vertex_count());
    for (const glm::vec3& n : mesh.vertices.normals) CHECK(std::abs(glm::length(n) - 1.0F) < 1e-5F);
  }
}
