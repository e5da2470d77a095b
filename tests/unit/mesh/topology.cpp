// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include <lodestone/formats.h>
#include <lodestone/openmesh.h>
#include <lodestone/topology.h>

#include "data.h"
#include "mesh/edges.h"
#include "mesh/import_manifold.h"
#include "shapes.h"

using namespace lodestone;

namespace {

Mesh torus(std::uint32_t n, std::uint32_t m) {
  Mesh mesh = test::tetrahedron();
  mesh.vertices.positions.clear();
  mesh.indices.clear();
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < m; ++j) {
      const double a = 2.0 * std::numbers::pi * i / n;
      const double b = 2.0 * std::numbers::pi * j / m;
      mesh.vertices.positions.emplace_back((2.0 + std::cos(b)) * std::cos(a), (2.0 + std::cos(b)) * std::sin(a),
                                           std::sin(b));
      const auto at = [&](std::uint32_t x, std::uint32_t y) { return x % n * m + y % m; };
      mesh.indices.insert(mesh.indices.end(),
                          {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

Mesh without_faces(Mesh mesh, FaceId begin, FaceId end) {
  mesh.indices.erase(mesh.indices.begin() + 3 * begin, mesh.indices.begin() + 3 * end);
  return mesh;
}

// The attributes of all corners, in the order of the faces, without faces that have two corners at one place.
std::vector<float> corners(const Mesh& mesh) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  std::vector<float> values;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    if (collapsed(weld, &mesh.indices[i - i % 3])) continue;
    const VertexId v = mesh.indices[i];
    const auto add = [&](const auto& array) {
      if (array.empty()) return;
      for (int c = 0; c < array[v].length(); ++c) values.push_back(static_cast<float>(array[v][c]));
    };
    add(mesh.vertices.positions);
    add(mesh.vertices.normals);
    add(mesh.vertices.uvs);
    add(mesh.vertices.colors);
    values.push_back(static_cast<float>(mesh.face_material(static_cast<FaceId>(i / 3))));
  }
  return values;
}

}  // namespace

TEST_CASE("closed surfaces have no border, a torus has a handle") {
  for (const Mesh& mesh : {test::cube(), test::sphere(12, 20), test::unwelded(test::cube())}) {
    const Topology t = analyse_topology(mesh);
    CHECK(t.pieces == 1);
    CHECK(t.closed_pieces == 1);
    CHECK(t.handles == 0);
    CHECK(t.boundary_loops.empty());
    CHECK(t.non_manifold_points == 0);
  }
  const Topology ring = analyse_topology(torus(12, 8));
  CHECK(ring.handles == 1);
  CHECK(ring.corner_points == 96);
  CHECK(ring.edges == 288);
  CHECK(ring.faces == 192);
  CHECK(analyse_topology(without_faces(torus(12, 8), 5, 6)).handles == 1);
}

TEST_CASE("boundary loops run once around every border and hole") {
  const Topology sheet = analyse_topology(test::seamed_grid(6, 4));
  REQUIRE(sheet.boundary_loops.size() == 1);
  CHECK(sheet.boundary_loops[0].size() == 20);
  CHECK(sheet.closed_pieces == 0);

  const Mesh pierced = without_faces(test::grid(9, 9), 80, 82);
  const Topology two = analyse_topology(pierced);
  REQUIRE(two.boundary_loops.size() == 2);
  CHECK(two.handles == 0);
  for (const auto& loop : two.boundary_loops) {
    CHECK((loop.size() == 36 || loop.size() == 4));
    for (std::size_t i = 0; i < loop.size(); ++i) {  // sides follow each other, one way round or the other
      const CornerId a = loop[i];
      const CornerId b = loop[(i + 1) % loop.size()];
      CHECK(pierced.indices[a] == pierced.indices[next_corner(b)]);
    }
  }
}

TEST_CASE("what is not manifold is counted and cut apart") {
  const Topology fins = analyse_topology(test::fins(5));
  CHECK(fins.non_manifold_edges == 8);
  CHECK(fins.non_manifold_points == 9);
  CHECK(fins.pieces == 5);
  CHECK(fins.boundary_loops.size() == 5);
  for (const auto& loop : fins.boundary_loops) CHECK(loop.size() == 10);

  Mesh bow = test::cube();  // two cubes that share a corner
  const VertexId first = bow.vertex_count();
  for (VertexId v = 0; v < first; ++v) bow.vertices.positions.push_back(bow.vertices.positions[v] + 2.0F);
  for (std::size_t i = 0; i < 36; ++i) bow.indices.push_back(first + bow.indices[i]);
  const Topology touching = analyse_topology(bow);
  CHECK(touching.corner_points == 15);
  CHECK(touching.non_manifold_points == 1);
  CHECK(touching.non_manifold_edges == 0);
  CHECK(touching.closed_pieces == 2);

  Mesh turned = test::grid(2, 1);
  std::swap(turned.indices[0], turned.indices[1]);
  CHECK(analyse_topology(turned).inconsistent_edges == 2);
  CHECK(analyse_topology(turned).pieces == 3);
}

TEST_CASE("topology agrees with inspect on every family") {
  for (const auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    const MeshReport report = inspect(mesh);
    const Topology t = analyse_topology(mesh);
    CHECK(t.non_manifold_edges == report.non_manifold_edges);
    std::size_t sides = 0;
    for (const auto& loop : t.boundary_loops) sides += loop.size();
    CHECK(sides == report.boundary_edges);
    CHECK(t.pieces >= report.components);
  }
}

TEST_CASE("a mesh comes back from OpenMesh with every attribute of every corner") {
  for (auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
      mesh.vertices.colors.emplace_back(v % 256, v / 256 % 256, 7 * v % 256, 255 - v % 256);
    }
    mesh.features = {{.id = "a"}, {.id = "b"}};
    mesh.face_features.assign(mesh.triangle_count(), none);
    if (!mesh.face_features.empty()) mesh.face_features.back() = 1;
    const OpenMeshCopy copy = to_openmesh(mesh);
    CHECK(copy.mesh.n_faces() == copy.face_of.size());
    CHECK(copy.mesh.n_vertices() == copy.point_of_vertex.size());
    const Mesh back = from_openmesh(copy.mesh, mesh);
    CHECK(validate(back).ok());
    CHECK(corners(back) == corners(mesh));
    if (!back.face_features.empty()) CHECK(back.face_features.back() == mesh.face_features[copy.face_of.back()]);
  }
}

