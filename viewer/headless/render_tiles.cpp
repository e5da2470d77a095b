// SPDX-License-Identifier: MIT
#include <chrono>
#include <ctime>

#include "../render/tile_scene.h"
#include "stage.h"

namespace lodestone::render {

Result<Picture> render_tiles(std::shared_ptr<const TilePyramid> pyramid, const RenderOptions& options,
                             const PagerOptions& pager) {
  auto stage = Stage::create();
  if (!stage) return stage.error();
  Stage& on = **stage;
  TileScene scene{on.gl(), pyramid, pager};
  if (scene.status().resident_tiles == 0) {
    return Error{ErrorCode::BadData, scene.status().failures.front(), "the root tile"};
  }
  RenderOptions seen = options;
  seen.look.lighting = scene.lighting(options.look.lighting);
  if (!seen.camera.yaw_rad) seen.camera.yaw_rad = scene.yaw_rad();
  const auto view = view_of(seen, pyramid->bounds(), pyramid->origin(), {});
  if (!view) return view.error();
  const auto frame = Frame::create(on.gl(), frame_size(options));
  if (!frame) return frame.error();
  scene.settle(*view);
  Picture picture{.image = {}, .triangles = scene.triangle_count()};
  picture.tiles = static_cast<std::uint32_t>(scene.items().size());
  for (int pass = 0; pass < 2; ++pass) {  // the first compiles shaders
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    on.renderer().draw(*frame, *view, pyramid->bounds(), scene.items(), seen.look);
    on.gl().finish();
    picture.frame_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    picture.frame_processor_seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  }
  picture.image = on.presenter().read(*frame);
  std::vector<Warning> failures;
  for (const std::string& line : scene.status().failures) failures.push_back({line, ""});
  return {std::move(picture), std::move(failures)};
}

}  // namespace lodestone::render
