// SPDX-License-Identifier: MIT
#include <lodestone/facet_shift.h>
#include <lodestone/generate.h>

#include <catch2/catch.hpp>

#include "shapes.h"
#include "small_house.h"
#include "walls.h"

namespace lodestone {
namespace {

TEST_CASE("a panel before or behind a wall is a bulge or a depression over its four sides") {
  for (const float depth_m : {0.2F, -0.3F}) {
    CAPTURE(depth_m);
    const FacetGraph graph = facet_graph(test::wall_with_panel(depth_m));
    REQUIRE(graph.steps.size() == 1);
    const FacetStep& step = graph.steps[0];
    CHECK(graph.surfaces.surfaces[step.lesser].area_m2 == Approx(1.0));
    CHECK(graph.surfaces.surfaces[step.greater].area_m2 == Approx(59.0));
    CHECK(step.height_m == Approx(-depth_m));  // the wall looks towards negative y
    CHECK(step.sides.size() == 4);
    const FacetFamily& wall = graph.families[0];
    CHECK(wall.datum == step.greater);
    CHECK(wall.kind == SurfaceClass::Wall);
    CHECK(wall.wall == WallType::UnevenOneSide);
    REQUIRE(wall.surfaces.size() == 2);
    CHECK(wall.distance_m[0] + wall.distance_m[1] == Approx(-depth_m));
  }
}

TEST_CASE("walls are flat, uneven on one side or uneven on both") {
  Mesh mesh = test::wall_with_panel(0.2F);
  const Mesh other = test::wall_with_panel(-0.2F);
  const auto first = mesh.vertex_count();
  for (const glm::vec3& p : other.vertices.positions) mesh.vertices.positions.push_back(p + glm::vec3{20, 0, 0});
  for (const VertexId v : other.indices) mesh.indices.push_back(v + first);
  const FacetGraph both = facet_graph(mesh);
  CHECK(both.families[0].wall == WallType::UnevenBothSides);
  CHECK(both.steps.size() == 2);
  // Farther apart than the gap they are two walls.
  const FacetGraph apart = facet_graph(mesh, {.family_gap_m = 0.1});
  CHECK(apart.families[0].wall == WallType::Flat);
  for (const FacetFamily& f : facet_graph(test::cube()).families) CHECK(f.wall == WallType::Flat);
}

TEST_CASE("roofs are told apart: flat, sloped, and the spire of a tower") {
  const auto roofs_of = [](Roof roof) {
    const Mesh house = test::small_house(3000, roof);
    return facet_graph(house).roofs;
  };
  CHECK(roofs_of(Roof::Flat).front().type == RoofType::Flat);
  for (const Roof roof : {Roof::Gable, Roof::Hip}) {
    const std::vector<RoofPart> roofs = roofs_of(roof);
    CHECK(roofs.front().type == RoofType::Sloped);
    CHECK(roofs.front().pitch_rad > glm::radians(15.0));
    CHECK(std::none_of(roofs.begin(), roofs.end(), [](const RoofPart& r) { return r.type == RoofType::Spire; }));
  }
  const std::vector<RoofPart> spire = roofs_of(Roof::Spire);
  CHECK(std::count_if(spire.begin(), spire.end(), [](const RoofPart& r) { return r.type == RoofType::Spire; }) == 1);
}

TEST_CASE("families partition the larger surfaces, and the datum is their largest") {
  const Mesh house = test::small_house(3000);
  const FacetGraph graph = facet_graph(house);
  std::vector<std::uint32_t> times(graph.surfaces.surfaces.size(), 0);
  for (const FacetFamily& family : graph.families) {
    REQUIRE(family.surfaces.size() == family.distance_m.size());
    CHECK(std::is_sorted(family.distance_m.begin(), family.distance_m.end()));
    for (const std::uint32_t s : family.surfaces) {
      ++times[s];
      CHECK(graph.surfaces.surfaces[s].area_m2 <= graph.surfaces.surfaces[family.datum].area_m2);
      CHECK(glm::dot(graph.surfaces.surfaces[s].normal, graph.surfaces.surfaces[family.datum].normal) > 0.999);
    }
  }
  CHECK(*std::max_element(times.begin(), times.end()) == 1);
  // The reveals of its windows are sides, and the panes lie behind the wall.
  CHECK(std::count_if(graph.steps.begin(), graph.steps.end(), [](const FacetStep& s) { return s.height_m < 0.0; }) >
        50);
  for (const FacetStep& step : graph.steps) {
    CHECK(graph.surfaces.surfaces[step.lesser].area_m2 <= graph.surfaces.surfaces[step.greater].area_m2);
  }
}

}  // namespace
}  // namespace lodestone
