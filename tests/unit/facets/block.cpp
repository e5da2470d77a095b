// SPDX-License-Identifier: MIT
#include <lodestone/facet_shift.h>
#include <lodestone/generate.h>
#include <lodestone/metrics.h>
#include <lodestone/polygon.h>

#include <catch2/catch.hpp>

#include "blocks.h"
#include "shapes.h"
#include "small_house.h"

namespace lodestone {
namespace {

// Adds a closed prism over a polygon that turns left.
void add_prism(Mesh& mesh, const std::vector<glm::vec2>& corners, float low, float high) {
  const VertexId first = mesh.vertex_count();
  const auto n = static_cast<std::uint32_t>(corners.size());
  std::vector<glm::dvec3> flat;
  for (const float z : {low, high}) {
    for (const glm::vec2& c : corners) mesh.vertices.positions.push_back({c.x, c.y, z});
  }
  for (const glm::vec2& c : corners) flat.emplace_back(c.x, c.y, 0.0);
  const auto add = [&](VertexId a, VertexId b, VertexId c) {
    mesh.indices.insert(mesh.indices.end(), {first + a, first + b, first + c});
  };
  for (const auto& t : triangulate_polygon(flat, std::vector<std::uint32_t>{n})) {
    add(t[0], t[2], t[1]);
    add(n + t[0], n + t[1], n + t[2]);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    add(i, j, n + j);
    add(i, n + j, n + i);
  }
}

const std::vector<glm::vec2> l_shape{{0, 0}, {20, 0}, {20, 8}, {8, 8}, {8, 16}, {0, 16}};

TEST_CASE("the block stands on the outline of the walls, as high as half of the roof") {
  Mesh mesh;
  mesh.materials.emplace_back();
  add_prism(mesh, l_shape, 0.0F, 7.0F);
  add_prism(mesh, {{2, 2}, {3, 2}, {3, 3}, {2, 3}}, 7.0F, 9.0F);            // a chimney
  add_prism(mesh, {{20.5F, 1}, {21, 1}, {21, 7}, {20.5F, 7}}, 3.0F, 4.0F);  // a balcony
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  CHECK(compare_with_source(*built->model, mesh) == "");
  CHECK(built->report.reached_block);
  const Mesh block = built->model->extract(0);
  CHECK(block.triangle_count() == 20);
  test::check_block(block);
  const Box box = bounds(block);
  CHECK(glm::length(box.min - glm::dvec3{0, 0, 0}) < 1e-5);
  CHECK(glm::length(box.max - glm::dvec3{20, 16, 7}) < 1e-5);
  // The chimney rises that far over the roof.
  CHECK(built->model->error_m(0) >= 2.0);
  for (const char* name : {"lod1", "block"}) CHECK(built->model->level_of_name(name).value() == 0);
}

TEST_CASE("the roof of a block is of the roof's material, not of that of the floors and the ground under it") {
  Mesh mesh;
  mesh.materials.resize(2);
  add_prism(mesh, l_shape, 0.0F, 7.0F);
  mesh.face_materials.assign(mesh.triangle_count(), 0);
  add_prism(mesh, {{0.2F, 0.2F}, {19.8F, 0.2F}, {19.8F, 7.8F}, {7.8F, 7.8F}, {7.8F, 15.8F}, {0.2F, 15.8F}}, 2.9F, 3.1F);
  mesh.face_materials.resize(mesh.triangle_count(), 0);
  // The roof is a slab on top.
  add_prism(mesh, l_shape, 7.0F, 7.3F);
  mesh.face_materials.resize(mesh.triangle_count(), 1);
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  REQUIRE(built->report.reached_block);
  const Mesh block = built->model->extract(0);
  for (FaceId f = 0; f < block.triangle_count(); ++f) {
    const auto at = [&](std::uint32_t k) { return glm::dvec3{block.vertices.positions[block.indices[3 * f + k]]}; };
    if (glm::cross(at(1) - at(0), at(2) - at(0)).z > 0.0) CHECK(block.face_material(f) == 1);
  }
}

TEST_CASE("what overhangs does not widen the block") {
  const Mesh house = test::small_house(20'000, Roof::Flat);
  const auto built = build_by_facet_shift(house);
  REQUIRE(built.ok());
  REQUIRE(built->report.reached_block);
  const Box whole = bounds(house);
  const Box box = bounds(built->model->extract(0));
  for (int k = 0; k < 3; ++k) {
    CHECK(box.min[k] >= whole.min[k]);
    CHECK(box.max[k] <= whole.max[k]);
  }
}

TEST_CASE("houses of every roof end as a block, told by name, within the claimed error") {
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    CAPTURE(static_cast<int>(roof));
    const Mesh house = test::small_house(4000, roof);
    const auto built = build_by_facet_shift(house);
    REQUIRE(built.ok());
    CHECK(built->report.reached_block);
    CHECK(built->report.block_sentence.empty());
    const ProgressiveModel& model = *built->model;
    const Mesh block = model.extract(model.level_of_name("block").value());
    test::check_block(block);
    const auto distance = compare(house, block, {.samples = 5000});
    REQUIRE(distance.ok());
    CHECK(distance->hausdorff_m <= model.error_m(0) + 1e-3);
    CHECK(model.level_of_name("lod3").value() >= model.level_of_name("lod2").value());
    CHECK(model.error_m(model.level_of_name("lod2").value()) <= 2.0);
  }
}

// Three houses of different roofs in a row, the second and third wall to wall, with a pavement before them.
Mesh row_of_houses(std::array<Box, 3>& boxes) {
  Mesh row;
  double end_m = 0.0;
  constexpr std::array roofs{Roof::Flat, Roof::Gable, Roof::Hip};
  for (std::size_t i = 0; i < roofs.size(); ++i) {
    const Mesh house = test::small_house(2000, roofs[i]);
    Box box = bounds(house);
    const glm::dvec3 move{end_m - box.min.x, -box.min.y, -box.min.z};
    end_m += box.size().x + (i == 0 ? 3.0 : 0.0);
    boxes[i] = {box.min + move, box.max + move};
    const VertexId first = row.vertex_count();
    for (const glm::vec3& p : house.vertices.positions) row.vertices.positions.emplace_back(glm::dvec3{p} + move);
    for (const VertexId v : house.indices) row.indices.push_back(first + v);
    const auto first_material = static_cast<MaterialId>(row.materials.size());
    for (FaceId f = 0; f < house.triangle_count(); ++f) {
      row.face_materials.push_back(first_material + house.face_material(f));
    }
    for (Material material : house.materials) {
      material.texture = none;
      row.materials.push_back(material);
    }
  }
  const VertexId first = row.vertex_count();
  const auto far = static_cast<float>(end_m);
  for (const glm::vec3& p : {glm::vec3{0, -6, 0}, {far, -6, 0}, {far, 4, 0}, {0, 4, 0}}) {
    row.vertices.positions.push_back(p);
  }
  for (const VertexId k : {0U, 1U, 2U, 0U, 2U, 3U}) row.indices.push_back(first + k);
  row.face_materials.insert(row.face_materials.end(), 2, 0);
  return row;
}

TEST_CASE("a street ends as a row of closed prisms, one for each house, on its ground and as high as its roof") {
  std::array<Box, 3> boxes;
  const Mesh row = row_of_houses(boxes);
  const auto built = build_by_facet_shift(row);
  REQUIRE(built.ok());
  CHECK(compare_with_source(*built->model, row) == "");
  REQUIRE(built->report.reached_block);
  const Mesh street = built->model->extract(0);
  const MeshReport found = inspect(street);
  CHECK(found.boundary_edges == 0);
  CHECK(found.components == 3);
  for (const Box& box : boxes) {
    // The faces within the house's own box are a prism.
    Mesh one = street;
    one.indices.clear();
    one.face_materials.clear();
    one.face_features.clear();
    for (FaceId f = 0; f < street.triangle_count(); ++f) {
      glm::dvec3 middle{0.0};
      for (std::uint32_t k = 0; k < 3; ++k) {
        middle += glm::dvec3{street.vertices.positions[street.indices[3 * f + k]]} / 3.0;
      }
      if (middle.x < box.min.x || middle.x > box.max.x) continue;
      const auto at = street.indices.begin() + 3 * std::ptrdiff_t{f};
      one.indices.insert(one.indices.end(), at, at + 3);
      one.face_materials.push_back(street.face_material(f));
    }
    test::check_block(one);
    Box prism;
    for (const VertexId v : one.indices) prism.add(glm::dvec3{one.vertices.positions[v]});
    // Without the eaves, which reach out by less than a metre and a half; half of the roof is that high.
    for (int k = 0; k < 2; ++k) {
      CHECK(std::abs(prism.min[k] - box.min[k]) < 1.5);
      CHECK(std::abs(prism.max[k] - box.max[k]) < 1.5);
    }
    CHECK(prism.min.z == Approx(box.min.z).margin(1e-3));
    CHECK(prism.max.z > 0.5 * box.max.z);
    CHECK(prism.max.z < box.max.z);
  }
}

TEST_CASE("what is no building says so and has no block") {
  const auto built = build_by_facet_shift(test::sphere(40, 50));
  REQUIRE(built.ok());
  CHECK_FALSE(built->report.reached_block);
  CHECK(built->report.block_sentence.find("walls") != std::string::npos);
  CHECK_FALSE(built->model->level_of_name("block").ok());
  const auto stopped = build_by_facet_shift(test::cube(), {.target_triangles = 12});
  REQUIRE(stopped.ok());
  CHECK(stopped->report.reached_block);  // a cube is one from the start
}

}  // namespace
}  // namespace lodestone
