// SPDX-License-Identifier: MIT
#include <lodestone/terrain_files.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <map>

#include "data.h"
#include "heights.h"

using namespace lodestone;
using lodestone::test::FormulaHeights;
namespace fs = std::filesystem;

namespace {

TerrainTile some_tile(double sea_level_m = NAN, const TileId& id = {1, 2, 1}) {
  static const FormulaHeights source{test::ranges_m, {-180.0, -90.0, 180.0, 90.0}, 1};
  const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {200.0}, .sea_level_m = sea_level_m});
  REQUIRE(pyramid.ok());
  auto tile = pyramid->build(id);
  REQUIRE(tile.ok());
  return *tile;
}

// Plain text, so that the test shows what is in it.
fs::path write_grid(const fs::path& folder, const std::vector<std::vector<double>>& rows, double west, double south,
                    double step) {
  const fs::path file = folder / "grid.asc";
  std::ofstream out{file};
  out << "ncols " << rows[0].size() << "\nnrows " << rows.size() << "\nxllcenter " << west << "\nyllcenter " << south
      << "\ncellsize " << step << "\nNODATA_value -9999\n";
  for (const auto& row : rows) {
    for (const double value : row) out << value << ' ';
    out << '\n';
  }
  return file;
}

std::map<std::string, std::string> tree(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator{folder}) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream{entry.path(), std::ios::binary};
    files[fs::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>{stream}, {}};
  }
  return files;
}

}  // namespace

TEST_CASE("a tile comes back from its bytes as it went in") {
  // North and south, east and west: normals are packed differently where they point south.
  const TileId id = GENERATE(TileId{1, 2, 1}, TileId{1, 3, 0}, TileId{1, 0, 0});
  const TerrainTile tile = some_tile(0.0, id);
  const std::vector<std::vector<TileRange>> below{{{4, 2, 5, 3}}, {{8, 4, 11, 7}}};
  const auto mesh = decode_quantized_mesh(encode_quantized_mesh(tile, below));
  REQUIRE(mesh.ok());
  CHECK(mesh->u == tile.u);
  CHECK(mesh->v == tile.v);
  CHECK(mesh->height == tile.height);
  CHECK(mesh->triangles == tile.triangles);
  CHECK(mesh->west == tile.west);
  CHECK(mesh->south == tile.south);
  CHECK(mesh->east == tile.east);
  CHECK(mesh->north == tile.north);
  CHECK(mesh->water == tile.water);
  CHECK(mesh->available == below);
  REQUIRE(mesh->normals.size() == tile.normals.size());
  double least = 1.0, most_m = 0.0;
  for (std::uint32_t i = 0; i < tile.vertex_count(); ++i) {
    least = std::min(least, static_cast<double>(glm::dot(mesh->normals[i], tile.normals[i])));
    most_m = std::max(most_m, std::fabs(mesh->height_m(i) - tile.height_m(i)));
  }
  CHECK(least > 0.999);
  CHECK(most_m < 1e-6);
  const auto places_m = ecef_positions_m(tile);
  for (const glm::dvec3& place_m : places_m) {
    REQUIRE(glm::distance(place_m, mesh->bounds.center) <= mesh->bounds.radius_m * 1.000001);
  }
}

TEST_CASE("where the globe hides a tile's horizon occlusion point it hides the tile, and not much earlier") {
  constexpr glm::dvec3 radii_m{6378137.0, 6378137.0, 6356752.3142451793};
  const FormulaHeights source{test::ranges_m, {10.0, 10.0, 80.0, 50.0}, 4};
  const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {400.0}});
  REQUIRE(pyramid.ok());
  // As clients ask, in units of the ellipsoid's radii.
  const auto hidden = [](const glm::dvec3& eye, const glm::dvec3& point) {
    const double beyond = glm::dot(eye, eye) - 1.0;
    const glm::dvec3 way = point - eye;
    const double along = -glm::dot(way, eye);
    return along > beyond && along * along > beyond * glm::dot(way, way);
  };
  for (const TileId& id : {TileId{2, 5, 2}, TileId{3, 9, 5}, TileId{4, 20, 11}}) {
    const auto tile = pyramid->build(id);
    REQUIRE(tile.ok());
    const auto mesh = decode_quantized_mesh(encode_quantized_mesh(*tile));
    REQUIRE(mesh.ok());
    std::vector<glm::dvec3> places;
    for (const glm::dvec3& place_m : ecef_positions_m(*tile)) {
      const glm::dvec3 scaled = place_m / radii_m;
      places.push_back(scaled * std::max(1.0, 1.0 / glm::length(scaled)));  // as if what is below the sea were on it
    }
    int both = 0, early = 0;
    for (int i = 0; i < 400; ++i) {
      const double z = -1.0 + (i + 0.5) / 200.0, around = 2.399963 * i, out = 1.0 + 0.002 * (1 << i % 10);
      const glm::dvec3 eye =
          out * glm::dvec3{std::sqrt(1.0 - z * z) * std::cos(around), std::sqrt(1.0 - z * z) * std::sin(around), z};
      const bool all = std::all_of(places.begin(), places.end(), [&](const auto& p) { return hidden(eye, p); });
      const bool point = hidden(eye, mesh->horizon_occlusion_point);
      if (point) CHECK(all);
      both += point && all ? 1 : 0;
      early += all && !point ? 1 : 0;
    }
    CHECK(both > 100);
    CHECK(early < both / 4);
  }
}