TEST_CASE("a mesh made with OpenMesh comes in with its vertex attributes, deleted faces left out") {
  OpenMesh::TriMesh mesh;
  mesh.request_vertex_normals();
  mesh.request_face_status();
  mesh.request_edge_status();
  mesh.request_vertex_status();
  std::vector<OpenMesh::VertexHandle> v;
  for (const double x : {0.0, 1.0, 2.0, 3.0}) v.push_back(mesh.add_vertex({x, x * x, 0.5}));
  for (const auto h : v) mesh.set_normal(h, {0.0, 0.0, 1.0});
  mesh.add_face(v[0], v[1], v[2]);
  mesh.delete_face(mesh.add_face(v[0], v[2], v[3]), false);
  const Mesh back = from_openmesh(mesh);
  REQUIRE(validate(back).ok());
  CHECK(back.triangle_count() == 1);
  CHECK(back.vertex_count() == 3);
  CHECK(back.vertices.normals[0] == glm::vec3{0, 0, 1});
  CHECK(back.vertices.positions[back.indices[1]] == glm::vec3{1.0F, 1.0F, 0.5F});
}

TEST_CASE("real buildings and horizons that OpenMesh would refuse go there whole") {
  LODESTONE_REQUIRE_DATA(data);
  for (const char* file : {"buildings/4018215/4018215.obj", "buildings/4018267/4018267.obj",
                           "outcrops/sol1151/sol1151-wheel-measure.obj"}) {
    INFO(file);
    const auto read = read_mesh(data / file);
    REQUIRE(read.ok());
    const Mesh& mesh = read->mesh;
    const Weld weld = weld_by_position(mesh.vertices.positions);
    const EdgeTable edges = find_edges(mesh, weld);
    const OpenMeshCopy copy = to_openmesh(mesh);
    CHECK(copy.mesh.n_vertices() == cut_to_manifold(mesh, weld, edges).vertex_count());  // no face was refused
    CHECK(corners(from_openmesh(copy.mesh, mesh)) == corners(mesh));
    const Topology t = analyse_topology(mesh);
    CHECK(t.non_manifold_edges == inspect(mesh).non_manifold_edges);
    CHECK(t.pieces >= inspect(mesh).components);
  }
}
