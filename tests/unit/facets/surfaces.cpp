// SPDX-License-Identifier: MIT
#include <lodestone/facet_shift.h>
#include <lodestone/generate.h>

#include <catch2/catch.hpp>

#include "shapes.h"
#include "small_house.h"

namespace lodestone {
namespace {

TEST_CASE("a cube has six surfaces: four walls, a roof and a ground") {
  for (const Mesh& mesh : {test::cube(), test::unwelded(test::cube())}) {
    const CharacteristicSurfaces found = characteristic_surfaces(mesh);
    REQUIRE(found.surfaces.size() == 6);
    std::uint32_t walls = 0, roofs = 0, grounds = 0;
    for (const CharacteristicSurface& s : found.surfaces) {
      CHECK(s.area_m2 == Approx(4.0));
      CHECK(s.face_count == 2);
      walls += s.kind == SurfaceClass::Wall ? 1 : 0;
      roofs += s.kind == SurfaceClass::Roof ? 1 : 0;
      grounds += s.kind == SurfaceClass::Ground ? 1 : 0;
    }
    CHECK(walls == 4);
    CHECK(roofs == 1);
    CHECK(grounds == 1);
  }
}

TEST_CASE("every face lies in the plane of its surface within the tolerance") {
  const Mesh house = test::small_house(3000);
  const SurfaceTolerance tolerance;
  const CharacteristicSurfaces found = characteristic_surfaces(house, tolerance);
  REQUIRE(found.surface_of_face.size() == house.triangle_count());
  double farthest = 0.0;
  for (std::size_t c = 0; c < house.indices.size(); ++c) {
    const std::uint32_t s = found.surface_of_face[c / 3];
    if (s == none) continue;
    const glm::dvec3 p{house.vertices.positions[house.indices[c]]};
    farthest = std::max(farthest, std::abs(glm::dot(found.surfaces[s].normal, p) - found.surfaces[s].offset_m));
  }
  CHECK(farthest <= tolerance.offset_m);
}

TEST_CASE("semantic classes go before directions") {
  Mesh mesh = test::cube();
  mesh.features = {{"w", "WallSurface", none}, {"v", "Window", 0}, {"x", "", 1}};
  mesh.face_features.assign(mesh.triangle_count(), 2);
  for (const CharacteristicSurface& s : characteristic_surfaces(mesh).surfaces) CHECK(s.kind == SurfaceClass::Opening);
  mesh.features[2].semantic_class = "IfcRailing";
  for (const auto& s : characteristic_surfaces(mesh).surfaces) CHECK(s.kind == SurfaceClass::Installation);
  mesh.features = {{"s", "IfcSlab", none}};
  mesh.face_features.assign(mesh.triangle_count(), 0);
  CHECK(characteristic_surfaces(mesh).surfaces.size() == 6);  // by direction: a slab has a top, a bottom and sides
  mesh.features = {{"w", "WallSurface", none}};
  for (const CharacteristicSurface& s : characteristic_surfaces(mesh).surfaces) CHECK(s.kind == SurfaceClass::Wall);
}

TEST_CASE("houses are planar, spheres and terrain are not") {
  const Mesh house = test::small_house(3000);
  CHECK(planar_area_share(house, 1e-3) > 0.8);
  CHECK(planar_area_share(test::sphere(60, 80), 1e-3) < 0.2);
}

}  // namespace
}  // namespace lodestone
