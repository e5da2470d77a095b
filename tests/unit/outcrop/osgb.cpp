// SPDX-License-Identifier: MIT
// Trees of OpenSceneGraph files, read by lodestone-osgb in a process of its own.
#include <cstdlib>
#include <fstream>

#include <lodestone/metrics.h>
#include <lodestone/tile_loader.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "data.h"
#include "fixture.h"
#include "formats/src/osgb/switching.h"
#include "viewer/headless/headless.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

void turn_into_osgb(const fs::path& folder) {
  const fs::path helper{LODESTONE_OSGB};
  const std::string path = std::getenv("PATH");
  if (!path.starts_with(helper.parent_path().string())) {
    REQUIRE(::setenv("PATH", (helper.parent_path().string() + ":" + path).c_str(), 1) == 0);
  }
  const std::string command = "'" + helper.string() + "' '" + (folder / "tileset.json").string() + "' '" +
                              (folder / "osgb").string() + "' >/dev/null 2>&1";
  REQUIRE(std::system(command.c_str()) == 0);
}

// One pyramid in both forms: "tileset.json" and "osgb/main.osgb". Tests that damage it take a copy.
const fs::path& both() {
  static const fs::path folder = [] {
    fs::path made = scratch_folder("osgb_tiles");
    REQUIRE(write_outcrop(small_cliff(), made, {.pyramid = small_tiles()}));
    turn_into_osgb(made);
    return made;
  }();
  return folder;
}

View from_south(const TilePyramid& pyramid, double radii) {
  View view;
  view.eye = pyramid.bounds().center() - glm::dvec3{0.0, 0.5 * radii * pyramid.bounds().diagonal_m(), 0.0};
  return view;
}

std::uint64_t triangles(const TilePager& pager, std::span<const NodeId> drawn) {
  std::uint64_t sum = 0;
  for (const NodeId tile : drawn) sum += pager.content(tile)->triangle_count();
  return sum;
}

}  // namespace

TEST_CASE("A pyramid of OpenSceneGraph files looks like the same one as 3D Tiles, at every distance") {
  const auto plain = TilePyramid::open(both() / "tileset.json");
  const auto osgb = TilePyramid::open(both() / "osgb/main.osgb");
  REQUIRE(plain);
  if (!osgb) FAIL(to_line(osgb.error()));
  CHECK((*osgb)->graph().nodes.size() == (*plain)->graph().nodes.size());
  CHECK((*osgb)->origin() == (*plain)->origin());
  CHECK(validate((*osgb)->graph()).ok());
  render::RenderOptions options{.width_px = 200, .height_px = 150, .supersample = 1};
  options.camera.target_m = (*plain)->origin() + (*plain)->bounds().center();
  for (const double radii : {8.0, 1.0}) {
    options.camera.eye_m = (*plain)->origin() + from_south(**plain, radii).eye;
    const auto expected = render::render_tiles(*plain, options);
    const auto picture = render::render_tiles(*osgb, options);
    REQUIRE(expected);
    if (!picture) FAIL(to_line(picture.error()));
    CHECK(image_rms(expected->image, picture->image) < 1.5);
    CHECK(double(picture->tiles) == Approx(expected->tiles).epsilon(0.3));  // boxes are tighter here
  }
}

TEST_CASE("OpenSceneGraph's files say nothing of where they were made: the same bytes in another folder") {
  const fs::path folder = scratch_folder("osgb_elsewhere");
  fs::copy(both() / "tileset.json", folder);
  fs::copy(both() / "tiles", folder / "tiles");
  turn_into_osgb(folder);
  const auto there = files_of(folder / "osgb");
  CHECK(there.size() > 2);
  CHECK(there == files_of(both() / "osgb"));
}

TEST_CASE(
    "Of OpenSceneGraph's files only those are loaded that the camera needs, and all triangles are in the finest") {
  const auto pyramid = TilePyramid::open(both() / "osgb/main.osgb");
  const auto plain = TilePyramid::open(both() / "tileset.json");
  REQUIRE(pyramid);
  REQUIRE(plain);
  TilePager pager{*pyramid};
  CHECK(pager.settle(from_south(**pyramid, 1e4)).size() == 1);
  CHECK(pager.status().loaded_tiles == 1);
  pager.set_error_px(1e-6);
  // Two workers, so two processes; frames go on meanwhile with what is there.
  const View near = from_south(**pyramid, 4.0);
  CHECK(!pager.update(near, 0.01).empty());
  TilePager other{*plain, {.error_px = 1e-6}};
  CHECK(triangles(pager, pager.settle(near)) == triangles(other, other.settle(near)));
  CHECK(pager.status().failures.empty());
}

