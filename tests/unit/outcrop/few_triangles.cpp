// SPDX-License-Identifier: MIT
// Tiles with next to nothing in them.
#include <algorithm>
#include <cmath>

#include <lodestone/edge_collapse.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "data.h"
#include "fixture.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

// Two triangles in the middle of the cliff shown by a photograph of their own.
Mesh cliff_with_a_speck() {
  Mesh mesh = small_cliff();
  mesh.textures.push_back(mesh.textures.front());
  mesh.textures.back().name = "speck";
  mesh.materials.push_back(mesh.materials.front());
  mesh.materials.back().texture = static_cast<std::uint32_t>(mesh.textures.size() - 1);
  const FaceId middle = mesh.triangle_count() / 2;
  for (const FaceId f : {middle, middle + 1})
    mesh.face_materials[f] = static_cast<MaterialId>(mesh.materials.size() - 1);
  return mesh;
}

// Single triangles here and there, all of one photograph.
Mesh cliff_with_confetti() {
  Mesh mesh = cliff_with_a_speck();
  constexpr FaceId step = 3989;
  const auto speck = static_cast<MaterialId>(mesh.materials.size() - 1);
  for (FaceId f = step / 2; f < mesh.triangle_count(); f += step) mesh.face_materials[f] = speck;
  return mesh;
}

// Faces without area, in every material, whose corners lie at the other end of the cliff; `more` adds an image that
// nothing else shows.
Mesh with_flat_faces(Mesh mesh, bool more) {
  const std::vector<VertexId> far = {mesh.indices.front(), mesh.indices.back()};
  if (more) {
    mesh.textures.push_back(mesh.textures.front());
    mesh.textures.back().name = "flat";
    mesh.materials.push_back(mesh.materials.front());
    mesh.materials.back().texture = static_cast<std::uint32_t>(mesh.textures.size() - 1);
  }
  for (MaterialId m = 0; m < mesh.materials.size(); ++m) {
    for (const VertexId v : far) {
      for (int i = 0; i < 20; ++i) {
        mesh.indices.insert(mesh.indices.end(), {v, v, far.front()});
        mesh.face_materials.push_back(m);
        if (!mesh.face_features.empty()) mesh.face_features.push_back(mesh.face_features.front());
      }
    }
  }
  return mesh;
}

void check_every_tile(const OutcropPyramid& pyramid, const Mesh& source) {
  CHECK(pyramid.levels().front().triangles == source.triangle_count());
  for (std::uint32_t i = 0; i < pyramid.tiles().size(); ++i) {
    const OutcropTile& tile = pyramid.tiles()[i];
    CHECK(tile.triangles > 0);
    if (tile.level > 0) CHECK(tile.error_m >= tile.gap_m);
    if (tile.parent != none) CHECK(tile.error_m < pyramid.tiles()[tile.parent].error_m);
  }
}

void check_written(const Mesh& mesh, const OutcropOptions& options) {
  const auto folder = scratch_folder("outcrop_few_triangles") / "tiles";
  const auto written = write_outcrop(mesh, folder, {.pyramid = options});
  REQUIRE(written);
  const auto check = check_tileset(folder / "tileset.json");
  if (!check) FAIL(to_line(check.error()));
  CHECK(check->faults.empty());
  CHECK(check->seams_open == 0);
  CHECK(check->triangles == mesh.triangle_count());
}

}  // namespace

