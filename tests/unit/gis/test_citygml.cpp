// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "data.h"
#include "gis/city_builder.h"
#include "gis_support.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

const std::string head =
    R"(<core:CityModel xmlns:core="c" xmlns:bldg="b" xmlns:gml="g" xmlns:app="a" xmlns:xlink="x">)"
    R"(<gml:boundedBy><gml:Envelope srsName="urn:ogc:def:crs:EPSG::25832" srsDimension="3"/></gml:boundedBy>)";

std::string ring(const std::string& id, const std::string& points) {
  return "<gml:LinearRing gml:id=\"" + id + "\"><gml:posList>" + points + "</gml:posList></gml:LinearRing>";
}

// A square with a square hole, in the plane z = 414, at UTM coordinates.
const std::string outer =
    "678000 5403000 414 678010 5403000 414 678010 5403010 414 678000 5403010 414 678000 5403000 414";
const std::string hole =
    "678004 5403004 414 678004 5403006 414 678006 5403006 414 678006 5403004 414 678004 5403004 414";

std::string wall(const std::string& lod, const std::string& polygon) {
  return "<bldg:boundedBy><bldg:WallSurface gml:id=\"w\"><bldg:lod" + lod + "MultiSurface><gml:MultiSurface>" +
         polygon + "</gml:MultiSurface></bldg:lod" + lod + "MultiSurface></bldg:WallSurface></bldg:boundedBy>";
}

std::string building(const std::string& inside) {
  return head + "<core:cityObjectMember><bldg:Building gml:id=\"house\">" + inside +
         "</bldg:Building></core:cityObjectMember></core:CityModel>";
}

const std::string square = "<gml:surfaceMember><gml:Polygon gml:id=\"p\"><gml:exterior>" + ring("r", outer) +
                           "</gml:exterior><gml:interior>" + ring("h", hole) +
                           "</gml:interior></gml:Polygon></gml:surfaceMember>";

}  // namespace

TEST_CASE("CityGML: a polygon with a hole keeps its area, its place and its meaning") {
  const std::string text = building(wall("3", square));
  const auto loaded = read_citygml(input_of(text, "a.gml"), {}, {});
  REQUIRE(loaded.ok());
  const Mesh& mesh = loaded->mesh;
  CHECK(mesh.triangle_count() == 8);
  CHECK(area_m2(mesh) == Approx(96.0));
  CHECK(mesh.crs == "EPSG:25832");
  CHECK(bounds(mesh).min + mesh.origin == glm::dvec3{678000, 5403000, 414});
  const Feature* surface = feature_of(mesh, "WallSurface");
  REQUIRE(surface != nullptr);
  CHECK(mesh.features[surface->parent].semantic_class == "Building");
  CHECK(mesh.features[mesh.face_feature(0)].id == "w");
  CHECK(validate(mesh).ok());
}

TEST_CASE("CityGML: the highest level of detail is taken and lower ones are left out") {
  const std::string low = "<bldg:lod1Solid><gml:Solid><gml:exterior><gml:CompositeSurface>" + square +
                          "</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod1Solid>";
  std::string high = square;
  high.replace(high.find("\"p\""), 3, "\"q\"");
  const auto loaded = read_citygml(input_of(building(low + wall("3", high)), "a.gml"), {}, {});
  REQUIRE(loaded.ok());
  CHECK(area_m2(loaded->mesh) == Approx(96.0));
}

TEST_CASE("CityGML: a solid that refers to its walls' polygons does not double them") {
  const std::string solid =
      "<bldg:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface><gml:surfaceMember xlink:href=\"#p\"/>"
      "</gml:CompositeSurface></gml:exterior></gml:Solid></bldg:lod2Solid>";
  const auto loaded = read_citygml(input_of(building(solid + wall("2", square)), "a.gml"), {}, {});
  REQUIRE(loaded.ok());
  CHECK(area_m2(loaded->mesh) == Approx(96.0));
  CHECK(loaded->mesh.features[loaded->mesh.face_feature(0)].semantic_class == "WallSurface");
}

