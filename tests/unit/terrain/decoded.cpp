// SPDX-License-Identifier: MIT
// What clients decode, held against the posts that tiles were made from.
#include <lodestone/terrain_files.h>

#include <catch2/catch.hpp>

#include "client_view.h"
#include "data.h"
#include "heights.h"

using namespace lodestone;
using lodestone::test::FormulaHeights;

namespace {

constexpr GeoBox globe{-180.0, -90.0, 180.0, 90.0};

double farthest_from_ellipsoid_m(const TerrainTile& tile) {
  const auto places_m = ecef_positions_m(tile);
  double most_m = 0.0;
  for (std::size_t t = 0; t < tile.triangles.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {  // middles of edges
      const glm::dvec3 p = 0.5 * (places_m[tile.triangles[t + k]] + places_m[tile.triangles[t + (k + 1) % 3]]);
      const double scale =
          std::sqrt((p.x * p.x + p.y * p.y) / (6378137.0 * 6378137.0) + p.z * p.z / (6356752.3 * 6356752.3));
      most_m = std::max(most_m, glm::length(p) * (1.0 / scale - 1.0));
    }
  }
  return most_m;
}

}  // namespace

TEST_CASE("decoded, every tile of a world is within the tolerance of its posts and meets its neighbours") {
  const TerrainMethod method = GENERATE(TerrainMethod::Greedy, TerrainMethod::EdgeCollapse);
  const FormulaHeights source{test::ranges_m, globe, 1};
  const auto pyramid = TerrainPyramid::plan(source, {.method = method, .max_error_m = {100.0}});
  REQUIRE(pyramid.ok());
  const auto tiles = test::client_tiles(*pyramid);
  REQUIRE(tiles.size() == 2 + 8);
  test::check_client_errors(*pyramid, tiles, true);
  // Around the globe as well: as many borders eastwards as tiles.
  CHECK(test::check_client_borders(tiles) == 2 + 8 + 4);
}

TEST_CASE("decoded, tiles with voids are within the tolerance and nowhere without data") {
  const TerrainMethod method = GENERATE(TerrainMethod::Greedy, TerrainMethod::EdgeCollapse);
  const auto holed = [](double longitude, double latitude) {
    const bool hole =
        std::hypot(longitude - 14.0, latitude - 50.0) < 2.0 ||
        (mix64(static_cast<std::uint64_t>(longitude * 7.0) * 1000 + static_cast<std::uint64_t>(latitude * 7.0)) % 9 ==
         0);
    return hole ? static_cast<double>(NAN) : test::ranges_m(longitude, latitude);
  };
  const FormulaHeights source{holed, {5.0, 46.0, 19.0, 55.0}, 4};
  const auto pyramid = TerrainPyramid::plan(source, {.method = method, .max_error_m = {30.0}});
  REQUIRE(pyramid.ok());
  const auto tiles = test::client_tiles(*pyramid);
  test::check_client_errors(*pyramid, tiles, false);
  // No spike: heights at rims are within those of the data.
  for (const auto& [key, tile] : tiles) {
    if (tile.placeholder) continue;
    const auto posts_m = pyramid->posts(tile.id);
    float low_m = 1e9F, high_m = -1e9F;
    for (const float height_m : *posts_m) {
      if (height_m < low_m) low_m = height_m;
      if (height_m > high_m) high_m = height_m;
    }
    const double limit_m = pyramid->tolerance_m(tile.id.zoom) + pyramid->height_step_m(tile.id.zoom);
    for (std::uint32_t i = 0; i < tile.mesh.u.size(); ++i) {
      REQUIRE(tile.mesh.height_m(i) >= low_m - limit_m);
      REQUIRE(tile.mesh.height_m(i) <= high_m + limit_m);
    }
  }
}

TEST_CASE("a globe without relief stays round: within the tolerance, or as fine as asked") {
  const FormulaHeights source{[](double, double) { return 0.0; }, globe, 2};
  const auto round = TerrainPyramid::plan(source, {.max_error_m = {4000.0}});
  const auto asked = TerrainPyramid::plan(source, {.max_error_m = {1e6}, .grid_divisions = {16, 2, 1}});
  REQUIRE(round.ok());
  REQUIRE(asked.ok());
  for (const std::uint32_t zoom : {0U, 1U, 2U}) {
    const auto tile = round->build({zoom, 1, 0});
    REQUIRE(tile.ok());
    // Cells are squares of the chord that the tolerance allows, their diagonals twice as far.
    CHECK(farthest_from_ellipsoid_m(*tile) <= 2.0 * round->tolerance_m(zoom));
    CHECK(asked->build({zoom, 1, 0})->triangle_count() == 2U * std::array{16U * 16U, 2U * 2U, 1U}[zoom]);
  }
  CHECK(round->build({0, 1, 0})->triangle_count() > round->build({2, 1, 0})->triangle_count());
}

TEST_CASE("decoded, real heights are within the tolerance on every tile and meet their neighbours") {
  LODESTONE_REQUIRE_DATA(root);
  const TerrainMethod method = GENERATE(TerrainMethod::Greedy, TerrainMethod::EdgeCollapse);
  const auto source = open_raster(root / "terrain" / "srtm3_N30E079_1201.tif", {});
  REQUIRE(source.ok());
  CHECK((*source)->native_zoom() == 10);
  const auto pyramid = TerrainPyramid::plan(**source, {.method = method, .max_error_m = {20.0}});
  REQUIRE(pyramid.ok());
  const auto tiles = test::client_tiles(*pyramid);
  CHECK(tiles.size() == 82);
  test::check_client_errors(*pyramid, tiles, false);
}

TEST_CASE("decoded, trenches and shelves of the whole world are within a tolerance far below what a post is wide") {
  LODESTONE_REQUIRE_DATA(root);
  const auto source = open_raster(root / "terrain" / "etopo5_4320x2161_i16.tif", {});
  REQUIRE(source.ok());
  const auto pyramid = TerrainPyramid::plan(**source, {.max_error_m = {5.0}, .max_zoom = 1});
  REQUIRE(pyramid.ok());
  const auto tiles = test::client_tiles(*pyramid);
  test::check_client_errors(*pyramid, tiles, true);
  CHECK(test::check_client_borders(tiles) == 2 + 8 + 4);
}
