// SPDX-License-Identifier: MIT
#include "facets/hidden.h"

#include <catch2/catch.hpp>

namespace lodestone::facets {
namespace {

// Upright, looking to -y, so far behind the front.
void add_sheet(Mesh& mesh, float x, float z, float size_m, float behind_m, MaterialId material) {
  const auto first = mesh.vertex_count();
  mesh.vertices.positions.insert(
      mesh.vertices.positions.end(),
      {{x, behind_m, z}, {x + size_m, behind_m, z}, {x + size_m, behind_m, z + size_m}, {x, behind_m, z + size_m}});
  for (const VertexId i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + i);
  mesh.face_materials.insert(mesh.face_materials.end(), 2, material);
}

// Between two walls of 4 m, 10 cm apart: a sheet of 1 m 1 cm behind the front one.
Mesh sandwich(float front_alpha) {
  Mesh mesh;
  mesh.materials.resize(2);
  mesh.materials[1].base_color.a = front_alpha;
  add_sheet(mesh, 0.0F, 0.0F, 4.0F, 0.0F, 1);
  add_sheet(mesh, 0.0F, 0.0F, 4.0F, 0.1F, 0);
  add_sheet(mesh, 1.5F, 1.5F, 1.0F, 0.01F, 0);
  return mesh;
}

std::vector<Scrap> hidden_of(const Mesh& mesh, double price) {
  std::vector<FaceId> degenerate;
  const FacetMesh facets = make_facet_mesh(mesh, {}, degenerate);
  return HiddenFinder{facets}.find(price);
}

TEST_CASE("what stands between two walls is hidden, and costs its distance from them") {
  const Mesh mesh = sandwich(1.0F);
  const auto found = hidden_of(mesh, 1e-4);
  REQUIRE(found.size() == 2);
  for (const Scrap& face : found) {
    CHECK(face.faces.front() >= 4);
    CHECK(face.error_m == Approx(0.01).epsilon(1e-3));
    CHECK(face.cost == Approx(0.5 * 0.01 * 0.01).epsilon(1e-3));
    for (const FaceId f : face.support) CHECK(f < 4);
  }
  CHECK(hidden_of(mesh, 4e-5).empty());
}

TEST_CASE("glass hides nothing") { CHECK(hidden_of(sandwich(0.5F), 1e-4).empty()); }

TEST_CASE("where one face of a plane is seen, none of it goes") {
  Mesh mesh = sandwich(1.0F);
  // One more face in the plane of the sheet, up to above both walls.
  const auto first = mesh.vertex_count();
  mesh.vertices.positions.push_back({2.0F, 0.01F, 8.0F});
  mesh.indices.insert(mesh.indices.end(), {first - 1, first - 2, first});
  mesh.face_materials.push_back(0);
  CHECK(hidden_of(mesh, 1e-4).empty());
}

}  // namespace
}  // namespace lodestone::facets
