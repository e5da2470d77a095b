// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <lodestone/metrics.h>
#include <lodestone/tile_loader.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "base/rng.h"
#include "data.h"
#include "fixture.h"
#include "viewer/headless/stage.h"
#include "viewer/render/tile_scene.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

// Written once; tests that damage it take a copy.
const fs::path& tiles() {
  static const fs::path folder = [] {
    fs::path made = scratch_folder("pager_tiles");
    REQUIRE(write_outcrop(small_cliff(), made, {.pyramid = small_tiles()}));
    return made;
  }();
  return folder;
}

View from_south(const TilePyramid& pyramid, double radii) {
  const Box& box = pyramid.bounds();
  View view;
  view.eye = box.center() - glm::dvec3{0.0, 0.5 * radii * box.diagonal_m(), 0.0};
  return view;
}

std::uint32_t triangles(const TilePager& pager, std::span<const NodeId> drawn) {
  std::uint32_t sum = 0;
  for (const NodeId tile : drawn) sum += surface_triangle_count(*pager.content(tile));
  return sum;
}

}  // namespace

TEST_CASE("Nearer by, more is drawn; from very near the source itself, from far the root alone") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  CHECK(validate((*pyramid)->graph()).ok());
  CHECK((*pyramid)->origin() == small_cliff().origin);
  TilePager pager{*pyramid};
  std::uint32_t before = 0;
  for (const double radii : {2000.0, 40.0, 8.0, 2.5}) {
    const auto drawn = pager.settle(from_south(**pyramid, radii));
    const std::uint32_t now = triangles(pager, drawn);
    CHECK(now >= before);
    if (radii > 1000.0) CHECK(drawn.size() == 1);
    before = now;
  }
  CHECK(before > 1000);
  CHECK(pager.status().failures.empty());

  TilePager fine{*pyramid, {.error_px = 1e-6}};
  CHECK(triangles(fine, fine.settle(from_south(**pyramid, 4.0))) == small_cliff().triangle_count());
}

TEST_CASE("Nothing else is read beside the first picture") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  TilePager pager{*pyramid};
  const View near = from_south(**pyramid, 2.0);
  CHECK(pager.update(near, 0.01).size() == 1);
  CHECK(pager.status().wanted_tiles > 0);
  std::this_thread::sleep_for(std::chrono::milliseconds{100});  // in which workers would have read several
  CHECK(pager.update(near, 0.01).size() == 1);
  CHECK(pager.status().loaded_tiles == 1);
  pager.wait();
  static_cast<void>(pager.update(near, 0.01));
  CHECK(pager.status().loaded_tiles > 1);
}