TEST_CASE("every cut of a tile is refused, and changed bytes never give indices out of range") {
  const TerrainTile tile = some_tile();
  const auto bytes = encode_quantized_mesh(tile);
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 40) {
    const bool whole_but_normals = length == bytes.size() - tile.normals.size() * 2 - 5;
    if (!whole_but_normals) CHECK_FALSE(decode_quantized_mesh({bytes.data(), length}).ok());
  }
  auto changed = bytes;
  for (std::size_t i = 88; i < bytes.size(); i += 1 + bytes.size() / 300) {
    changed[i] = static_cast<std::uint8_t>(changed[i] ^ 0xa5U);
    const auto mesh = decode_quantized_mesh(changed);
    if (mesh.ok())
      CHECK(std::all_of(mesh->triangles.begin(), mesh->triangles.end(), [&](auto v) { return v < mesh->u.size(); }));
    changed[i] = bytes[i];
  }
}

TEST_CASE("more than 65536 vertices take 32-bit indices, no fewer do") {
  for (const std::uint32_t count : {65535U, 65536U, 65537U, 67600U}) {
    TerrainTile tile;
    for (std::uint32_t i = 0; i < count; ++i) {
      tile.u.push_back(static_cast<std::uint16_t>(i % 260 * 126));
      tile.v.push_back(static_cast<std::uint16_t>(i / 260 * 126));
      tile.height.push_back(static_cast<std::uint16_t>(i % 500));
    }
    for (std::uint32_t i = 0; i + 2 < count; i += 3) tile.triangles.insert(tile.triangles.end(), {i, i + 1, i + 2});
    tile.west = {0, count - 1};
    const auto bytes = encode_quantized_mesh(tile);
    const std::size_t index_bytes = count > 65536 ? 4 : 2;
    const std::size_t before = (92 + 6 * std::size_t{count} + index_bytes - 1) / index_bytes * index_bytes;
    CHECK(bytes.size() == before + 5 * 4 + (tile.triangles.size() + 2) * index_bytes);
    const auto mesh = decode_quantized_mesh(bytes);
    REQUIRE(mesh.ok());
    CHECK(mesh->triangles == tile.triangles);
    CHECK(mesh->west == tile.west);
  }
}

TEST_CASE("available rectangles hold the tiles and no other") {
  std::vector<TileInfo> tiles;
  for (std::uint32_t y = 0; y < 6; ++y) {
    for (std::uint32_t x = 0; x < 9; ++x) {
      if ((x * 7 + y * 5) % 4 != 0 || y == 3) tiles.push_back({.x = x, .y = y});
    }
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (const TileRange& range : available_ranges(tiles)) {
    for (std::uint32_t y = range.start_y; y <= range.end_y; ++y) {
      for (std::uint32_t x = range.start_x; x <= range.end_x; ++x) ++count[{x, y}];
    }
  }
  CHECK(count.size() == tiles.size());
  for (const TileInfo& tile : tiles) CHECK(count[{tile.x, tile.y}] == 1);
}

TEST_CASE("a raster of water comes back from the bytes of a tile, and the layer names it") {
  // Two samples of water and two of land from west to east, one marked as missing; the tile ends between them.
  const fs::path folder = test::scratch_folder("water");
  const auto water = open_raster(write_grid(folder, {{1, 1, 0, 0}, {1, 1, 0, 0}, {1, 1, -9999, 0}}, 0.0, 0.0, 22.5),
                                 {.voids = Voids::Fill});
  REQUIRE(water.ok());
  const FormulaHeights source{[](double, double) { return 7.0; }, {0.0, 0.0, 90.0, 90.0}, 1};
  const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {200.0}, .water = water->get()});
  REQUIRE(pyramid.ok());
  const auto tile = pyramid->build({1, 2, 1});  // 0 to 90 degrees east and north
  REQUIRE(tile.ok());
  const auto mesh = decode_quantized_mesh(encode_quantized_mesh(*tile));
  REQUIRE(mesh.ok());
  REQUIRE(mesh->water.size() == 65536);
  // Samples lie at 0, 22.5, ... degrees, 64 posts apart: half water at post 96, none beside what is missing.
  CHECK(mesh->water[150 * 256 + 94] == 255);
  CHECK(mesh->water[150 * 256 + 97] == 0);
  CHECK(mesh->water[255 * 256 + 60] == 255);
  CHECK(mesh->water[255 * 256 + 66] == 0);
  REQUIRE(write_terrain(*pyramid, folder / "tiles", {}).ok());
  CHECK(tree(folder / "tiles").at("layer.json").find("\"watermask\"") != std::string::npos);
}

