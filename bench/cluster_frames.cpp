// SPDX-License-Identifier: MIT
// Table 3 of Wang et al. 2023 as a ratio: time of a frame with the whole mesh, with discrete levels in a tree of tiles,
// and with the cluster graph, along one flight over the model (OSMesa, so the processor draws).
//
//     bench_cluster_frames MESH [--frames N] [--error-px E] [--size WxH]
//
// Prints one JSON object. Tiles and pages are loaded before a frame is timed; selecting and drawing are counted.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <lodestone/formats.h>
#include <lodestone/tileset_writer.h>

#include "viewer/headless/stage.h"
#include "viewer/render/cluster_scene.h"
#include "viewer/render/fly_path.h"
#include "viewer/render/tile_scene.h"

namespace {

using namespace lodestone;
using namespace lodestone::render;

struct Flight {
  std::uint32_t frames = 24;
  double error_px = 1.0;
  std::uint32_t width_px = 1280;
  std::uint32_t height_px = 720;
};

// One way to draw: what prepares a frame untimed, and what is timed; it returns the triangles.
template <class Prepare, class Select>
void fly(Stage& stage, const Frame& frame, const Flight& flight, const Box& bounds, const char* name, Prepare prepare,
         Select select) {
  std::vector<double> seconds;
  double triangles = 0.0;
  for (std::uint32_t i = 0; i < flight.frames; ++i) {
    const View view = fly_view(bounds, static_cast<double>(i) / flight.frames, flight.width_px, flight.height_px);
    prepare(view);
    std::span<const Item> items;
    for (int pass = 0; pass < 2; ++pass) {  // the first uploads
      const auto start = std::chrono::steady_clock::now();
      items = select(view);
      stage.renderer().draw(frame, view, bounds, items, {.coloring = Coloring::Untextured});
      stage.gl().finish();
      const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (pass == 1) seconds.push_back(s);
    }
    for (const Item& item : items) {
      const std::span<const DrawRange> draws = item.draws.empty() ? item.geometry->arrays().draws : item.draws;
      for (const DrawRange& draw : draws) triangles += draw.index_count / 3.0 / flight.frames;
    }
  }
  std::sort(seconds.begin(), seconds.end());
  std::printf("\"%s\": {\"median_ms\": %.2f, \"fastest_ms\": %.2f, \"triangles\": %.0f}, ", name,
              1e3 * seconds[seconds.size() / 2], 1e3 * seconds.front(), triangles);
  std::fflush(stdout);
}

int run(const Mesh& mesh, const Flight& flight, const std::filesystem::path& folder) {
  auto stage = Stage::create();
  if (!stage.ok()) return 2;
  const Gl& gl = (*stage)->gl();
  const auto frame = Frame::create(gl, {flight.width_px, flight.height_px, 1, 1});
  const auto graph = build_cluster_graph(mesh);
  if (!frame.ok() || !graph.ok() || !write_cluster_graph(*graph, folder / "a.lodg").ok()) return 2;
  if (!write_outcrop(mesh, folder / "tiles").ok()) return 2;
  const auto file = ClusterFile::open(folder / "a.lodg");
  const auto pyramid = TilePyramid::open(folder / "tiles" / "tileset.json");
  if (!file.ok() || !pyramid.ok()) return 2;
  const Box box = bounds(mesh);
  std::printf("{\"triangles\": %u, ", mesh.triangle_count());
  {
    const SortedMesh sorted{mesh};
    const Geometry geometry{gl, sorted.arrays()};
    const Surfaces surfaces{gl, mesh};
    const Item item{.geometry = &geometry, .surfaces = &surfaces, .size_m = box.diagonal_m()};
    fly(
        **stage, *frame, flight, box, "whole", [](const View&) {},
        [&](const View&) {
          return std::span{&item, 1};
        });
  }
  {
    TileScene scene{gl, *pyramid};
    scene.set_error_px(flight.error_px);
    fly(
        **stage, *frame, flight, box, "tiles", [&](const View& view) { scene.settle(view); },
        [&](const View& view) {
          scene.update(view, 0.0);
          return scene.items();
        });
  }
  ClusterScene scene{gl, *file};
  const CutOptions cut{.error_px = flight.error_px};
  fly(
      **stage, *frame, flight, box, "clusters", [&](const View& view) { scene.settle(view, cut); },
      [&](const View& view) {
        scene.update(view, cut, 1.0 / 60.0);
        return scene.items(Coloring::Untextured);
      });
  std::printf("\"cluster_file_bytes\": %llu}\n",
              static_cast<unsigned long long>(std::filesystem::file_size(folder / "a.lodg")));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Flight flight;
  for (int i = 2; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--frames") == 0) flight.frames = static_cast<std::uint32_t>(std::atoi(argv[i + 1]));
    if (std::strcmp(argv[i], "--error-px") == 0) flight.error_px = std::atof(argv[i + 1]);
    if (std::strcmp(argv[i], "--size") == 0) std::sscanf(argv[i + 1], "%ux%u", &flight.width_px, &flight.height_px);
  }
  if (argc < 2 || flight.frames == 0) {
    std::fputs("bench_cluster_frames MESH [--frames N] [--error-px E] [--size WxH]\n", stderr);
    return 1;
  }
  const auto loaded = read_mesh(argv[1]);
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", to_line(loaded.error()).c_str());
    return 2;
  }
  const auto folder = std::filesystem::temp_directory_path() / ("bench_cluster_frames_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const int code = run(loaded->mesh, flight, folder);
  std::filesystem::remove_all(folder);
  return code;
}
