// SPDX-License-Identifier: MIT
#include <lodestone/terrain_files.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <mutex>
#include <set>
#include <tuple>

#include "data.h"
#include "heights.h"

using namespace lodestone;
using lodestone::test::FormulaHeights;

namespace {

using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // zoom, y, x
using Tiles = std::map<Key, TerrainTile>;

Tiles build_all(const TerrainPyramid& pyramid, unsigned workers = 2, bool backwards = false) {
  std::vector<TileId> ids = pyramid.all_tiles();
  if (backwards) std::reverse(ids.begin(), ids.end());
  Tiles tiles;
  std::mutex mutex;
  const Status status = pyramid.build(ids,
                                      [&](const TerrainTile& tile) -> Status {
                                        const std::lock_guard lock{mutex};
                                        tiles.emplace(Key{tile.id.zoom, tile.id.y, tile.id.x}, tile);
                                        return Done{};
                                      },
                                      {.max_workers = workers});
  REQUIRE(status.ok());
  return tiles;
}

template <class T>
std::uint64_t hash_of(const std::vector<T>& values) {
  std::uint64_t hash = values.size();
  for (const T& value : values) hash = hash_combine(hash, static_cast<std::uint64_t>(value));
  return hash;
}

std::uint64_t hash_of(const Tiles& tiles) {
  std::uint64_t hash = 0;
  for (const auto& [key, tile] : tiles) {
    for (const std::uint64_t part :
         {hash_of(tile.u), hash_of(tile.v), hash_of(tile.height), hash_of(tile.triangles),
          std::bit_cast<std::uint64_t>(tile.min_height_m), std::bit_cast<std::uint64_t>(tile.step_m)}) {
      hash = hash_combine(hash, part);
    }
    for (const glm::vec3& n : tile.normals) hash = hash_combine(hash, position_hash(n));
  }
  return hash;
}

// Edges of triangles along a border, by the place where they begin; heights and normals of both ends.
struct BorderEdge {
  int begin = 0, end = 0;
  double begin_m = 0.0, end_m = 0.0;
  glm::vec3 begin_normal{0.0F}, end_normal{0.0F};
  friend bool operator==(const BorderEdge&, const BorderEdge&) = default;
};

std::vector<BorderEdge> border_of(const TerrainTile& tile, const std::vector<std::uint32_t>& ids,
                                  const std::vector<std::uint16_t>& key) {
  std::vector<std::uint8_t> on_border(tile.vertex_count());
  for (const std::uint32_t i : ids) on_border[i] = 1;
  std::vector<BorderEdge> edges;
  for (std::size_t e = 0; e < tile.triangles.size(); ++e) {
    std::uint32_t a = tile.triangles[e], b = tile.triangles[e % 3 == 2 ? e - 2 : e + 1];
    if (on_border[a] == 0 || on_border[b] == 0) continue;
    if (key[a] > key[b]) std::swap(a, b);
    edges.push_back({key[a], key[b], tile.height_m(a), tile.height_m(b), tile.normals[a], tile.normals[b]});
  }
  std::sort(edges.begin(), edges.end(), [](const BorderEdge& a, const BorderEdge& b) { return a.begin < b.begin; });
  return edges;
}

// How many edges of one side meet something else than themselves on the other. Where one side has no triangle there is
// nothing to meet.
int mismatches(const std::vector<BorderEdge>& mine, const std::vector<BorderEdge>& theirs) {
  int count = 0;
  for (const BorderEdge& edge : mine) {
    for (const BorderEdge& other : theirs) {
      if (other.begin < edge.end && edge.begin < other.end && !(other == edge)) ++count;
    }
  }
  return count;
}

// A whole globe; planned and made once.
const TerrainPyramid& world_pyramid() {
  static const FormulaHeights source{test::ranges_m, {-180.0, -90.0, 180.0, 90.0}, 2};
  static const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {100.0}});
  REQUIRE(pyramid.ok());
  return *pyramid;
}
const Tiles& world() {
  static const Tiles tiles = build_all(world_pyramid());
  return tiles;
}

