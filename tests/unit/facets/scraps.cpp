// SPDX-License-Identifier: MIT
#include "facets/scraps.h"

#include <catch2/catch.hpp>

#include "walls.h"

namespace lodestone::facets {
namespace {

// Corners of walls.h; material 1, of points that may be the wall's.
void add_quad(Mesh& mesh, VertexId a, VertexId b, VertexId c, VertexId d) {
  mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
  mesh.face_materials.insert(mesh.face_materials.end(), 2, 1);
}

struct Scene {
  explicit Scene(const Mesh& mesh) : source(mesh), facets(make_facet_mesh(source, {}, degenerate)), around(facets) {}
  Mesh source;
  std::vector<FaceId> degenerate;
  FacetMesh facets;
  facets::Surroundings around;
};

Mesh wall_of_one_material() {
  Mesh mesh = test::wall_with_panel(0.1F);
  mesh.materials.resize(2);
  mesh.face_materials.assign(mesh.triangle_count(), 0);
  return mesh;
}

TEST_CASE("a fin that hangs on an edge of its wall can go; the wall and the panel in it cannot") {
  Mesh mesh = wall_of_one_material();
  const auto first = mesh.vertex_count();
  // 3 cm out of the wall along the panel's lower edge.
  mesh.vertices.positions.insert(mesh.vertices.positions.end(), {{5, -0.03F, 2}, {4, -0.03F, 2}});
  add_quad(mesh, 4, 5, first, first + 1);
  Scene scene{mesh};
  ScrapFinder scraps{scene.facets, scene.around};
  CHECK(scraps.find(2e-6).empty());
  const auto found = scraps.find(1e-2);
  REQUIRE(found.size() == 1);
  CHECK(found[0].faces == std::vector<FaceId>{mesh.triangle_count() - 2, mesh.triangle_count() - 1});
  CHECK(found[0].error_m == Approx(0.03).epsilon(1e-3));
  for (const FaceId f : found[0].support) CHECK(f < mesh.triangle_count() - 2);
}

TEST_CASE("what closes a hole of the wall is no scrap at any price, nor is a part of its own") {
  Mesh mesh = wall_of_one_material();
  mesh.face_materials[mesh.triangle_count() - 2] = 1;
  mesh.face_materials[mesh.triangle_count() - 1] = 1;
  const auto first = mesh.vertex_count();
  mesh.vertices.positions.insert(mesh.vertices.positions.end(),
                                 {{1, -0.01F, 1}, {1.1F, -0.01F, 1}, {1.1F, -0.01F, 2}, {1, -0.01F, 2}});
  add_quad(mesh, first, first + 1, first + 2, first + 3);
  Scene scene{mesh};
  CHECK(ScrapFinder{scene.facets, scene.around}.find(1e6).empty());
}

}  // namespace
}  // namespace lodestone::facets