TEST_CASE("No tile loses its last triangle, however few it has or how long its texture lasts") {
  const Mesh speck = cliff_with_a_speck();
  const OutcropOptions slow{.ratio = 0.3, .texture_ratio = 0.9, .tile_bytes = 24'000};
  for (const OutcropOptions& options : {OutcropOptions{}, small_tiles(), slow}) {
    const auto one = pyramid_of(speck, options);
    check_every_tile(*one, speck);
    CHECK(one->tiles().size() == pyramid_of(speck, options, 8)->tiles().size());
  }
  check_written(speck, {});
  check_written(speck, slow);
}

TEST_CASE("A photograph of which single triangles show here and there leaves errors as they are") {
  const auto plain = pyramid_of(small_cliff(), small_tiles());
  const auto confetti = pyramid_of(cliff_with_confetti(), small_tiles());
  check_every_tile(*confetti, small_cliff());
  CHECK(confetti->tiles().back().error_m < 3.0 * plain->tiles().back().error_m);
  CHECK(confetti->tiles().back().error_m < 0.1 * confetti->tiles().back().bounds.diagonal_m());
}

TEST_CASE("However triangles and textures are asked to shrink, a level is more than a handful of triangles") {
  const auto pyramid = pyramid_of(small_cliff(), {.ratio = 0.1, .texture_ratio = 0.9, .tile_bytes = 8'000});
  REQUIRE(pyramid->levels().size() > 3);
  CHECK(pyramid->levels().back().triangles >= 60);
  CHECK(pyramid->levels().back().triangles <= 70);
}

TEST_CASE("Where textures shrink slowly, triangles last as long as they do") {
  const auto pyramid = pyramid_of(small_cliff(), {.texture_ratio = 0.9, .tile_bytes = 24'000});
  check_every_tile(*pyramid, small_cliff());
  REQUIRE(pyramid->levels().size() > 4);
  for (const OutcropLevel& level : pyramid->levels()) {
    const double halvings = -std::log2(level.texture_scale);
    CHECK(level.triangles >= 0.99 * std::pow(0.2, halvings) * small_cliff().triangle_count());
  }
}

TEST_CASE("Faces without area lie in the finest level, leave errors as they are and make no tile of their own") {
  const auto plain = pyramid_of(small_cliff(), small_tiles());
  for (const bool more : {false, true}) {
    const Mesh mesh = with_flat_faces(small_cliff(), more);
    const auto pyramid = pyramid_of(mesh, small_tiles());
    check_every_tile(*pyramid, mesh);
    CHECK(pyramid->tiles().back().error_m < 1.5 * plain->tiles().back().error_m);
    CHECK(pyramid->levels()[1].geometric_error_m < 1.5 * plain->levels()[1].geometric_error_m);
    check_written(mesh, small_tiles());
  }
}

TEST_CASE("An outcrop of faces without area alone is refused before anything is written") {
  Mesh mesh = small_cliff();
  for (std::size_t c = 0; c < mesh.indices.size(); ++c) mesh.indices[c] = mesh.indices[c - c % 3];
  const auto folder = scratch_folder("outcrop_flat") / "tiles";
  const auto written = write_outcrop(mesh, folder, {});
  REQUIRE(!written);
  CHECK(written.error().code == ErrorCode::BadData);
  CHECK(!std::filesystem::exists(folder));
  CHECK(OutcropPyramid::build(mesh, texture_sizes(mesh)).error().code == ErrorCode::BadData);
}

TEST_CASE("A group of materials keeps its last triangle when all else collapses") {
  Mesh mesh = grid(20, 20);
  mesh.materials.assign(3, Material{.name = "rock"});
  mesh.face_materials.assign(mesh.triangle_count(), 0);
  mesh.face_materials[400] = 1;
  mesh.face_materials[10] = 2;
  EdgeCollapseOptions options{.target_triangles = 1, .material_groups = {0, 1, 0}};
  const auto kept = simplify(mesh, options);
  REQUIRE(kept);
  const auto count = [&](MaterialId m) {
    return std::count(kept->mesh.face_materials.begin(), kept->mesh.face_materials.end(), m);
  };
  CHECK(count(1) >= 1);
  CHECK(count(0) + count(2) >= 1);
  CHECK(kept->mesh.triangle_count() < 20);
  options.material_groups = {0, 1};
  CHECK(simplify(mesh, options).error().code == ErrorCode::BadArgument);
}

}  // namespace lodestone::test
