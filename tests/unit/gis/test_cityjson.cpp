// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "gis_support.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

// A unit cube whose top is a RoofSurface, with a child part, at UTM coordinates by transform.
std::string city(const std::string& version, const std::string& extra_object = "", const std::string& extra_root = "") {
  return R"({"type":"CityJSON","version":")" + version + R"(",
    "transform":{"scale":[0.001,0.001,0.001],"translate":[678000.0,5403000.0,400.0]},
    "metadata":{"referenceSystem":"https://www.opengis.net/def/crs/EPSG/0/7415"},)" +
         extra_root + R"(
    "CityObjects":{"house":{"type":"Building","geometry":[{"type":"Solid","lod":"2.2",
      "boundaries":[[[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]],
      "semantics":{"surfaces":[{"type":"GroundSurface"},{"type":"RoofSurface"},{"type":"WallSurface"}],
                   "values":[[0,1,2,2,2,2]]}},
      {"type":"Solid","lod":"1","boundaries":[[[[0,3,2,1]]]]}])" +
         extra_object + R"(}},
    "vertices":[[0,0,0],[1000,0,0],[1000,1000,0],[0,1000,0],[0,0,1000],[1000,0,1000],[1000,1000,1000],[0,1000,1000]]})";
}

}  // namespace

TEST_CASE("CityJSON: a solid keeps its area, place, meaning and reference system in every version") {
  for (const std::string version : {"1.0", "1.1", "2.0"}) {
    const auto loaded = read_cityjson(input_of(city(version), "a.city.json"), {}, {});
    REQUIRE(loaded.ok());
    const Mesh& mesh = loaded->mesh;
    CHECK(mesh.triangle_count() == 12);
    CHECK(area_m2(mesh) == Approx(6.0));
    CHECK(mesh.crs == "EPSG:7415");
    CHECK(bounds(mesh).min.x + mesh.origin.x == Approx(678000.0).epsilon(1e-9));
    const Feature* roof = feature_of(mesh, "RoofSurface");
    REQUIRE(roof != nullptr);
    CHECK(mesh.features[roof->parent].id == "house");
    CHECK(inspect(mesh).boundary_edges == 0);
    CHECK(validate(mesh).ok());
  }
}

TEST_CASE("CityJSON: other versions and other JSON are refused by name") {
  const auto later = read_cityjson(input_of(city("3.0"), "a.json"), {}, {});
  REQUIRE_FALSE(later.ok());
  CHECK(later.error().code == ErrorCode::Unsupported);
  CHECK(read_cityjson(input_of(R"({"asset":{}})", "a.json"), {}, {}).error().code == ErrorCode::BadData);
  CHECK(read_cityjson(input_of("{", "a.json"), {}, {}).error().code == ErrorCode::BadData);
  CHECK(read_cityjson(input_of("[1,2", "a.json"), {}, {}).error().code == ErrorCode::BadData);
}

TEST_CASE("CityJSON: materials and textures are found, and wrong indices cost only the look") {
  const std::string appearance = R"("appearance":{
    "materials":[{"name":"glass","diffuseColor":[0.1,0.2,0.3],"transparency":0.6}],
    "textures":[{"type":"JPG","image":"none/stone.jpg"}],
    "vertices-texture":[[0,0],[5,0],[5,5],[0,5]]},)";
  std::string text = city("2.0", "", appearance);
  const std::string at = R"("values":[[0,1,2,2,2,2]]})";
  text.insert(
      text.find(at) + at.size(),
      R"(,"material":{"m":{"values":[[0,0,0,0,0,0]]}},"texture":{"t":{"values":[[[[0,0,1,2,3]],[[0,9,1,2,3]],[[null]],[[null]],[[null]],[[null]]]]}})");
  const auto loaded = read_cityjson(input_of(text, "a.json"), {}, {});
  REQUIRE(loaded.ok());
  const Mesh& mesh = loaded->mesh;
  CHECK(warned(loaded.warnings(), "texture coordinate that is not there"));
  CHECK(warned(loaded.warnings(), "stone.jpg"));
  CHECK(mesh.materials.size() == 2);
  for (const Material& material : mesh.materials) CHECK(material.base_color.a == Approx(0.4F));
  CHECK(std::count(mesh.vertices.uvs.begin(), mesh.vertices.uvs.end(), glm::vec2{5.0F, 5.0F}) == 1);
}