TEST_CASE("CityGML: materials and textures find their polygons, with uv by ring") {
  const std::string looks =
      "<app:appearanceMember><app:Appearance><app:theme>t</app:theme>"
      "<app:surfaceDataMember><app:X3DMaterial><app:diffuseColor>0.5 0.25 1</app:diffuseColor>"
      "<app:transparency>0.5</app:transparency><app:target>#w</app:target></app:X3DMaterial></app:surfaceDataMember>"
      "<app:surfaceDataMember><app:ParameterizedTexture><app:imageURI>none/brick.jpg</app:imageURI><app:target "
      "uri=\"#p\">"
      "<app:TexCoordList><app:textureCoordinates ring=\"#r\">0 0 7 0 7 7 0 7 0 0</app:textureCoordinates>"
      "<app:textureCoordinates ring=\"#h\">1 1 1 2 2 2 2 1 1 1</app:textureCoordinates></app:TexCoordList></app:target>"
      "</app:ParameterizedTexture></app:surfaceDataMember></app:Appearance></app:appearanceMember>";
  std::string text = building(wall("3", square));
  text.insert(text.find("<core:cityObjectMember>"), looks);
  const auto loaded = read_citygml(input_of(text, "a.gml"), {}, {});
  REQUIRE(loaded.ok());
  const Material& material = loaded->mesh.materials[loaded->mesh.face_material(0)];
  CHECK(material.base_color == glm::vec4{0.5F, 0.25F, 1.0F, 0.5F});
  CHECK(material.transparent());
  CHECK(material.name == "brick");
  REQUIRE(loaded->mesh.vertices.uvs.size() == loaded->mesh.vertices.positions.size());
  const auto& uvs = loaded->mesh.vertices.uvs;
  CHECK(std::count(uvs.begin(), uvs.end(), glm::vec2{7.0F, 7.0F}) == 1);
  CHECK(warned(loaded.warnings(), "brick.jpg"));
}

TEST_CASE("CityGML: an orientable surface with '-' turns its faces") {
  std::string flipped = square;
  flipped = "<gml:surfaceMember><gml:OrientableSurface orientation=\"-\"><gml:baseSurface>" +
            flipped.substr(std::strlen("<gml:surfaceMember>"));
  flipped.replace(flipped.rfind("</gml:surfaceMember>"), std::string::npos,
                  "</gml:baseSurface></gml:OrientableSurface></gml:surfaceMember>");
  const auto normal_z = [](const Mesh& mesh) {
    const auto& p = mesh.vertices.positions;
    return glm::cross(p[mesh.indices[1]] - p[mesh.indices[0]], p[mesh.indices[2]] - p[mesh.indices[0]]).z;
  };
  const auto up = read_citygml(input_of(building(wall("3", square)), "a.gml"), {}, {});
  const auto down = read_citygml(input_of(building(wall("3", flipped)), "a.gml"), {}, {});
  REQUIRE(up.ok());
  REQUIRE(down.ok());
  CHECK(normal_z(up->mesh) > 0.0F);
  CHECK(normal_z(down->mesh) < 0.0F);
}

TEST_CASE("CityGML: implicit geometry is placed by its matrix and reference point, as often as it is named") {
  const auto place = [](const std::string& x) {
    return "<bldg:outerBuildingInstallation><bldg:BuildingInstallation><bldg:lod3ImplicitRepresentation><core:"
           "ImplicitGeometry>"
           "<core:transformationMatrix>2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</core:transformationMatrix>"
           "<core:relativeGMLGeometry xlink:href=\"#proto\"/><core:referencePoint><gml:Point><gml:pos>" +
           x +
           " 0 0</gml:pos></gml:Point></core:referencePoint></core:ImplicitGeometry></bldg:lod3ImplicitRepresentation>"
           "</bldg:BuildingInstallation></bldg:outerBuildingInstallation>";
  };
  const std::string proto =
      "<bldg:note><gml:MultiSurface gml:id=\"proto\"><gml:surfaceMember><gml:Polygon><gml:exterior>" +
      ring("x", "0 0 0 1 0 0 0 1 0 0 0 0") +
      "</gml:exterior></gml:Polygon></gml:surfaceMember></gml:MultiSurface></bldg:note>";
  const auto loaded = read_citygml(input_of(building(proto + place("10") + place("20")), "a.gml"), {}, {});
  REQUIRE(loaded.ok());
  CHECK(loaded->mesh.triangle_count() == 2);
  const Box box = bounds(loaded->mesh);
  CHECK(box.min.x == Approx(10.0));
  CHECK(box.max.x == Approx(22.0));
}

