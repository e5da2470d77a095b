// SPDX-License-Identifier: MIT
#include "facets/kinds.h"

#include <cmath>
#include <optional>

#include <catch2/catch.hpp>

#include "facets/parts.h"
#include "shapes.h"

namespace lodestone::facets {
namespace {

struct Placed {
  glm::dvec3 size_m, at;
  double turn_rad = 0.0;
  MaterialId material = 0;
};

// Boxes that do not touch.
Mesh boxes(const std::vector<Placed>& all) {
  const Mesh cube = test::cube();
  Mesh mesh;
  mesh.materials.resize(2);
  for (const Placed& box : all) {
    const VertexId first = mesh.vertex_count();
    for (const glm::vec3& p : cube.vertices.positions) {
      const glm::dvec3 q = 0.5 * box.size_m * glm::dvec3{p};
      const double c = std::cos(box.turn_rad);
      const double s = std::sin(box.turn_rad);
      mesh.vertices.positions.emplace_back(box.at + glm::dvec3{c * q.x - s * q.y, s * q.x + c * q.y, q.z});
    }
    for (const VertexId v : cube.indices) mesh.indices.push_back(first + v);
    mesh.face_materials.insert(mesh.face_materials.end(), cube.triangle_count(), box.material);
  }
  return mesh;
}

struct Scene {
  explicit Scene(const std::vector<Placed>& all) : source(boxes(all)) {
    mesh = make_facet_mesh(source, {}, degenerate);
    kinds.emplace(mesh);
    update();
  }
  void update() {
    Surroundings around{mesh};
    kinds->update(PartFinder{mesh, Pieces{mesh}, around}.parts());
  }
  Mesh source;
  std::vector<FaceId> degenerate;
  FacetMesh mesh;
  std::optional<Kinds> kinds;
};

const glm::dvec3 plank{2.0, 0.5, 0.1};

TEST_CASE("boxes of one shape follow the first however they are turned; those of another size or material do not") {
  const Scene scene{{{plank, {0, 0, 0}},
                     {plank, {5, 0, 0}, 0.7},
                     {plank + glm::dvec3{0.001, 0, 0}, {10, 0, 0}},
                     {plank, {15, 0, 3}, 2.0},
                     {plank, {20, 0, 0}, 0.0, 1}}};
  std::vector<bool> follows;
  for (FaceId f = 0; f < scene.mesh.faces.size(); f += 12) follows.push_back(scene.kinds->follows(scene.mesh.faces[f]));
  CHECK(follows == std::vector<bool>{false, true, false, true, false});
}

TEST_CASE("a part that has strayed from the source does not follow one that has not") {
  Scene scene{{{plank, {0, 0, 0}}, {plank, {5, 0, 0}}}};
  REQUIRE(scene.kinds->follows(scene.mesh.faces[12]));
  scene.mesh.deviation_m[scene.mesh.faces[12].point[0]] = 0.01F;
  scene.update();
  CHECK_FALSE(scene.kinds->follows(scene.mesh.faces[12]));
}

TEST_CASE("followers move as far as the leader in the direction that they have turned to") {
  const double turn_rad = 0.7;
  const Scene scene{{{plank, {0, 0, 0}}, {plank, {5, 1, 2}, turn_rad}}};
  const std::uint32_t point = scene.mesh.faces[0].point[0];
  const glm::vec3 way{0.3F, 0.0F, 0.1F};
  const Move move{point, none, scene.mesh.place[point] + way};
  Kinds::Errand errand;
  scene.kinds->prepare({&move, 1}, errand);
  REQUIRE(errand.size() == 1);
  const Move followed = errand.moves(0)[0];
  CHECK(followed.point == scene.mesh.faces[12].point[0]);
  CHECK(followed.onto == none);
  const glm::dvec3 there = glm::dvec3{followed.to} - scene.mesh.at(followed.point);
  const glm::dvec3 wanted{std::cos(turn_rad) * 0.3, std::sin(turn_rad) * 0.3, 0.1};
  CHECK(glm::length(there - wanted) < 1e-5);
  // Onto a point at rest means exactly there.
  const std::uint32_t onto = scene.mesh.faces[0].point[1];
  const Move slide{point, onto, scene.mesh.place[onto]};
  scene.kinds->prepare({&slide, 1}, errand);
  CHECK(errand.moves(0)[0].onto == scene.mesh.faces[12].point[1]);
  CHECK(errand.moves(0)[0].to == scene.mesh.place[scene.mesh.faces[12].point[1]]);
}

}  // namespace
}  // namespace lodestone::facets