void check_borders(const Tiles& tiles) {
  std::size_t borders = 0;
  for (const auto& [key, tile] : tiles) {
    const auto [zoom, y, x] = key;
    const auto east = tiles.find({zoom, y, (x + 1) % (2U << zoom)});
    if (east != tiles.end()) {
      CHECK(mismatches(border_of(tile, tile.east, tile.v),
                       border_of(east->second, east->second.west, east->second.v)) == 0);
      borders += border_of(tile, tile.east, tile.v).size();
    }
    const auto north = tiles.find({zoom, y + 1, x});
    if (north != tiles.end()) {
      CHECK(mismatches(border_of(tile, tile.north, tile.u),
                       border_of(north->second, north->second.south, north->second.u)) == 0);
    }
  }
  CHECK(borders > 100);
}

void check_tile(const TerrainTile& tile) {
  REQUIRE(tile.vertex_count() >= 3);
  std::vector<std::uint8_t> used(tile.vertex_count());
  for (std::size_t t = 0; t < tile.triangles.size(); t += 3) {
    const auto u = [&](std::size_t k) { return static_cast<int>(tile.u[tile.triangles[t + k]]); };
    const auto v = [&](std::size_t k) { return static_cast<int>(tile.v[tile.triangles[t + k]]); };
    REQUIRE((u(1) - u(0)) * (v(2) - v(0)) - (v(1) - v(0)) * (u(2) - u(0)) > 0);
    for (std::size_t k = 0; k < 3; ++k) used[tile.triangles[t + k]] = 1;
  }
  CHECK(std::count(used.begin(), used.end(), 0) == 0);
  for (const glm::vec3& n : tile.normals) REQUIRE(glm::length(n) == Approx(1.0).margin(1e-5));
  const auto on = [&](const std::vector<std::uint16_t>& key, int value) {
    return std::count(key.begin(), key.end(), value);
  };
  CHECK(tile.west.size() == static_cast<std::size_t>(on(tile.u, 0)));
  CHECK(tile.east.size() == static_cast<std::size_t>(on(tile.u, quantized_max)));
  CHECK(tile.south.size() == static_cast<std::size_t>(on(tile.v, 0)));
  CHECK(tile.north.size() == static_cast<std::size_t>(on(tile.v, quantized_max)));
}

}  // namespace

TEST_CASE("a world's tiles share their borders to the bit, across the antimeridian as well") { check_borders(world()); }

TEST_CASE("a world has all tiles of all zooms, each sound and within the tolerance") {
  CHECK(world().size() == 2 + 8 + 32);
  for (const auto& [key, tile] : world()) {
    check_tile(tile);
    CHECK(tile.max_error_m <= 100.0 * std::exp2(2 - static_cast<int>(tile.id.zoom)) + 0.5 * tile.snap_m);
  }
}

TEST_CASE("all vertices at a pole have one height and one place") {
  const bool north = GENERATE(false, true);
  std::vector<double> heights_m;
  for (const auto& [key, tile] : world()) {
    if (tile.id.zoom != 2 || tile.id.y != (north ? 3 : 0)) continue;
    const auto places_m = ecef_positions_m(tile);
    for (const std::uint32_t i : north ? tile.north : tile.south) {
      heights_m.push_back(tile.height_m(i));
      CHECK(std::hypot(places_m[i].x, places_m[i].y) < 1e-6);
      CHECK(tile.normals[i] == glm::vec3{0.0F, 0.0F, north ? 1.0F : -1.0F});
    }
  }
  REQUIRE(heights_m.size() > 8);
  CHECK(std::count(heights_m.begin(), heights_m.end(), heights_m.front()) ==
        static_cast<std::ptrdiff_t>(heights_m.size()));
}

