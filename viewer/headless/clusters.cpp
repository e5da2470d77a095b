// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <string>

#include <lodestone/metrics.h>

#include "../render/cluster_scene.h"
#include "headless_clusters.h"
#include "stage.h"

namespace lodestone::render {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

Result<Picture> render_clusters(const std::shared_ptr<const ClusterFile>& file, const RenderOptions& options,
                                double error_px) {
  auto stage = Stage::create();
  if (!stage) return stage.error();
  Stage& on = **stage;
  const auto target = Frame::create(on.gl(), frame_size(options));
  if (!target) return target.error();
  ClusterScene scene{on.gl(), file};
  const auto view = view_of(options, scene.bounds(), file->outline().origin, {});
  if (!view) return view.error();
  const ClusterFrame shown = scene.settle(*view, {.error_px = error_px});
  const std::span<const Item> items = scene.items(options.look.coloring);
  Picture picture{.image = {}, .triangles = static_cast<std::uint32_t>(shown.cut.triangle_count)};
  for (int pass = 0; pass < 2; ++pass) {
    const auto start = Clock::now();
    on.renderer().draw(*target, *view, scene.bounds(), items, options.look);
    on.gl().finish();
    picture.frame_seconds = seconds_since(start);
  }
  picture.image = on.presenter().read(*target);
  std::vector<Warning> warnings = scene.warnings();
  if (shown.missing_groups > 0) {
    const std::string groups = std::to_string(shown.missing_groups) + " groups";
    warnings.push_back({"pages are missing; what is coarser stands in for " + groups, ""});
  }
  return {std::move(picture), std::move(warnings)};
}

Result<ClusterFlight> fly_clusters(const std::shared_ptr<const ClusterFile>& file, const FlightOptions& options) {
  auto stage = Stage::create();
  if (!stage) return stage.error();
  Stage& on = **stage;
  const auto target = Frame::create(on.gl(), frame_size(options.render));
  if (!target) return target.error();
  ClusterScene scene{on.gl(), file, {.stream = options.stream, .morph_seconds = options.morph_seconds}};
  const CutOptions cut{.error_px = options.error_px, .culling = options.watch ? Culling::None : Culling::Frustum};
  ClusterFlight flight;
  Image before;
  for (std::uint32_t i = 0; i < options.frames; ++i) {
    const View view = options.path(scene.bounds(), static_cast<double>(i) / options.frames);
    if (i == 0) scene.settle(view, cut);
    if (options.waits_for_pages) scene.load(view, cut);
    const auto start = Clock::now();
    const ClusterFrame frame = scene.update(view, cut, 1.0 / 60.0);
    on.renderer().draw(*target, options.watch ? options.watch(scene.bounds()) : view, scene.bounds(),
                       scene.items(options.render.look.coloring), options.render.look);
    on.gl().finish();
    flight.frame_seconds.push_back(seconds_since(start));
    flight.mean_triangles += static_cast<double>(frame.cut.triangle_count) / options.frames;
    flight.most_resident_bytes = std::max(flight.most_resident_bytes, scene.streamer().resident_bytes());
    Image image = on.presenter().read(*target);
    if (i > 0) flight.pops.push_back(block_pop(before, image));
    if (options.on_frame) {
      if (auto status = options.on_frame(image, i); !status) return status.error();
    }
    before = std::move(image);
  }
  return flight;
}

}  // namespace lodestone::render
