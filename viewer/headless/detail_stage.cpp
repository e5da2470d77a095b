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

constexpr std::uint32_t smooth_supersample = 2;
constexpr std::uint32_t smooth_coverage = 4;

// Part of `screen_px` pixels, about their middle, that holds `reach_px` on both sides. A multiple of `step_px` goes at
// each end, so that every wavelet coefficient keeps its place.
std::uint32_t cut_px(std::uint32_t screen_px, double reach_px, std::uint32_t step_px) {
  const double spare_px = 0.5 * screen_px - reach_px;
  if (!(spare_px >= step_px)) return screen_px;
  return screen_px - 2 * step_px * static_cast<std::uint32_t>(spare_px / step_px);
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
  State(std::shared_ptr<const ProgressiveModel> m, const Display& d, std::uint32_t samples, std::unique_ptr<Stage> s,
        Frame f)
      : model(std::move(m)),
        display(d),
        supersample(samples),
        wavelet_levels(VisionModel{d}.levels()),
        stage(std::move(s)),
        frame(std::move(f)),
        surfaces(stage->gl(), plain(model->data())),
        cursor(model, {.motion = Motion::Hard, .start_level = model->record_count()}),
        geometry(stage->gl(), plain(cursor)) {
    const DrawArrays finest = arrays_of(cursor);
    positions.assign(finest.positions.begin(), finest.positions.end());
    cursor.clear_dirty();
  }

  std::shared_ptr<const ProgressiveModel> model;
  // The part of the screen that shows the object from a distance, and its camera.
  [[nodiscard]] View view(double azimuth_rad, double distance_m) const;
  [[nodiscard]] Status resize(const FrameSize& size);

  Display display;
  std::uint32_t supersample;
  int wavelet_levels;
  std::unique_ptr<Stage> stage;
  Frame frame;
  Surfaces surfaces;
  Cursor cursor;
  Geometry geometry;
  std::vector<glm::vec3> positions;  // of the finest level: what a picture must hold
};

View DetailStage::State::view(double azimuth_rad, double distance_m) const {
  constexpr double band_reach = 16.0;  // samples of the coarsest band: 8 of the filter, 4 of the wavelet, some to spare
  const std::uint32_t step_px = 1U << std::max(6, wavelet_levels);
  const glm::dvec3 middle = model->bounds().center();
  const glm::dvec3 outward{std::sin(azimuth_rad), std::cos(azimuth_rad), 0.0};
  const glm::dvec3 right{-outward.y, outward.x, 0.0};
  glm::dvec2 reach{0.0};  // pixels per pixel of focal length
  for (const glm::vec3& position : positions) {
    const glm::dvec3 p = glm::dvec3{position} - middle;
    const double depth_m = std::max(0.0, distance_m - glm::dot(p, outward));
    reach = glm::max(reach, glm::abs(glm::dvec2{glm::dot(p, right), p.z}) / depth_m);
  }
  const double focal_px = focal_length_px(display);
  const double margin_px = std::ldexp(band_reach, wavelet_levels);
  const std::uint32_t width_px = cut_px(display.width_px, focal_px * reach.x + margin_px, step_px);
  const std::uint32_t height_px = cut_px(display.height_px, focal_px * reach.y + margin_px, step_px);
  return look_at(middle + outward * distance_m, middle, width_px, height_px,
                 2.0 * std::atan(0.5 * height_px / focal_px));
}

Status DetailStage::State::resize(const FrameSize& size) {
  if (frame.size() == size) return Done{};
  auto resized = Frame::create(stage->gl(), size);
  if (!resized) return resized.error();
  frame = std::move(resized).value();
  return Done{};
}

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
  // The largest that will be needed.
  const FrameSize size{display.width_px, display.height_px, std::max(smooth_supersample, supersample), smooth_coverage};
  auto frame = Frame::create((*stage)->gl(), size);
  if (!frame) return frame.error();
  return std::unique_ptr<DetailStage>{new DetailStage{std::make_unique<State>(
      std::move(model), display, supersample, std::move(stage).value(), std::move(frame).value())}};
}

void DetailStage::set_level(Level level) {
  State& s = *state_;
  s.cursor.jump(level);
  s.geometry.update(plain(s.cursor), s.cursor.dirty_vertices(), s.cursor.dirty_indices());
  s.cursor.clear_dirty();
}

Result<ObjectPicture> DetailStage::picture(double azimuth_rad, double distance_m, Edges edges) {
  if (!std::isfinite(azimuth_rad) || !(distance_m > 0.0) || !std::isfinite(distance_m)) {
    return Error{ErrorCode::BadArgument, "a distance must be finite and above 0, a direction finite", ""};
  }
  State& s = *state_;
  const View view = s.view(azimuth_rad, distance_m);
  const FrameSize size =
      edges == Edges::Smooth
          ? FrameSize{view.width_px, view.height_px, std::max(smooth_supersample, s.supersample), smooth_coverage}
          : FrameSize{view.width_px, view.height_px, s.supersample, 1};
  if (Status status = s.resize(size); !status) return status.error();
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
