// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <lodestone/generate.h>
#include <lodestone/tile_loader.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "data.h"
#include "fixture.h"
#include "viewer/headless/headless.h"

namespace lodestone::test {
namespace {

// Root mean square over RGB of the worst block of 16 x 16 pixels.
double worst_block(const Image& a, const Image& b) {
  constexpr std::uint32_t size = 16;
  double worst = 0.0;
  for (std::uint32_t y = 0; y + size <= a.height; y += size) {
    for (std::uint32_t x = 0; x + size <= a.width; x += size) {
      double sum = 0.0;
      for (std::uint32_t by = 0; by < size; ++by) {
        for (std::uint32_t bx = 0; bx < 3 * size; ++bx) {
          const int d = int{a.at(x, y + by)[bx]} - int{b.at(x, y + by)[bx]};
          sum += d * d;
        }
      }
      worst = std::max(worst, std::sqrt(sum / (3.0 * size * size)));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("At full detail no seam shows: the pyramid looks like the monolith, block by block") {
  auto made = generate_outcrop({.triangles = 12'000, .textures = 3, .texture_size_px = 512, .seed = 5, .charts = 6});
  REQUIRE(made);
  const Mesh& cliff = *made;
  const std::filesystem::path folder = scratch_folder("seams");
  // Lossless textures: what differs is then the work of tiling alone.
  REQUIRE(write_outcrop(cliff, folder, {.pyramid = {.tile_bytes = 40'000}, .image = TileImage::Png}));
  const auto pyramid = TilePyramid::open(folder / "tileset.json");
  REQUIRE(pyramid);
  TilePager pager{*pyramid, {.error_px = 1e-6}};
  render::RenderOptions options{.width_px = 640, .height_px = 320, .supersample = 1};
  const auto view = render::view_of_mesh(cliff, options);
  REQUIRE(view);
  options.camera.eye_m = cliff.origin + view->eye + view->forward * 40.0;
  options.camera.target_m = cliff.origin + view->eye + view->forward * 50.0;
  std::vector<const Mesh*> tiles;
  for (const NodeId tile : pager.settle(*view)) tiles.push_back(pager.content(tile));
  Mesh whole = merged(tiles);
  whole.origin = cliff.origin;
  CHECK(whole.triangle_count() == cliff.triangle_count());
  const auto mono = render::render_mesh(cliff, options);
  const auto tiled = render::render_mesh(whole, options);
  REQUIRE(mono);
  REQUIRE(tiled);
  CHECK(worst_block(mono->image, tiled->image) < 2.0);
}

}  // namespace lodestone::test
