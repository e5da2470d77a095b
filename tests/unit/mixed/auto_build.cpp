// SPDX-License-Identifier: MIT
#include <lodestone/auto_build.h>

#include <catch2/catch.hpp>

#include "shapes.h"

namespace lodestone {
namespace {

// A wall of blocks, and a statue that is not made of planes.
Mesh blocks_and_sphere() {
  Mesh mesh = test::sphere(30, 40);
  mesh.vertices.uvs.clear();
  const VertexId first = mesh.vertex_count();
  const Mesh blocks = test::unwelded(test::scattered_cubes(60, 7));
  for (const glm::vec3& p : blocks.vertices.positions) mesh.vertices.positions.push_back(p + glm::vec3{40, 0, 0});
  mesh.vertices.normals.insert(mesh.vertices.normals.end(), blocks.vertices.normals.begin(),
                               blocks.vertices.normals.end());
  for (const VertexId v : blocks.indices) mesh.indices.push_back(first + v);
  mesh.face_materials.assign(mesh.triangle_count(), 0);
  return mesh;
}

void check_model(const ProgressiveModel& model, const Mesh& source) {
  const ModelReport report = validate(model);
  CHECK(report.fault.empty());
  CHECK((report.exact && report.monotone && report.in_use_consistent));
  CHECK(compare_with_source(model, source) == "");
}

TEST_CASE("each connected part is built the way that suits it, in one stack, and the reason is said") {
  const Mesh mesh = blocks_and_sphere();
  REQUIRE(validate(mesh).ok());
  const auto built = build_automatically(mesh);
  REQUIRE(built.ok());
  check_model(*built->model, mesh);
  CHECK(built->model->data().method == "mixed");
  CHECK(built->facet_shift.has_value());
  CHECK(built->edge_collapse.has_value());
  CHECK(built->reason.find("edge-collapse for 2320 triangles in 1 connected part") != std::string::npos);
  // Both coarsen: at a third of the triangles there is something left of the sphere and of the blocks.
  const Mesh level = built->model->extract(built->model->level_of_triangles(mesh.triangle_count() / 3));
  std::uint32_t of_sphere = 0;
  for (FaceId f = 0; f < level.triangle_count(); ++f) {
    of_sphere += level.vertices.positions[level.indices[3 * std::size_t{f}]].x < 20.0F ? 1 : 0;
  }
  CHECK(of_sphere > 10);
  CHECK(of_sphere < level.triangle_count());
}

TEST_CASE("a mixed model stops at the target and at the error") {
  const Mesh mesh = blocks_and_sphere();
  const auto target = build_automatically(mesh, {.facet_shift = {.target_triangles = 1500}});
  REQUIRE(target.ok());
  check_model(*target->model, mesh);
  CHECK(target->model->info(0).triangles <= 1500);
  CHECK(target->model->info(0).triangles > 1400);
  const auto error = build_automatically(mesh, {.facet_shift = {.max_error_m = 0.01}});
  REQUIRE(error.ok());
  CHECK(error->model->error_m(0) <= 0.0101);
}

TEST_CASE("what is of one kind is built one way") {
  const auto planar = build_automatically(test::scattered_cubes(20, 3));
  REQUIRE(planar.ok());
  CHECK(planar->model->data().method == "facet-shift");
  const auto round = build_automatically(test::sphere(60, 80));
  REQUIRE(round.ok());
  CHECK(round->model->data().method == "edge-collapse");
  CHECK(round->reason.find("edge-collapse, because") == 0);
  CHECK(build_automatically(Mesh{}).ok());
}

}  // namespace
}  // namespace lodestone