TEST_CASE("posts are linear between samples; voids are skipped, filled or interpolated before scaling") {
  const fs::path folder = test::scratch_folder("raster");
  // Samples 45 / 64 degrees apart: the posts of zoom 0.
  const double step = 0.703125;
  const fs::path file = write_grid(folder, {{10, 20, 30, 40}, {11, 21, -9999, 41}, {12, 22, 32, 42}}, 0.0, 0.0, step);
  const auto posts = [&](const RasterOptions& options, std::uint32_t zoom = 0, std::int64_t column = 256,
                         std::int64_t row = 128) {
    const auto source = open_raster(file, options);
    REQUIRE(source.ok());
    std::vector<float> heights(4);
    REQUIRE((*source)->read({zoom, column, row, 4, 1}, heights).ok());
    return heights;
  };
  CHECK(posts({}) == std::vector<float>{12, 22, 32, 42});
  CHECK(posts({.scale = 2.0, .offset_m = 1.0}) == std::vector<float>{25, 45, 65, 85});
  const auto between = posts({}, 1, 512, 256);
  CHECK(between == std::vector<float>{12, 17, 22, 27});
  const auto skipped = posts({}, 0, 256, 129);
  CHECK(skipped[1] == 21.0F);
  CHECK(std::isnan(skipped[2]));
  const auto filled = posts({.voids = Voids::Fill, .fill_m = -3.0, .scale = 10.0}, 0, 257, 129);
  CHECK(filled == std::vector<float>{210, -3, 410, -3});
  const auto interpolated = posts({.voids = Voids::Interpolate}, 0, 256, 129);
  CHECK(interpolated[2] == Approx(31.0).margin(0.5));
}

TEST_CASE("a raster around the globe is closed behind its last column") {
  const fs::path folder = test::scratch_folder("around");
  std::vector<std::vector<double>> rows(3);
  for (auto& row : rows) {
    for (int i = 0; i < 8; ++i) row.push_back(i);
  }
  const fs::path file = write_grid(folder, rows, 0.0, -45.0, 45.0);
  const auto source = open_raster(file, {});
  REQUIRE(source.ok());
  std::vector<float> heights(3);
  // 292.5, 315 and 337.5 degrees east.
  REQUIRE((*source)->read({2, 640 - 32, 512, 3, 1}, heights).ok());
  const auto at = [&](double longitude_deg) {
    std::vector<float> one(1);
    REQUIRE(
        (*source)->read({2, static_cast<std::int64_t>((longitude_deg + 180.0) / 180.0 * 1024.0), 512, 1, 1}, one).ok());
    return one[0];
  };
  CHECK(at(0.0) == 0.0F);
  CHECK(at(-45.0) == 7.0F);
  CHECK(at(-22.5) == 3.5F);  // between the last column and the first
  CHECK(at(22.5) == 0.5F);
  CHECK(at(180.0) == 4.0F);
}

