// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, section 5.1 (flat shading, static light, white background).
#include "detail_stage.h"

#include <algorithm>
#include <cmath>

#include "stage.h"

namespace lodestone::render {
namespace {

// The brightest lit pixel of the object must stay below white, by which the background is told from it.
constexpr float brightest_albedo = 0.85F;

// Plain, opaque and never white.
Surroundings plain(const Surroundings& source) {
  Surroundings made;
  made.origin = source.origin;
  made.materials = source.materials;
  if (made.materials.empty()) made.materials.emplace_back();
  for (Material& material : made.materials) {
    material.texture = none;
    material.alpha_cutoff = 0.0F;
    material.base_color = glm::min(material.base_color, glm::vec4{brightest_albedo});
    material.base_color.a = 1.0F;
  }
  return made;
}

// Normals are left out, so that faces are lit flat, and colours.
DrawArrays plain(const Cursor& cursor) {
  DrawArrays arrays = arrays_of(cursor);
  arrays.normals = {};
  arrays.uvs = {};
  arrays.colors = {};
  return arrays;
}

}  // namespace

struct DetailStage::State {
  State(std::shared_ptr<const ProgressiveModel> m, const Display& d, std::unique_ptr<Stage> s, Frame f)
      : model(std::move(m)),
        display(d),
        stage(std::move(s)),
        frame(std::move(f)),
        surfaces(stage->gl(), plain(model->data())),
        cursor(model, {.motion = Motion::Hard, .start_level = model->record_count()}),
        geometry(stage->gl(), plain(cursor)) {
    cursor.clear_dirty();
  }

  std::shared_ptr<const ProgressiveModel> model;
  Display display;
  std::unique_ptr<Stage> stage;
  Frame frame;
  Surfaces surfaces;
  Cursor cursor;
  Geometry geometry;
};

DetailStage::DetailStage(std::unique_ptr<State> state) : state_(std::move(state)) {}
DetailStage::~DetailStage() = default;

Result<std::unique_ptr<DetailStage>> DetailStage::create(std::shared_ptr<const ProgressiveModel> model,
                                                         const Display& display, std::uint32_t supersample) {
  if (model->triangle_count() == 0 || model->bounds().empty()) {
    return Error{ErrorCode::BadArgument, "the model has no triangles to look at", ""};
  }
  if (!(display.fov_y_rad >= 0.01 && display.fov_y_rad <= 3.0)) {
    return Error{ErrorCode::BadArgument, "the field of view must lie between 0.01 and 3 radians", ""};
  }
  if (supersample < 1 || supersample > 4) {
    return Error{ErrorCode::BadArgument, "supersampling goes from 1 to 4", ""};
  }
  auto stage = Stage::create();
  if (!stage) return stage.error();
  const FrameSize size{display.width_px, display.height_px, supersample, 1};
  auto frame = Frame::create((*stage)->gl(), size);
  if (!frame) return frame.error();
  return std::unique_ptr<DetailStage>{new DetailStage{
      std::make_unique<State>(std::move(model), display, std::move(stage).value(), std::move(frame).value())}};
}

void DetailStage::set_level(Level level) {
  State& s = *state_;
  s.cursor.jump(level);
  s.geometry.update(plain(s.cursor), s.cursor.dirty_vertices(), s.cursor.dirty_indices());
  s.cursor.clear_dirty();
}

Result<ObjectPicture> DetailStage::picture(double azimuth_rad, double distance_m) {
  if (!std::isfinite(azimuth_rad) || !(distance_m > 0.0) || !std::isfinite(distance_m)) {
    return Error{ErrorCode::BadArgument, "a distance must be finite and above 0, a direction finite", ""};
  }
  State& s = *state_;
  const glm::dvec3 middle = s.model->bounds().center();
  const glm::dvec3 outward{std::sin(azimuth_rad), std::cos(azimuth_rad), 0.0};
  const View view =
      look_at(middle + outward * distance_m, middle, s.display.width_px, s.display.height_px, s.display.fov_y_rad);
  const Item item{.geometry = &s.geometry, .surfaces = &s.surfaces, .size_m = s.model->bounds().diagonal_m()};
  const Look look{.coloring = Coloring::Untextured, .background = Background::White};
  s.stage->renderer().draw(s.frame, view, s.model->bounds(), {&item, 1}, look);
  ObjectPicture picture{s.stage->presenter().read(s.frame), {}};
  const auto& pixels = picture.image.pixels;
  picture.mask.resize(pixels.size() / 3);
  for (std::size_t i = 0; i < picture.mask.size(); ++i) {
    const bool white = pixels[3 * i] == 255 && pixels[3 * i + 1] == 255 && pixels[3 * i + 2] == 255;
    picture.mask[i] = white ? 0 : 1;
  }
  return picture;
}

}  // namespace lodestone::render