TEST_CASE("tiles of every method are the same for any number of workers and any order") {
  const FormulaHeights source{test::ranges_m, {10.0, 40.0, 32.0, 61.0}, 3};
  const TerrainMethod method =
      GENERATE(TerrainMethod::Greedy, TerrainMethod::EdgeCollapse, TerrainMethod::PointsRandom,
               TerrainMethod::PointsGrid, TerrainMethod::PointsHierarchy, TerrainMethod::PointsWlop);
  const auto pyramid =
      TerrainPyramid::plan(source, {.method = method, .max_error_m = {50.0}, .points = {.iterations = 3}});
  REQUIRE(pyramid.ok());
  const std::uint64_t once = hash_of(build_all(*pyramid, 1));
  CHECK(hash_of(build_all(*pyramid, 2)) == once);
  CHECK(hash_of(build_all(*pyramid, 8, true)) == once);
}

TEST_CASE("tiles with voids leave them out and still share their borders") {
  const auto holed = [](double longitude, double latitude) {
    const double r = std::hypot(longitude - 22.5, latitude - 45.0);
    return r < 3.0 || (r > 8.0 && std::fabs(latitude - 50.0) < 0.4) ? static_cast<double>(NAN)
                                                                    : test::ranges_m(longitude, latitude);
  };
  const FormulaHeights source{holed, {5.0, 36.0, 33.0, 52.0}, 4};
  const bool points = GENERATE(false, true), shared = GENERATE(false, true);
  const TerrainOptions options{.method = points ? TerrainMethod::PointsWlop : TerrainMethod::Greedy,
                               .borders = shared ? TerrainBorders::Shared : TerrainBorders::Nested,
                               .shared_from_zoom = 1,
                               .max_error_m = {30.0},
                               .points = {.keep_ratio = {0.02}, .iterations = 5}};
  const auto pyramid = TerrainPyramid::plan(source, options);
  REQUIRE(pyramid.ok());
  const Tiles tiles = build_all(*pyramid);
  check_borders(tiles);
  for (const auto& [key, tile] : tiles) {
    check_tile(tile);
    if (!points && !shared)
      CHECK(tile.max_error_m <= 30.0 * std::exp2(4 - static_cast<int>(tile.id.zoom)) + 0.5 * tile.snap_m);
    const GeoBox box = bounds_of(tile.id);
    for (std::uint32_t i = 0; i < tile.vertex_count() && !tile.placeholder; ++i) {
      const double longitude = std::lerp(box.west_deg, box.east_deg, tile.u[i] / 32767.0);
      const double latitude = std::lerp(box.south_deg, box.north_deg, tile.v[i] / 32767.0);
      REQUIRE(std::hypot(longitude - 22.5, latitude - 45.0) > 2.99);
    }
  }
  // The way from the roots to the data is there.
  for (std::uint32_t z = 1; z <= 4; ++z) {
    for (const TileInfo& tile : pyramid->tiles(z)) CHECK(tiles.count({z - 1, tile.y / 2, tile.x / 2}) == 1);
  }
  CHECK(tiles.count({0, 0, 0}) == 1);
}

TEST_CASE("the gap between borders of unequal zooms is within the bound that the report states") {
  const auto report = write_terrain(world_pyramid(), test::scratch_folder("gaps"), {});
  REQUIRE(report.ok());
  CHECK(report->zooms[0].gap_bound_m == 0.0);
  double most_ratio = 0.0;
  for (const auto& [key, tile] : world()) {
    const auto [zoom, y, x] = key;
    if (zoom == 0) continue;
    const TerrainTile& parent = world().at({zoom - 1, y / 2, x / 2});
    if (x % 2 != 0) continue;                                 // its west border lies on the parent's
    const auto line = [](const TerrainTile& of, double at) {  // height of the west border at v
      std::size_t k = 0;
      while (k + 2 < of.west.size() && of.v[of.west[k + 1]] < at) ++k;
      const double v0 = of.v[of.west[k]], v1 = of.v[of.west[k + 1]];
      return std::lerp(of.height_m(of.west[k]), of.height_m(of.west[k + 1]), (at - v0) / (v1 - v0));
    };
    const double own_bound_m = 100.0 * (std::exp2(2 - static_cast<int>(zoom)) + std::exp2(3 - static_cast<int>(zoom))) +
                               0.5 * (tile.snap_m + parent.snap_m) + tile.border_detail_m;
    const double bound_m = report->zooms[zoom].gap_bound_m;
    CHECK(own_bound_m <= bound_m * (1.0 + 1e-12));  // which is that of the worst border
    CHECK(bound_m < 3000.0);
    for (int i = 0; i <= 4096; ++i) {
      const double v = i * 32767.0 / 4096.0;
      const double gap_m = std::fabs(line(tile, v) - line(parent, 0.5 * v + (y % 2 == 0 ? 0.0 : 0.5 * 32767.0)));
      most_ratio = std::max(most_ratio, gap_m / own_bound_m);
    }
  }
  CHECK(most_ratio <= 1.0);
  CHECK(most_ratio > 0.05);
}