TEST_CASE("a void on a raster around the globe is filled alike whichever window asks for it") {
  const fs::path folder = test::scratch_folder("around_voids");
  // A void at the seam, one at the antimeridian, one between; samples at the posts of zoom 0.
  constexpr double step = 0.703125;
  constexpr int columns = 512, rows = 5;
  std::vector<std::vector<double>> samples(rows);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const bool missing = j == 2 && (i < 3 || i > 508 || (i > 254 && i < 259) || i == 300);
      samples[static_cast<std::size_t>(j)].push_back(missing ? -9999.0 : (i * 37 + j * 11) % 101);
    }
  }
  const auto source = open_raster(write_grid(folder, samples, 0.0, 0.0, step), {.voids = Voids::Interpolate});
  REQUIRE(source.ok());
  const auto read = [&](std::int64_t column, std::uint32_t width) {
    std::vector<float> heights(width);
    REQUIRE((*source)->read({0, column, 130, width, 1}, heights).ok());
    return heights;
  };
  const std::vector<float> whole = read(0, columns);
  for (const std::int64_t middle : {0, 44, 256, 511}) {
    for (std::int64_t at = middle - 5; at <= middle + 5; ++at) {
      const float expected = whole[static_cast<std::size_t>((at + columns) % columns)];
      CHECK(expected >= 0.0F);
      CHECK(read(at, 1)[0] == expected);
      CHECK(read(at - 2, 3)[2] == expected);
      CHECK(read(at, 40)[0] == expected);
    }
  }
}

TEST_CASE("a projected raster lies where its projection says, voids left out without cliffs at their rims") {
  const fs::path folder = test::scratch_folder("projected");
  // A plane over longitude, in Mercator's metres; one void.
  constexpr double radius_m = 6378137.0, degree = 0.017453292519943295, step_m = 20000.0;
  constexpr int columns = 60, rows = 50;
  std::vector<std::vector<double>> samples(rows);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const bool hole = i > 20 && i < 30 && j > 20 && j < 26;
      samples[static_cast<std::size_t>(j)].push_back(hole ? -9999.0
                                                          : 1000.0 + 100.0 * (i * step_m / radius_m / degree));
    }
  }
  const double south_m = 5000000.0, north_m = south_m + (rows - 1) * step_m;
  const fs::path file = write_grid(folder, samples, 0.0, south_m, step_m);
  std::ofstream{folder / "grid.prj"}
      << R"(PROJCS["Mercator",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,0]],)"
      << R"(PRIMEM["Greenwich",0],UNIT["degree",0.017453292519943295]],PROJECTION["Mercator_1SP"],)"
      << R"(PARAMETER["central_meridian",0],PARAMETER["scale_factor",1],PARAMETER["false_easting",0],)"
      << R"(PARAMETER["false_northing",0],UNIT["metre",1]])";
  const auto source = open_raster(file, {.scale = 2.0});
  REQUIRE(source.ok());
  const auto latitude_deg = [&](double y_m) {
    return (2.0 * std::atan(std::exp(y_m / radius_m)) - 0.5 * 3.14159265358979) / degree;
  };
  CHECK((*source)->bounds().south_deg == Approx(latitude_deg(south_m - 0.5 * step_m)).margin(0.3));
  CHECK((*source)->bounds().north_deg == Approx(latitude_deg(north_m + 0.5 * step_m)).margin(0.3));
  constexpr std::uint32_t zoom = 3;
  const auto first_row = static_cast<std::int64_t>((latitude_deg(south_m) + 90.0) / 180.0 * 2048.0) + 4;
  std::vector<float> heights(std::size_t{100} * 60);
  REQUIRE((*source)->read({zoom, 2048 + 2, first_row, 100, 60}, heights).ok());
  std::size_t voids = 0;
  for (std::size_t k = 0; k < heights.size(); ++k) {
    const double longitude = post_longitude_deg(zoom, 2050 + static_cast<std::int64_t>(k % 100));
    if (std::isnan(heights[k])) {
      ++voids;
      CHECK(std::fabs(longitude - 25.0 * step_m / radius_m / degree) < 1.2);
    } else {
      CHECK(heights[k] == Approx(2.0 * (1000.0 + 100.0 * longitude)).margin(5.0));
    }
  }
  CHECK(voids > 50);
  CHECK(voids < 900);
}

