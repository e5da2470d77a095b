// SPDX-License-Identifier: MIT
// Windows go whole, also where few faces are left.
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "data.h"
#include "directions.h"
#include "facets/judge.h"

namespace lodestone {
namespace {

// Where the ray first meets the mesh, infinite if nowhere; a number of faces that needs no tree.
double first_hit_m(const Mesh& mesh, const glm::dvec3& from, const glm::dvec3& along) {
  double nearest = std::numeric_limits<double>::infinity();
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const auto at = [&](std::uint32_t k) {
      return glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
    };
    const glm::dvec3 a = at(0), u = at(1) - a, v = at(2) - a, n = glm::cross(u, v);
    const double slope = glm::dot(n, along);
    if (std::abs(slope) < 1e-12) continue;
    const double way = glm::dot(n, a - from) / slope;
    const glm::dvec3 to = from + way * along - a;
    const double s = glm::dot(glm::cross(to, v), n) / glm::dot(n, n);
    const double t = glm::dot(glm::cross(u, to), n) / glm::dot(n, n);
    if (way > 0.0 && way < nearest && s >= 0.0 && t >= 0.0 && s + t <= 1.0) nearest = way;
  }
  return nearest;
}

// Of rays that come level from all four sides, the share that meets a wall of the IFC house: 12 x 10 m, 30 cm thick.
double share_stopped(const Mesh& mesh) {
  int stopped = 0, count = 0;
  for (const glm::dvec3& along :
       {glm::dvec3{1, 0, 0}, glm::dvec3{-1, 0, 0}, glm::dvec3{0, 1, 0}, glm::dvec3{0, -1, 0}}) {
    for (int column = 0; column < 20; ++column) {
      for (const double z : {0.31, 0.83, 1.37, 1.91, 2.33}) {
        const double aside = 0.4 + 0.041 + column * 0.45;
        const glm::dvec3 from{along.x > 0   ? -5.0
                              : along.x < 0 ? 17.0
                                            : aside,
                              along.y > 0   ? -5.0
                              : along.y < 0 ? 15.0
                                            : aside,
                              z};
        const double way = first_hit_m(mesh, from, along);
        stopped += way > 4.5 && way < 5.35 ? 1 : 0;
        ++count;
      }
    }
  }
  return static_cast<double>(stopped) / count;
}

TEST_CASE("the walls of the IFC house close and stay closed, and its site stays flat") {
  LODESTONE_REQUIRE_DATA(root);
  CAPTURE(root.string());  // without data, as under sanitizers, this would take too long
  const std::filesystem::path file{"/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc"};
  if (!std::filesystem::exists(file)) {
    WARN("SKIPPED: assimp-testmodels is not installed");
    return;
  }
  const auto house = read_mesh(file);
  REQUIRE(house.ok());
  const CharacteristicSurfaces directions = characteristic_surfaces(house->mesh);
  const auto built = build_by_facet_shift(house->mesh);
  REQUIRE(built.ok());
  CHECK(built->report.reached_block);
  for (const auto& [triangles, closed] :
       {std::pair{500U, 0.9}, std::pair{350U, 0.95}, std::pair{250U, 0.98}, std::pair{180U, 0.98}}) {
    CAPTURE(triangles);
    const Mesh shown = built->model->extract(built->model->level_of_triangles(triangles));
    CHECK(shown.triangle_count() > triangles - 20);  // not the block yet
    CHECK(share_stopped(shown) >= closed);
    const test::Leaning found = test::leaning(directions, shown);
    CHECK(found.walls_m2 < 2e-2 * found.area_m2);
    CHECK(found.others_m2 < 2e-2 * found.area_m2);
  }
}

// Cells between the columns and rows, in the plane y = 0, each of two triangles; `panes` are of material 1.
Mesh facade(const std::vector<float>& x, const std::vector<float>& z, const std::vector<std::size_t>& panes) {
  Mesh mesh;
  mesh.materials.resize(2);
  mesh.materials[1].base_color = {0.2F, 0.3F, 0.6F, 1.0F};
  for (const float row : z) {
    for (const float column : x) mesh.vertices.positions.emplace_back(column, 0.0F, row);
  }
  const auto width = static_cast<VertexId>(x.size());
  for (VertexId cell = 0; cell < (width - 1) * (z.size() - 1); ++cell) {
    const VertexId a = cell / (width - 1) * width + cell % (width - 1);
    mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + 1 + width, a, a + 1 + width, a + width});
    mesh.face_materials.insert(mesh.face_materials.end(), 2,
                               std::find(panes.begin(), panes.end(), cell) != panes.end());
  }
  return mesh;
}

TEST_CASE("a corner of a window does not slide across the wall onto another window") {
  // Two windows 3 m apart; the upper 2 cm of them are cells of their own.
  const Mesh mesh = facade({0, 2, 3, 6, 7, 10}, {0, 2, 2.98F, 3, 6}, {6, 8, 11, 13});
  std::vector<FaceId> degenerate;
  const facets::FacetMesh facets = facets::make_facet_mesh(mesh, {}, degenerate);
  const facets::Pieces pieces{facets};
  facets::SlideJudge judge{facets, pieces};
  judge.look_at(20);
  const auto across = judge.judge(21, 1e9);
  CHECK(across.cost > 0.01);
  CHECK(across.error_m > 2.9);
  const auto along = judge.judge(14, 1e9);
  CHECK(along.cost < 0.01);
}

}  // namespace
}  // namespace lodestone
