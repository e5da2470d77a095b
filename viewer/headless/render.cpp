// SPDX-License-Identifier: MIT
#include <chrono>
#include <ctime>

#include "stage.h"

namespace lodestone::render {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Result<Picture> picture_of(const DrawArrays& arrays, const DrawArrays& finest, const Surroundings& surroundings,
                           const Box& bounds, const RenderOptions& options) {
  const auto view = view_of(options, bounds, surroundings.origin, finest);
  if (!view) return view.error();
  auto stage = Stage::create();
  if (!stage) return stage.error();
  Stage& on = **stage;
  const auto frame = Frame::create(on.gl(), frame_size(options));
  if (!frame) return frame.error();
  const Surfaces surfaces{on.gl(), surroundings};
  const Geometry geometry{on.gl(), arrays};
  const Item item{.geometry = &geometry, .surfaces = &surfaces, .size_m = bounds.diagonal_m()};
  Picture picture{.image = {}, .triangles = arrays.triangle_count()};
  // Twice: the first frame compiles shaders and uploads.
  for (int pass = 0; pass < 2; ++pass) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    on.renderer().draw(*frame, *view, bounds, {&item, 1}, options.look);
    on.gl().finish();
    picture.frame_seconds = seconds_since(start);
    picture.frame_processor_seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  }
  picture.image = on.presenter().read(*frame);
  return {std::move(picture), surfaces.warnings()};
}

}  // namespace

Result<Picture> render_mesh(const Mesh& mesh, const RenderOptions& options) {
  const SortedMesh sorted{mesh};
  return picture_of(sorted.arrays(), sorted.arrays(), mesh, bounds(mesh), options);
}

Result<View> view_of_mesh(const Mesh& mesh, const RenderOptions& options) {
  const SortedMesh sorted{mesh};
  return view_of(options, bounds(mesh), mesh.origin, sorted.arrays());
}

Result<Picture> render_level(std::shared_ptr<const ProgressiveModel> model, Level level, const RenderOptions& options) {
  const Cursor cursor{model, {.motion = Motion::Hard, .start_level = level}};
  // Every level is seen from the same side.
  const Cursor finest{model, {.motion = Motion::Hard, .start_level = model->record_count()}};
  return picture_of(arrays_of(cursor), arrays_of(finest), model->data(), model->bounds(), options);
}

}  // namespace lodestone::render