TEST_CASE("While tiles are on their way, and whatever the budget, no part of the view is missing or drawn twice") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  TilePager pager{*pyramid, {.workers = 1, .budget_bytes = 300'000, .error_px = 0.5}};
  Rng rng{3};
  for (int frame = 0; frame < 200; ++frame) {
    View view = from_south(**pyramid, 1.0 + 6.0 * rng.unit());
    view.eye.x += 40.0 * (rng.unit() - 0.5);
    const auto drawn = pager.update(view, 0.02);
    REQUIRE(!drawn.empty());
    std::vector<NodeId> sorted(drawn.begin(), drawn.end());
    std::sort(sorted.begin(), sorted.end());
    CHECK(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
    for (const NodeId tile : drawn) CHECK(pager.content(tile) != nullptr);
    if (frame % 20 == 0) std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  // What is needed comes even where it is more than the budget.
  const auto near = pager.settle(from_south(**pyramid, 1.2));
  CHECK(triangles(pager, near) > 1000);
  CHECK(pager.status().resident_bytes > 300'000);
  static_cast<void>(pager.settle(from_south(**pyramid, 3000.0)));
  static_cast<void>(pager.update(from_south(**pyramid, 3000.0), 0.0));
  CHECK(pager.status().resident_bytes <= 300'000);
}

TEST_CASE(
    "An exchange of tiles goes by way of both: at every instant each part is shown once, or as two shares of one") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  const LodGraph& graph = (*pyramid)->graph();
  std::vector<NodeId> parent(graph.nodes.size(), none);
  for (const LodGroup& group : graph.groups) {
    for (NodeId n = group.nodes.begin; n < group.nodes.end; ++n) {
      for (const LodLink& link : graph.links) {
        if (link.maker != none && &graph.groups[link.maker] == &group) parent[n] = link.nodes.begin;
      }
    }
  }
  TilePager pager{*pyramid, {.workers = 1, .budget_bytes = 300'000, .error_px = 0.5, .fade_s = 0.1}};
  std::vector<float> come(graph.nodes.size(), 0.0F);
  std::size_t exchanges = 0;
  for (int frame = 0; frame < 300; ++frame) {
    // Away and back, faster than exchanges end.
    const auto drawn = pager.update(from_south(**pyramid, 8.0 + 7.0 * std::sin(0.05 * frame)), 0.016);
    if (frame % 4 == 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    if (pager.fading()) ++exchanges;
    std::fill(come.begin(), come.end(), 0.0F);
    for (const NodeId n : drawn) come[n] = pager.share(n);
    for (NodeId leaf = 0; leaf < graph.nodes.size(); ++leaf) {
      if (std::find(parent.begin(), parent.end(), leaf) != parent.end()) continue;
      std::vector<float> shares;
      for (NodeId n = leaf; n != none; n = parent[n]) {
        if (come[n] != 0.0F) shares.push_back(come[n]);
      }
      if (shares.size() == 1) CHECK(shares.front() == 1.0F);
      if (shares.size() == 2) CHECK(shares.front() * shares.back() < 0.0F);
      if (shares.size() == 2) CHECK(std::abs(shares.front() - shares.back()) == Approx(1.0F));
      CHECK((shares.size() == 1 || shares.size() == 2));
    }
  }
  CHECK(exchanges > 20);
}

TEST_CASE("What the camera flies towards is there when it arrives, as far ahead as was asked") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  const double start = 40.0;
  const double radii_per_s = 70.0;
  std::uint32_t missing[2] = {};
  for (const double look_ahead_s : {0.0, 0.5}) {
    TilePager pager{*pyramid, {.look_ahead_s = look_ahead_s}};
    double time_s = 0.0;
    // On and on at the same speed, by steps so small that only workers get anywhere.
    for (int frame = 0; frame < 2000; ++frame) {
      constexpr double dt_s = 1e-6;
      static_cast<void>(pager.update(from_south(**pyramid, start - radii_per_s * time_s), dt_s));
      if (frame > 2 && pager.status().wanted_tiles == 0) break;
      time_s += dt_s;
      std::this_thread::sleep_for(std::chrono::milliseconds{2});
    }
    static_cast<void>(pager.update(from_south(**pyramid, start - radii_per_s * 0.49), 0.0));
    missing[look_ahead_s > 0.0 ? 1 : 0] = pager.status().wanted_tiles;
  }
  CHECK(missing[0] > 0);
  CHECK(missing[1] == 0);
}

TEST_CASE("Photographs on tiles are shown as they are, unless lamps are asked for") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  render::RenderOptions options{.width_px = 64, .height_px = 48, .supersample = 1};
  std::vector<Image> pictures;
  for (const auto lighting : {render::Lighting::Automatic, render::Lighting::Photograph, render::Lighting::Lamps}) {
    options.look.lighting = lighting;
    auto picture = render::render_tiles(*pyramid, options);
    REQUIRE(picture);
    pictures.push_back(std::move(picture->image));
  }
  CHECK(pictures[0].pixels == pictures[1].pixels);
  CHECK(image_rms(pictures[0], pictures[2]) > 5.0);
}

TEST_CASE("An exchange of all tiles at once jumps by a fifth at most of what it would without going by way of both") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  auto stage = render::Stage::create();
  REQUIRE(stage);
  render::RenderOptions options{.width_px = 160, .height_px = 120, .supersample = 1};
  options.look.lighting = render::Lighting::Photograph;
  double pops[2] = {};
  for (const double fade_s : {0.0, 0.2}) {
    render::TileScene scene{(*stage)->gl(), *pyramid, {.fade_s = fade_s}};
    options.camera.yaw_rad = scene.yaw_rad();
    const auto view = render::view_of(options, (*pyramid)->bounds(), (*pyramid)->origin(), {});
    const auto frame = render::Frame::create((*stage)->gl(), render::frame_size(options));
    REQUIRE(view);
    REQUIRE(frame);
    scene.set_error_px(1e-3);
    scene.settle(*view);
    scene.set_error_px(1e3);
    scene.settle(*view);  // the root; what is finer is there
    CHECK(scene.items().size() == 1);
    scene.set_error_px(1e-3);
    const auto picture = [&] {
      (*stage)->renderer().draw(*frame, *view, (*pyramid)->bounds(), scene.items(), options.look);
      return (*stage)->presenter().read(*frame);
    };
    Image before = picture();
    for (int step = 0; step < 16; ++step) {
      scene.update(*view, 1.0 / 60.0);
      Image now = picture();
      pops[fade_s > 0.0 ? 1 : 0] = std::max(pops[fade_s > 0.0 ? 1 : 0], block_pop(before, now));
      before = std::move(now);
    }
    CHECK(scene.items().size() > 10);
    CHECK(scene.still());
  }
  CAPTURE(pops[0], pops[1]);
  CHECK(pops[0] > 5.0);
  CHECK(pops[1] < 0.2 * pops[0]);
}

TEST_CASE("What cannot be read is told, and what is coarser stands in") {
  const fs::path folder = scratch_folder("pager_broken");
  fs::copy(tiles(), folder, fs::copy_options::recursive);
  fs::remove(folder / "tiles/L0_0.glb");
  const auto pyramid = TilePyramid::open(folder / "tileset.json");
  REQUIRE(pyramid);
  TilePager pager{*pyramid, {.error_px = 1e-6}};
  const auto drawn = pager.settle(from_south(**pyramid, 4.0));
  CHECK(pager.status().failures.size() == 1);
  CHECK(triangles(pager, drawn) < small_cliff().triangle_count());
  for (const NodeId tile : drawn) CHECK(pager.content(tile) != nullptr);

  CHECK(TilePyramid::open(folder / "tiles/L0_1.glb").error().code == ErrorCode::BadData);
  CHECK(!is_tileset_file(folder / "build.json"));
  CHECK(is_tileset_file(folder / "tileset.json"));
}

TEST_CASE("Tiles merge into one mesh with their own textures") {
  const auto pyramid = TilePyramid::open(tiles() / "tileset.json");
  REQUIRE(pyramid);
  TilePager pager{*pyramid, {.error_px = 1e-6}};
  std::vector<const Mesh*> all;
  for (const NodeId tile : pager.settle(from_south(**pyramid, 4.0))) all.push_back(pager.content(tile));
  Mesh whole = merged(all);
  CHECK(validate(whole).ok());
  CHECK(whole.textures.size() == all.size());
  remove_skirts(whole);
  CHECK(validate(whole).ok());
  CHECK(whole.triangle_count() == small_cliff().triangle_count());
  CHECK(inspect(whole).boundary_edges == inspect(small_cliff()).boundary_edges);
}

}  // namespace lodestone::test