TEST_CASE("CityJSON: a part with more detail replaces the whole's, and belongs to it") {
  const std::string part =
      R"(},"part":{"type":"BuildingPart","parents":["house"],"geometry":[{"type":"MultiSurface","lod":"3",
    "boundaries":[[[0,1,2,3]]]}])";
  std::string text = city("1.1", part);
  text.insert(text.find(R"("geometry")"), R"("children":["part"],)");
  const auto loaded = read_cityjson(input_of(text, "a.json"), {}, {});
  REQUIRE(loaded.ok());
  CHECK(loaded->mesh.triangle_count() == 2);
  const Feature* feature = feature_of(loaded->mesh, "BuildingPart");
  REQUIRE(feature != nullptr);
  CHECK(loaded->mesh.features[feature->parent].id == "house");
}

TEST_CASE("CityJSON: templates are placed by matrix and anchor") {
  const std::string templates = R"("geometry-templates":{"vertices-templates":[[0,0,0],[1,0,0],[0,1,0]],
    "templates":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}]},)";
  const std::string tree =
      R"(},"tree":{"type":"SolitaryVegetationObject","geometry":[{"type":"GeometryInstance","template":0,
    "boundaries":[1],"transformationMatrix":[3,0,0,0, 0,3,0,0, 0,0,3,0, 0,0,0,1]}])";
  const auto loaded = read_cityjson(input_of(city("2.0", tree, templates), "a.json"), {}, {});
  REQUIRE(loaded.ok());
  CHECK(loaded->mesh.triangle_count() == 13);
  CHECK(bounds(loaded->mesh).size().x == Approx(4.0));
}

TEST_CASE("CityJSON: a sequence of features, one a line, is one model") {
  const std::string sequence =
      R"({"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{},"vertices":[]})"
      "\n"
      R"({"type":"CityJSONFeature","id":"a","CityObjects":{"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]}},"vertices":[[0,0,0],[1,0,0],[0,1,0]]})"
      "\n"
      R"({"type":"CityJSONFeature","id":"b","CityObjects":{"b":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2]]]}]}},"vertices":[[5,0,0],[6,0,0],[5,1,0]]})"
      "\n";
  const auto loaded = read_cityjson(input_of(sequence, "a.city.jsonl"), {}, {});
  REQUIRE(loaded.ok());
  CHECK(loaded->mesh.triangle_count() == 2);
  CHECK(loaded->mesh.features.size() == 2);
}

TEST_CASE("CityJSON: indices out of range, circles of children and rubbish types are survived") {
  std::string text = city("2.0");
  text.replace(text.find("[[4,5,6,7]]"), 11, "[[4,5,6,99]]");
  const auto fewer = read_cityjson(input_of(text, "a.json"), {}, {});
  REQUIRE(fewer.ok());
  CHECK(warned(fewer.warnings(), "vertex that is not there"));
  std::string circle = city("2.0");
  circle.insert(circle.find(R"("geometry")"), R"("children":["house"],"parents":["house"],)");
  CHECK(read_cityjson(input_of(circle, "a.json"), {}, {}).ok());
  for (
      const char* rubbish :
      {R"({"type":"CityJSON","version":"2.0","CityObjects":[],"vertices":{}})",
       R"({"type":"CityJSON","version":"2.0","CityObjects":{"a":1,"b":null,"c":{"geometry":{"x":[]}}},"vertices":[1,"a",null]})",
       R"({"type":"CityJSON","version":2,"vertices":[]})"}) {
    CHECK_FALSE(read_cityjson(input_of(rubbish, "a.json"), {}, {}).ok());
  }
}
