// SPDX-License-Identifier: MIT
#include <unistd.h>
#include <csignal>
#include <cstdlib>

#include "data.h"
#include "meshes/isolated.h"
#include "reading.h"

using namespace lodestone;
using lodestone::test::read_text;

namespace {

constexpr std::string_view tetrahedron_stl =
    "solid a\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
    "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 2\nendloop\nendfacet\nendsolid a\n";

}  // namespace

TEST_CASE("an STL is read as it lies, Z up") {
  const auto read = read_text(tetrahedron_stl, "a.stl");
  REQUIRE(read.ok());
  CHECK(read->info.format == "stl");
  CHECK(read->info.up_axis == "Z");
  CHECK(read->mesh.triangle_count() == 2);
  CHECK(bounds(read->mesh).max.z == 2.0);
}

TEST_CASE("a COLLADA file's axes and unit are applied") {
  const auto dae = [](const std::string& up) {
    return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>
<unit name="centimeter" meter="0.01"/><up_axis>)" +
           up +
           R"(</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">
0 0 0 100 0 0 0 0 100</float_array><technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  };
  const auto z_up = read_text(dae("Z_UP"), "a.dae");
  REQUIRE(z_up.ok());
  CHECK(bounds(z_up->mesh).max.z == Approx(1.0));
  CHECK(bounds(z_up->mesh).max.x == Approx(1.0));
  const auto y_up = read_text(dae("Y_UP"), "a.dae");
  REQUIRE(y_up.ok());
  CHECK(bounds(y_up->mesh).min.y == Approx(-1.0));
}

TEST_CASE("a file that its importer cannot read is an error that names it") {
  for (const char* name : {"a.3ds", "a.dae", "a.fbx", "a.ifc", "a.blend", "a.x"}) {
    const auto read = read_text("this is none of these formats", name);
    CAPTURE(name);
    REQUIRE_FALSE(read.ok());
    CHECK(read.error().where.find(name) == 0);
  }
}

TEST_CASE("an importer that crashes, throws, or is cancelled is an error here") {
  const Input input = Input::from_bytes({}, "broken.xyz");
  const auto crashed = run_isolated(input, {}, []() -> Result<LoadedMesh> {
    std::signal(SIGSEGV, SIG_DFL);
    std::raise(SIGKILL);
    return LoadedMesh{};
  });
  REQUIRE_FALSE(crashed.ok());
  CHECK(crashed.error().code == ErrorCode::BadData);
  CHECK(crashed.error().where == "broken.xyz");
  const auto thrown = run_isolated(input, {}, []() -> Result<LoadedMesh> { throw std::runtime_error{"no"}; });
  CHECK_FALSE(thrown.ok());
  const std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const auto endless = run_isolated(input, context, []() -> Result<LoadedMesh> {
    for (;;) ::usleep(1000);
  });
  REQUIRE_FALSE(endless.ok());
  CHECK(endless.error().code == ErrorCode::Cancelled);
  Context small;
  small.max_memory_bytes = 64U << 20;
  const auto hungry = run_isolated(input, small, []() -> Result<LoadedMesh> {
    std::vector<std::string> all;
    for (;;) all.emplace_back(1U << 20, 'x');
  });
  REQUIRE_FALSE(hungry.ok());
  CHECK(hungry.error().code == ErrorCode::TooLarge);
}

TEST_CASE("a 3DS building is the OBJ building, triangle for triangle in place") {
  LODESTONE_REQUIRE_DATA(root);
  for (const char* id : {"4018215", "4018267"}) {
    const auto from_3ds = read_mesh(root / "buildings" / "3ds" / (std::string{id} + ".3ds"));
    const auto from_obj = read_mesh(root / "buildings" / id / (std::string{id} + ".obj"));
    REQUIRE(from_3ds.ok());
    REQUIRE(from_obj.ok());
    CHECK(from_3ds->info.up_axis == "Z");
    CHECK(from_3ds->mesh.triangle_count() == from_obj->mesh.triangle_count());
    const Box a = bounds(from_3ds->mesh);
    const Box b = bounds(from_obj->mesh);
    CHECK(glm::length(a.min - b.min) < 1e-4);
    CHECK(glm::length(a.max - b.max) < 1e-4);
    CHECK(test::area(from_3ds->mesh) == Approx(test::area(from_obj->mesh)).epsilon(1e-4));
  }
}

TEST_CASE("IFC, Blender and DXF models stand upright") {
  const std::filesystem::path models{"/usr/share/assimp/models"};  // Debian package assimp-testmodels
  if (!std::filesystem::exists(models / "IFC" / "AC14-FZK-Haus.ifc")) {
    WARN("SKIPPED: assimp-testmodels is not installed");
    return;
  }
  const auto house = read_mesh(models / "IFC" / "AC14-FZK-Haus.ifc");
  REQUIRE(house.ok());
  CHECK(house->info.up_axis == "Z");
  CHECK(bounds(house->mesh).size().z == Approx(7.318).epsilon(0.01));
  CHECK(std::any_of(house->mesh.features.begin(), house->mesh.features.end(),
                    [](const Feature& f) { return f.semantic_class.starts_with("IfcWall"); }));
  const auto plane = read_mesh(models / "BLEND" / "plane_2_textures_2_texcoords_279.blend");
  REQUIRE(plane.ok());
  CHECK(bounds(plane->mesh).size().z < 1e-6);
  const auto figure = read_mesh(models / "DXF" / "wuson.dxf");
  REQUIRE(figure.ok());
  CHECK(figure->info.up_axis == "Z");
}