TEST_CASE("shared borders are one line on all zooms: no gap between unequal zooms, none between neighbours") {
  // The second is a high plain: by themselves its coarser zooms, which may go down to 0, would have coarser steps.
  const bool plain = GENERATE(false, true);
  const auto plain_m = [](double longitude, double latitude) {
    return 8000.0 + 0.002 * test::ranges_m(longitude, latitude);
  };
  const FormulaHeights source{
      plain ? FormulaHeights::Formula{plain_m} : test::ranges_m, {-180.0, -90.0, 180.0, 90.0}, 2};
  TerrainOptions options{.max_error_m = {plain ? 0.5 : 200.0}};
  const auto nested = TerrainPyramid::plan(source, options);
  options.borders = TerrainBorders::Shared;
  const auto pyramid = TerrainPyramid::plan(source, options);
  REQUIRE(pyramid.ok());
  CHECK((nested->height_step_m(1) > nested->height_step_m(2)));
  CHECK(pyramid->height_step_m(0) == pyramid->height_step_m(2));
  CHECK(pyramid->height_step_m(1) == pyramid->height_step_m(2));
  const Tiles tiles = build_all(*pyramid);
  check_borders(tiles);
  double most_gap_m = 0.0;
  std::size_t compared = 0;
  for (const auto& [key, tile] : tiles) {
    CHECK(tile.max_error_m <= pyramid->tolerance_m(tile.id.zoom) + 0.5 * pyramid->height_step_m(tile.id.zoom));
    const auto [zoom, y, x] = key;
    if (zoom == 0) continue;
    const TerrainTile& parent = tiles.at({zoom - 1, y / 2, x / 2});
    struct Border {
      const std::vector<std::uint32_t>&mine, &above;
      bool upwards = true;
    };
    std::vector<Border> borders;
    borders.push_back(x % 2 == 0 ? Border{tile.west, parent.west, true} : Border{tile.east, parent.east, true});
    borders.push_back(y % 2 == 0 ? Border{tile.south, parent.south, false} : Border{tile.north, parent.north, false});
    for (const Border& border : borders) {
      const auto place = [&](const TerrainTile& of, std::uint32_t i) { return border.upwards ? of.v[i] : of.u[i]; };
      const bool second = (border.upwards ? y : x) % 2 != 0;
      const auto line = [&](const TerrainTile& of, const std::vector<std::uint32_t>& ids, double at) {
        std::size_t k = 0;
        while (k + 2 < ids.size() && place(of, ids[k + 1]) < at) ++k;
        const double a = place(of, ids[k]), b = place(of, ids[k + 1]);
        return std::lerp(of.height_m(ids[k]), of.height_m(ids[k + 1]), (at - a) / (b - a));
      };
      const auto compare = [&](double at) {  // twice a place on the parent, from the tile's end
        const double gap_m = std::fabs(line(tile, border.mine, at) -
                                       line(parent, border.above, 0.5 * (at + (second ? quantized_max : 0))));
        most_gap_m = std::max(most_gap_m, gap_m);
        ++compared;
      };
      for (const std::uint32_t i : border.mine) compare(place(tile, i));
      for (const std::uint32_t i : border.above) {
        const double at = 2.0 * place(parent, i) - (second ? quantized_max : 0);
        if (at >= 0.0 && at <= quantized_max) compare(at);
      }
    }
  }
  CHECK(compared > 3000);
  CHECK(most_gap_m < 1e-8);
  if (plain) return;
  const auto report = write_terrain(*pyramid, test::scratch_folder("shared"), {});
  REQUIRE(report.ok());
  for (const TerrainZoomSummary& zoom : report->zooms) CHECK(zoom.gap_bound_m == 0.0);
}

