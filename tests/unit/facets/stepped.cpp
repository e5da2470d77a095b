// SPDX-License-Identifier: MIT
#include <lodestone/facet_shift.h>
#include <lodestone/metrics.h>

#include <catch2/catch.hpp>

#include "blocks.h"

namespace lodestone {
namespace {

void add_box(Mesh& mesh, const glm::vec3& low, const glm::vec3& high) {
  const VertexId first = mesh.vertex_count();
  for (std::uint32_t i = 0; i < 8; ++i) {
    mesh.vertices.positions.push_back(
        {(i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z});
  }
  for (const VertexId v :
       {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}) {
    mesh.indices.push_back(first + static_cast<VertexId>(v));
  }
}

// Chimneys, which go before.
void add_chimneys(Mesh& mesh, float z) {
  for (int i = 0; i < 5; ++i) {
    const glm::vec3 low{1.0F + 2.0F * static_cast<float>(i), 2.0F, z};
    add_box(mesh, low, low + glm::vec3{0.4F, 0.4F, 0.6F});
  }
}

// The level before the block.
Mesh stepped_level(const Mesh& mesh) {
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(compare_with_source(*built->model, mesh).empty());
  REQUIRE(built->report.reached_block);
  test::check_block(built->model->extract(0));
  CHECK(built->model->error_m(1) <= built->model->error_m(0));
  return built->model->extract(1);
}

// How far the level is from the source. Walls between two boxes, which the source has and nobody sees, do not count.
double farthest_m(const Mesh& source, const Mesh& level) {
  const auto found = compare(source, level, {.samples = 20'000});
  REQUIRE(found.ok());
  return found->b_to_a.max_m;
}

TEST_CASE("a hall with a higher end keeps its two heights until the block comes") {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_box(mesh, {0, 0, 0}, {24, 12, 5});
  add_box(mesh, {24, 0, 0}, {34, 12, 14});
  add_chimneys(mesh, 5.0F);
  const Mesh level = stepped_level(mesh);
  test::check_block(level);
  CHECK(level.triangle_count() == 20);
  CHECK(farthest_m(mesh, level) < 0.01);
  CHECK(bounds(level).max.z == Approx(14.0));
}

TEST_CASE("a tower at the corner of a hall is cut out along two walls") {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_box(mesh, {0, 0, 0}, {30, 20, 6});
  add_box(mesh, {22, 12, 6}, {30, 20, 18});
  add_chimneys(mesh, 6.0F);
  const Mesh level = stepped_level(mesh);
  test::check_block(level);
  CHECK(level.triangle_count() == 24);
  CHECK(farthest_m(mesh, level) < 0.01);
}

TEST_CASE("a higher part in the middle steps up and down again") {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_box(mesh, {0, 0, 0}, {36, 10, 6});
  add_box(mesh, {14, 0, 6}, {24, 10, 16});
  add_chimneys(mesh, 6.0F);
  const Mesh level = stepped_level(mesh);
  test::check_block(level);
  CHECK(level.triangle_count() == 28);
  CHECK(farthest_m(mesh, level) < 0.01);
}

TEST_CASE("one height stays one") {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_box(mesh, {0, 0, 0}, {24, 12, 5});
  add_chimneys(mesh, 5.0F);
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  REQUIRE(built->report.reached_block);
  CHECK(built->model->extract(0).triangle_count() == 12);
  CHECK(farthest_m(mesh, built->model->extract(0)) < 0.01);
}

}  // namespace
}  // namespace lodestone