TEST_CASE("tiles list the tiles below them, and these are there") {
  const FormulaHeights source{[](double east, double) { return 100.0 * east; }, {10.0, 40.0, 34.0, 51.0}, 4};
  const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {500.0}});
  REQUIRE(pyramid.ok());
  const fs::path folder = test::scratch_folder("metadata");
  REQUIRE(write_terrain(*pyramid, folder, {.metadata_zooms = 2}).ok());
  const auto files = tree(folder);
  std::size_t named = 0;
  for (const auto& [name, bytes] : files) {
    if (name.find(".terrain") == std::string::npos) continue;
    const auto mesh = decode_quantized_mesh({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    REQUIRE(mesh.ok());
    const std::uint32_t zoom = static_cast<std::uint32_t>(name[0] - '0');
    if (zoom % 2 != 0) CHECK(mesh->available.empty());
    for (std::size_t below = 0; below < mesh->available.size(); ++below) {
      for (const TileRange& range : mesh->available[below]) {
        for (std::uint32_t x = range.start_x; x <= range.end_x; ++x) {
          for (std::uint32_t y = range.start_y; y <= range.end_y; ++y, ++named) {
            const std::string child =
                std::to_string(zoom + 1 + below) + "/" + std::to_string(x) + "/" + std::to_string(y) + ".terrain";
            CHECK(files.count(child) == 1);
          }
        }
      }
    }
  }
  // Each but the two roots, once: zooms 1 and 2 by zoom 0, 3 and 4 by zoom 2.
  CHECK(named == pyramid->tile_count() - 2);
  CHECK(files.at("layer.json").find("\"metadataAvailability\": 2") != std::string::npos);
}

TEST_CASE("what is no raster of heights is refused with a reason") {
  const fs::path folder = test::scratch_folder("refused");
  CHECK(open_raster(folder / "nothing.tif", {}).error().code == ErrorCode::NotFound);
  std::ofstream{folder / "text.tif"} << "this is no raster";
  CHECK(open_raster(folder / "text.tif", {}).error().code == ErrorCode::BadData);
  const fs::path far = write_grid(folder, {{1, 2}, {3, 4}}, 500000.0, 4000000.0, 30.0);
  const auto metres = open_raster(far, {});
  REQUIRE_FALSE(metres.ok());
  CHECK(metres.error().message.find("degrees") != std::string::npos);
}

TEST_CASE("a pyramid on disk is the same for any number of workers, and is resumed to the same bytes") {
  const FormulaHeights source{test::ranges_m, {10.0, 40.0, 21.0, 51.0}, 4};
  const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {40.0}});
  REQUIRE(pyramid.ok());
  const fs::path folder = test::scratch_folder("written");
  const auto first = write_terrain(*pyramid, folder / "one", {}, {.max_workers = 1});
  REQUIRE(first.ok());
  CHECK(first->cracks == 0);
  CHECK(first->tiles == pyramid->tile_count());
  const auto expected = tree(folder / "one");
  CHECK(expected.size() == first->tiles + 2);
  REQUIRE(write_terrain(*pyramid, folder / "eight", {}, {.max_workers = 8}).ok());
  CHECK((tree(folder / "eight") == expected));

  // As a killed run leaves it: tiles missing, one half renamed, the journal's last line cut.
  fs::remove(folder / "eight" / "layer.json");
  fs::rename(folder / "eight" / "lodestone-terrain.txt", folder / "eight" / "lodestone-terrain.unfinished");
  fs::resize_file(folder / "eight" / "lodestone-terrain.unfinished",
                  fs::file_size(folder / "eight" / "lodestone-terrain.unfinished") - 200);
  fs::remove(folder / "eight" / "0" / "1" / "0.terrain");
  std::ofstream{folder / "eight" / "0" / "1" / "0.terrain.part17-3"} << "half";
  CHECK(write_terrain(*pyramid, folder / "eight", {}).error().code == ErrorCode::BadArgument);
  const auto resumed = write_terrain(*pyramid, folder / "eight", {.resume = true});
  REQUIRE(resumed.ok());
  CHECK(resumed->kept_tiles > 0);
  CHECK(resumed->kept_tiles < resumed->tiles);
  CHECK((tree(folder / "eight") == expected));

  // Cut within the last number of the first tile's line, which then reads as another number.
  const std::string& manifest = expected.at("lodestone-terrain.txt");
  fs::remove(folder / "eight" / "lodestone-terrain.txt");
  std::ofstream{folder / "eight" / "lodestone-terrain.unfinished"}
      << manifest.substr(0, manifest.find('\n', manifest.find('\n') + 1) - 5);
  REQUIRE(write_terrain(*pyramid, folder / "eight", {.resume = true}).ok());
  CHECK((tree(folder / "eight") == expected));

  const auto other = TerrainPyramid::plan(source, {.max_error_m = {41.0}});
  CHECK(write_terrain(*other, folder / "eight", {.resume = true}).error().code == ErrorCode::BadArgument);
  std::ofstream{folder / "mine.txt"} << "not terrain";
  CHECK(write_terrain(*pyramid, folder, {}).error().code == ErrorCode::BadArgument);
}