TEST_CASE("a pyramid's graph is valid and cuts show every part of the globe once, finer where the eye is") {
  const FormulaHeights source{[](double, double north) { return 10.0 * north; }, {-180.0, -90.0, 180.0, 90.0}, 3};
  const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {100.0}});
  REQUIRE(pyramid.ok());
  const std::vector<std::uint32_t> counts(pyramid->tile_count(), 1000);
  const auto made = terrain_graph(*pyramid, counts);
  REQUIRE(made.ok());
  CHECK(validate(made->graph).ok());
  CHECK(made->tiles.size() == pyramid->tile_count());
  View view{.eye = to_ecef_m(0.3, 0.7, 30000.0)};
  view.forward = -glm::normalize(view.eye);
  CutScratch scratch;
  std::vector<NodeId> cut;
  const CutSummary summary = select_cut(made->graph, view, {.error_px = 1.0, .culling = Culling::None}, scratch, cut);
  CHECK(summary.triangle_count == 1000 * cut.size());
  double area = 0.0;
  std::uint32_t under_eye = 0, coarsest = 9;
  for (const NodeId node : cut) {
    const TileId id = made->tiles[node];
    area += std::exp2(-2.0 * id.zoom);
    coarsest = std::min(coarsest, id.zoom);
    const GeoBox box = bounds_of(id);
    const double longitude_deg = 0.3 / 0.017453292519943295, latitude_deg = 0.7 / 0.017453292519943295;
    const bool below = box.west_deg <= longitude_deg && longitude_deg < box.east_deg && box.south_deg <= latitude_deg &&
                       latitude_deg < box.north_deg;
    if (below) under_eye = id.zoom;
    // What is drawn lies in its sphere.
    const Sphere& sphere = made->graph.nodes[node].bounds;
    for (const double across : {0.0, 0.37, 1.0}) {
      const double east = std::lerp(box.west_deg, box.east_deg, across) * 0.017453292519943295;
      const double north = std::lerp(box.south_deg, box.north_deg, 0.61 * across) * 0.017453292519943295;
      CHECK(glm::distance(to_ecef_m(east, north, 0.0), sphere.center) <= sphere.radius_m);
    }
  }
  CHECK(area == Approx(2.0));
  CHECK(under_eye == 3);
  CHECK(coarsest < 3);
  CHECK(terrain_graph(*pyramid, std::vector<std::uint32_t>(3)).error().code == ErrorCode::BadArgument);
}

TEST_CASE("water is where all is at or below the sea") {
  const FormulaHeights source{[](double longitude, double) { return longitude - 11.0; }, {0.0, 0.0, 22.5, 11.25}, 4};
  const auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {1.0}, .sea_level_m = 0.0});
  REQUIRE(pyramid.ok());
  const auto tile = pyramid->build({4, 16, 8});  // 0 to 11.25 degrees east
  REQUIRE(tile.ok());
  REQUIRE(tile->water.size() == 65536);
  CHECK(tile->water[0] == 255);
  CHECK(tile->water[255] == 0);
  CHECK(pyramid->build({4, 17, 8})->water == std::vector<std::uint8_t>{0});
}