TEST_CASE("CityGML: broken files are refused in one line or read with warnings, never worse") {
  CHECK(read_citygml(input_of("<a><b></a>", "a.gml"), {}, {}).error().code == ErrorCode::BadData);
  CHECK(read_citygml(input_of("<osm/>", "a.gml"), {}, {}).error().message.find("CityModel") != std::string::npos);
  CHECK_FALSE(read_citygml(input_of(building(""), "a.gml"), {}, {}).ok());
  std::string nan = building(wall("3", square + square));
  nan.replace(nan.find("678010"), 6, "nan");
  const auto loaded = read_citygml(input_of(nan, "a.gml"), {}, {});
  REQUIRE(loaded.ok());
  CHECK(warned(loaded.warnings(), "finite"));
  // References that multiply, and a circle of them.
  std::string many = square;
  for (int i = 0; i < 40; ++i) {
    const std::string next = "<gml:surfaceMember xlink:href=\"#c" + std::to_string(i + 1) + "\"/>";
    many += "<gml:surfaceMember><gml:CompositeSurface gml:id=\"c" + std::to_string(i) + "\">" + next + next +
            "</gml:CompositeSurface></gml:surfaceMember>";
  }
  const auto enough = read_citygml(input_of(building(wall("3", many)), "a.gml"), {}, {});
  REQUIRE(enough.ok());
  CHECK(warned(enough.warnings(), "multiply"));
  std::string circle = building(wall(
      "3", square +
               "<gml:surfaceMember><gml:CompositeSurface gml:id=\"c\"><gml:surfaceMember "
               "xlink:href=\"#c\"/><gml:surfaceMember xlink:href=\"#c\"/></gml:CompositeSurface></gml:surfaceMember>"));
  const auto once = read_citygml(input_of(circle, "a.gml"), {}, {});
  REQUIRE(once.ok());
  CHECK(warned(once.warnings(), "circle"));
}

TEST_CASE("CityGML: reference systems in every usual spelling become EPSG codes") {
  CHECK(gis::epsg_name("EPSG:32632") == "EPSG:32632");
  CHECK(gis::epsg_name("urn:ogc:def:crs:EPSG::25832") == "EPSG:25832");
  CHECK(gis::epsg_name("urn:ogc:def:crs:EPSG:6.12:31467") == "EPSG:31467");
  CHECK(gis::epsg_name("urn:ogc:def:crs,crs:EPSG:6.12:31467,crs:EPSG:6.12:5783") == "EPSG:31467");
  CHECK(gis::epsg_name("http://www.opengis.net/def/crs/EPSG/0/7415") == "EPSG:7415");
  CHECK(gis::epsg_name("https://www.opengis.net/def/crs/EPSG/0/7415") == "EPSG:7415");
  CHECK(gis::epsg_name("local") == "local");
}

TEST_CASE("CityGML: real buildings have the area, size and meanings of their OBJ twins") {
  LODESTONE_REQUIRE_DATA(root);
  for (const std::string id : {"4018215", "4018267", "4018271"}) {
    INFO(id);
    const auto loaded = read_mesh(root / "buildings" / "citygml" / id / (id + ".xml"));
    const auto twin = read_mesh(root / "buildings" / id / (id + ".obj"));
    REQUIRE(loaded.ok());
    REQUIRE(twin.ok());
    const Mesh& mesh = loaded->mesh;
    CHECK(loaded->info.format == "citygml");
    // The twin was cut to whole millimetres and lost its slivers.
    CHECK(area_m2(mesh) == Approx(area_m2(twin->mesh)).epsilon(1e-3));
    CHECK(std::abs(static_cast<double>(mesh.triangle_count()) / twin->mesh.triangle_count() - 1.0) < 0.03);
    CHECK(glm::length(bounds(mesh).size() - bounds(twin->mesh).size()) < 0.002);
    CHECK(mesh.crs == "EPSG:32632");
    CHECK(feature_of(mesh, "Window") != nullptr);
    CHECK(feature_of(mesh, "RoofSurface") != nullptr);
    CHECK(std::any_of(mesh.materials.begin(), mesh.materials.end(), [](const Material& m) { return m.transparent(); }));
    CHECK(
        std::any_of(mesh.textures.begin(), mesh.textures.end(), [](const Texture& t) { return t.encoded != nullptr; }));
    CHECK(validate(mesh).ok());
  }
}
