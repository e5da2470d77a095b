// SPDX-License-Identifier: MIT
// What must hold of every building there is: generated, surveyed, from CityGML, 3DS and IFC, and damaged.
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "blocks.h"
#include "checked_model.h"
#include "data.h"
#include "directions.h"
#include "small_house.h"

namespace lodestone {
namespace {

void check_build(const Mesh& mesh) {
  const auto built = build_by_facet_shift(mesh);
  REQUIRE(built.ok());
  test::check_model(*built->model, mesh);
  // The block, or exactly what holds it from that.
  CHECK(built->report.reached_block == built->report.block_sentence.empty());
  const Level finest = built->model->record_count();
  for (const double ratio : {0.5, 0.1, 0.02}) {
    const auto wanted = static_cast<std::uint32_t>(ratio * built->model->info(finest).triangles);
    const Level level = built->model->level_of_triangles(wanted);
    CHECK_FALSE(test::grows(mesh, built->model->extract(level), built->model->error_m(level)));
  }
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder, const std::string& extension) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder}) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST_CASE("3DS and CityGML models build exactly and reach the block or say what holds them") {
  LODESTONE_REQUIRE_DATA(root);
  std::size_t count = 0;
  for (const char* extension : {".3ds", ".xml"}) {
    for (const auto& file : files_in(root / "buildings", extension)) {
      CAPTURE(file.string());
      const auto loaded = read_mesh(file, {.textures = LoadTextures::Reference});
      REQUIRE(loaded.ok());
      if (loaded->mesh.triangle_count() > 50'000) continue;
      check_build(loaded->mesh);
      ++count;
    }
  }
  CHECK(count == 5);
}

TEST_CASE("the street and the IFC house build exactly and reach their blocks", "[.]") {
  LODESTONE_REQUIRE_DATA(root);
  for (const std::filesystem::path& file : {root / "buildings/street_all/street_all.obj",
                                            std::filesystem::path{"/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc"}}) {
    CAPTURE(file.string());
    const auto loaded = read_mesh(file, {.textures = LoadTextures::Reference});
    REQUIRE(loaded.ok());
    check_build(loaded->mesh);
  }
}

TEST_CASE("walls of generated houses stay upright and roofs keep their pitch down to a tenth of the triangles") {
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    CAPTURE(static_cast<int>(roof));
    const Mesh house = test::small_house(8000, roof);
    const CharacteristicSurfaces directions = characteristic_surfaces(house);
    const auto built = build_by_facet_shift(house);
    REQUIRE(built.ok());
    for (const double ratio : {0.5, 0.2, 0.1}) {
      CAPTURE(ratio);
      const Level level = built->model->level_of_triangles(static_cast<std::uint32_t>(ratio * house.triangle_count()));
      const Mesh shown = built->model->extract(level);
      const test::Leaning found = test::leaning(directions, shown);
      CHECK(found.walls_m2 < 2e-3 * found.area_m2);
      CHECK(found.others_m2 < 6e-3 * found.area_m2);
      CHECK_FALSE(test::grows(house, shown, built->model->error_m(level)));
    }
  }
}

// The same again wall to wall with it, so that one wall of each lies in the other's.
Mesh with_neighbour(const Mesh& house) {
  Mesh both = house;
  const VertexId first = house.vertex_count();
  const auto width = static_cast<float>(bounds(house).size().x);
  const auto repeat = [](auto& values) {
    const auto once = values;
    values.insert(values.end(), once.begin(), once.end());
  };
  repeat(both.vertices.positions);
  repeat(both.vertices.normals);
  repeat(both.vertices.uvs);
  repeat(both.vertices.colors);
  repeat(both.face_materials);
  repeat(both.face_features);
  for (VertexId v = first; v < both.vertex_count(); ++v) both.vertices.positions[v].x += width;
  for (std::size_t c = 0; c < house.indices.size(); ++c) both.indices.push_back(first + house.indices[c]);
  return both;
}

// Faces of one side or at random go, so that the shell is open.
void open_up(Mesh& mesh, std::mt19937& random) {
  Mesh rest = mesh;
  rest.indices.clear();
  rest.face_materials.clear();
  rest.face_features.clear();
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    if (random() % 4 == 0) continue;
    for (std::uint32_t k = 0; k < 3; ++k) rest.indices.push_back(mesh.indices[3 * std::size_t{f} + k]);
    if (!mesh.face_materials.empty()) rest.face_materials.push_back(mesh.face_materials[f]);
    if (!mesh.face_features.empty()) rest.face_features.push_back(mesh.face_features[f]);
  }
  mesh = std::move(rest);
}

TEST_CASE("open shells, houses inside out, coincident and touching walls of neighbours give a valid model") {
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    CAPTURE(seed);
    std::mt19937 random{seed};
    const Mesh house = test::small_house(2000, static_cast<Roof>(seed % 4));
    Mesh inside_out = house;
    for (std::size_t c = 0; c < inside_out.indices.size(); c += 3)
      std::swap(inside_out.indices[c], inside_out.indices[c + 1]);
    check_build(inside_out);
    Mesh half = house;
    for (std::size_t c = 0; c < half.indices.size(); c += 3) {
      if (random() % 2 == 0) std::swap(half.indices[c], half.indices[c + 1]);
    }
    check_build(half);
    Mesh open = house;
    open_up(open, random);
    check_build(open);
    Mesh row = with_neighbour(house);
    check_build(row);
    open_up(row, random);
    check_build(row);
    // The same house twice in one place.
    Mesh twice = house;
    twice.indices.insert(twice.indices.end(), house.indices.begin(), house.indices.end());
    twice.face_materials.insert(twice.face_materials.end(), house.face_materials.begin(), house.face_materials.end());
    twice.face_features.insert(twice.face_features.end(), house.face_features.begin(), house.face_features.end());
    check_build(twice);
  }
}

}  // namespace
}  // namespace lodestone