TEST_CASE("water is where a second source says, not where heights are missing") {
  const GeoBox box{0.0, 0.0, 22.5, 11.25};
  const FormulaHeights source{[](double, double north) { return north < 3.0 ? static_cast<double>(NAN) : 100.0; }, box,
                              4};
  const FormulaHeights lake{[](double east, double north) { return east < 5.0 && north < 6.0 ? 1.0 : 0.0; }, box, 4};
  const FormulaHeights other{[](double east, double north) { return east < 5.0 && north < 6.5 ? 1.0 : 0.0; }, box, 4};
  const auto plan = [&](const HeightSource* water) {
    auto pyramid = TerrainPyramid::plan(source, {.max_error_m = {1.0}, .water = water});
    REQUIRE(pyramid.ok());
    return *pyramid;
  };
  const auto pyramid = plan(&lake);
  const auto tile = pyramid.build({4, 16, 8});  // 0 to 11.25 degrees east and north
  REQUIRE(tile.ok());
  REQUIRE(tile->water.size() == 65536);
  const auto water_at = [&](double east, double north) {
    const auto column = static_cast<std::size_t>(east / 11.25 * 256.0);
    return tile->water[(255 - static_cast<std::size_t>(north / 11.25 * 256.0)) * 256 + column];
  };
  CHECK(water_at(4.9, 5.9) == 255);
  CHECK(water_at(0.0, 3.1) == 255);
  CHECK(water_at(5.1, 5.9) == 0);
  CHECK(water_at(4.9, 6.1) == 0);
  CHECK(water_at(1.0, 1.0) == 0);
  CHECK(pyramid.build({4, 17, 8})->water == std::vector<std::uint8_t>{0});
  CHECK(pyramid.build({0, 0, 0})->water == std::vector<std::uint8_t>{0});  // west of Greenwich: no heights
  CHECK(plan(nullptr).build({4, 16, 8})->water.empty());
  // A run may go on only with the same mask.
  CHECK(plan(&lake).fingerprint() == pyramid.fingerprint());
  CHECK(plan(&other).fingerprint() != pyramid.fingerprint());
  CHECK(TerrainPyramid::plan(source, {.sea_level_m = 0.0, .water = &lake}).error().code == ErrorCode::BadArgument);
}

TEST_CASE("pyramids of other options have other fingerprints, whichever list by zoom a number stands in") {
  const FormulaHeights source{test::ranges_m, {10.0, 40.0, 20.0, 50.0}, 1};
  std::set<std::uint64_t> found;
  const auto plan = [&](std::vector<double> keep, std::vector<std::uint32_t> cells) {
    TerrainOptions options{.method = TerrainMethod::PointsGrid, .max_error_m = {100.0}};
    options.points.keep_ratio = std::move(keep);
    options.points.cell_posts = std::move(cells);
    const auto pyramid = TerrainPyramid::plan(source, options);
    REQUIRE(pyramid.ok());
    found.insert(pyramid->fingerprint());
  };
  plan({0.5}, {4});
  plan({0.5}, {4});
  CHECK(found.size() == 1);
  plan({0.5, 1.0}, {4});
  plan({0.5}, {1, 4});
  CHECK(found.size() == 3);
}

TEST_CASE("a source without data and options out of range are refused") {
  const FormulaHeights nothing{[](double, double) { return static_cast<double>(NAN); }, {0.0, 0.0, 5.0, 5.0}, 3};
  CHECK(TerrainPyramid::plan(nothing, {}).error().code == ErrorCode::BadData);
  const FormulaHeights flat{[](double, double) { return 7.0; }, {0.0, 0.0, 5.0, 5.0}, 3};
  CHECK(TerrainPyramid::plan(flat, {.max_error_m = {-1.0}}).error().code == ErrorCode::BadArgument);
  CHECK(TerrainPyramid::plan(flat, {.max_zoom = 60}).error().code == ErrorCode::BadArgument);
  CHECK(TerrainPyramid::plan(flat, {.grid_divisions = {3}}).error().code == ErrorCode::BadArgument);
}
