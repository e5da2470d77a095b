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
  CHECK(surface_triangle_count(whole) == cliff.triangle_count());
  const auto mono = render::render_mesh(cliff, options);
  const auto tiled = render::render_mesh(whole, options);
  REQUIRE(mono);
  REQUIRE(tiled);
  CHECK(worst_block(mono->image, tiled->image) < 2.0);
}

namespace {

// Dark rock under a white sky, so that any sky within a pixel brightens it.
Image silhouette(Mesh mesh, render::RenderOptions options) {
  for (Material& material : mesh.materials) material.base_color = {0.1F, 0.1F, 0.1F, 1.0F};
  options.look.background = render::Background::White;
  options.look.coloring = render::Coloring::Untextured;
  auto picture = render::render_mesh(mesh, options);
  REQUIRE(picture);
  return std::move(picture->image);
}

// Pixels with sky in them whose surroundings are rock throughout in the other picture.
std::size_t specks(const Image& picture, const Image& whole) {
  constexpr int sky = 100;
  constexpr int reach = 2;
  std::size_t count = 0;
  for (int y = reach; y + reach < static_cast<int>(picture.height); ++y) {
    for (int x = reach; x + reach < static_cast<int>(picture.width); ++x) {
      const auto bright = [&](const Image& image, int px, int py) {
        return int{image.at(static_cast<std::uint32_t>(px), static_cast<std::uint32_t>(py))[0]} > sky;
      };
      if (!bright(picture, x, y)) continue;
      bool inside = true;
      for (int dy = -reach; dy <= reach && inside; ++dy) {
        for (int dx = -reach; dx <= reach && inside; ++dx) inside = !bright(whole, x + dx, y + dy);
      }
      if (inside) ++count;
    }
  }
  return count;
}

}  // namespace

TEST_CASE("Between tiles of unequal levels no sky shows through") {
  const std::filesystem::path folder = scratch_folder("specks");
  REQUIRE(
      write_outcrop(small_cliff(), folder, {.pyramid = {.ratio = 0.3, .texture_ratio = 0.9, .tile_bytes = 12'000}}));
  const auto pyramid = TilePyramid::open(folder / "tileset.json");
  REQUIRE(pyramid);
  const Box& box = (*pyramid)->bounds();
  render::RenderOptions options{.width_px = 640, .height_px = 480, .supersample = 1};
  TilePager pager{*pyramid};
  std::size_t without_skirts = 0;
  for (const int side : {-1, 1}) {
    View view;
    view.eye = box.center() + box.diagonal_m() * glm::dvec3{0.35 * side, -0.3, 0.1};
    options.camera.eye_m = (*pyramid)->origin() + view.eye;
    options.camera.target_m = (*pyramid)->origin() + box.center() + glm::dvec3{0.2 * box.size().x * side, 0.0, 0.0};
    const auto picture_at = [&](double error_px, bool skirts) {
      pager.set_error_px(error_px);
      View around = view;  // chosen by distance alone: tiles of several levels side by side
      around.forward = glm::normalize(*options.camera.target_m - *options.camera.eye_m);
      std::vector<const Mesh*> tiles;
      for (const NodeId tile : pager.settle(around)) tiles.push_back(pager.content(tile));
      Mesh mesh = merged(tiles);
      mesh.origin = (*pyramid)->origin();
      if (!skirts) remove_skirts(mesh);
      return silhouette(std::move(mesh), options);
    };
    const Image whole = silhouette(small_cliff(), options);
    for (const double error_px : {6.0, 9.0}) {
      without_skirts += specks(picture_at(error_px, false), whole);
      const Image picture = picture_at(error_px, true);
      CHECK(specks(picture, whole) == 0);
    }
  }
  CHECK(without_skirts > 20);  // there was something to close
}

}  // namespace lodestone::test