TEST_CASE("Files of OpenSceneGraph that are missing or damaged are told, and what is coarser stands in") {
  const fs::path folder = scratch_folder("osgb_broken");
  fs::copy(both() / "osgb", folder, fs::copy_options::recursive);
  CHECK(is_tileset_file(folder / "main.osgb"));
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator{folder / "Data"}) {
    if (entry.path().filename().string().starts_with("L1_")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  REQUIRE(files.size() > 2);
  const auto whole = TilePyramid::open(folder / "main.osgb");
  REQUIRE(whole);
  fs::remove(files[0]);  // after its tiles were listed
  fs::resize_file(files[1], fs::file_size(files[1]) / 2);
  TilePager late{*whole, {.error_px = 1e-6}};
  CHECK(!late.settle(from_south(**whole, 4.0)).empty());
  CHECK(late.status().failures.size() >= 2);

  const auto broken = TilePyramid::open(folder / "main.osgb");
  REQUIRE(broken);
  TilePager pager{*broken, {.error_px = 1e-6}};
  for (const NodeId tile : pager.settle(from_south(**broken, 4.0))) CHECK(pager.content(tile) != nullptr);
  CHECK(pager.status().failures.size() == 2);

  std::ofstream{folder / "main.osgb", std::ios::binary} << "no scene";
  const auto none_such = TilePyramid::open(folder / "main.osgb");
  REQUIRE(!none_such);
  CHECK(none_such.error().code == ErrorCode::BadData);
  CHECK(TilePyramid::open(folder / "nothing.osgb").error().code == ErrorCode::NotFound);
}

TEST_CASE("Plain faces keep their base colours in OpenSceneGraph's files, and those of their vertices") {
  for (const bool with_colors : {false, true}) {
    Mesh mesh = small_cliff();
    mesh.textures.clear();
    mesh.vertices.uvs.clear();
    mesh.materials = {{.name = "red", .base_color = {0.8F, 0.2F, 0.0F, 1.0F}},
                      {.name = "blue", .base_color = {0.0F, 0.4F, 1.0F, 1.0F}}};
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) mesh.face_materials[f] = f < mesh.triangle_count() / 2 ? 0 : 1;
    if (with_colors) mesh.vertices.colors.assign(mesh.vertex_count(), glm::u8vec4{128, 128, 128, 255});
    const fs::path folder = scratch_folder("osgb_plain");
    REQUIRE(write_outcrop(mesh, folder, {.pyramid = {.tile_bytes = 100'000}}));
    turn_into_osgb(folder);
    const auto pyramid = TilePyramid::open(folder / "osgb/main.osgb");
    if (!pyramid) FAIL(to_line(pyramid.error()));
    bool red = false;
    bool blue = false;
    for (NodeId n = 0; n < (*pyramid)->graph().nodes.size(); ++n) {
      const auto tile = (*pyramid)->load(n);
      REQUIRE(tile);
      for (FaceId f = 0; f < tile->triangle_count(); ++f) {
        glm::vec4 color = tile->materials[tile->face_material(f)].base_color;
        if (with_colors) color *= glm::vec4{tile->vertices.colors[tile->indices[3 * std::size_t{f}]]} / 255.0F;
        const float light = with_colors ? 128.0F / 255.0F : 1.0F;
        const auto is = [&](const glm::vec3& wanted) {
          return glm::distance(glm::vec3{color}, light * wanted) < 0.01F;
        };
        const bool known = is({0.8F, 0.2F, 0.0F}) || is({0.0F, 0.4F, 1.0F});
        if (!known) FAIL("a face has another colour");
        red = red || is({0.8F, 0.2F, 0.0F});
        blue = blue || is({0.0F, 0.4F, 1.0F});
      }
    }
    CHECK((red && blue));
  }
}

TEST_CASE("OpenSceneGraph's ranges give back the errors that they were made from") {
  for (const double radius_m : {0.5, 20.0, 3000.0}) {
    for (const double error_m : {1e-3, 0.05, 2.0}) {
      const double px = double(osgb::threshold_px(radius_m, error_m));
      CHECK(osgb::error_at_size_m(radius_m, px) == Approx(error_m).margin(1e-9 * radius_m));
      CHECK(osgb::error_at_distance_m(radius_m, radius_m + error_m * osgb::focal_px()) == Approx(error_m));
    }
  }
}

}  // namespace lodestone::test
