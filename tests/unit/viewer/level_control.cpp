// SPDX-License-Identifier: MIT
// What moves the level when nobody moves the slider: the sweep that plays, and the camera's distance.
#include <lodestone/edge_collapse.h>
#include <lodestone/generate.h>
#include <lodestone/view.h>

#include <viewer/render/camera.h>
#include <viewer/window/level_control.h>

#include <catch2/catch.hpp>

using namespace lodestone;
using namespace lodestone::render;

namespace {

std::shared_ptr<const ProgressiveModel> cliff_model() {
  const auto cliff = generate_outcrop({.triangles = 4'000, .textures = 1, .texture_size_px = 16});
  REQUIRE(cliff.ok());
  const auto built = build_by_edge_collapse(*cliff);
  REQUIRE(built.ok());
  return built->model;
}

}  // namespace

TEST_CASE("a sweep goes down and up again in its time, and stays where it is paused") {
  const auto model = cliff_model();
  LevelControl control;
  control.attach(*model);
  control.mode = LevelMode::Sweep;
  control.sweep_s = 4.0F;
  Cursor cursor{model, {.motion = Motion::Hard, .start_level = model->record_count()}};
  const std::uint32_t finest = cursor.triangle_count();
  const auto play = [&](double seconds) {
    for (double t = 0.0; t < seconds - 0.05; t += 0.1) {
      control.drive(cursor, {}, 0.1);
      cursor.step({}, 0.1);
    }
  };
  play(1.0);
  CHECK(control.slider == Approx(0.5F).margin(0.01));
  const std::uint32_t half_way = cursor.triangle_count();
  CHECK(half_way < finest / 4);  // the slider is logarithmic
  control.mode = LevelMode::Slider;
  play(1.0);
  CHECK(cursor.triangle_count() == half_way);
  control.mode = LevelMode::Sweep;
  play(1.0);
  CHECK(control.slider == Approx(0.0F).margin(0.01));
  CHECK(cursor.triangle_count() < half_way / 4);
  play(2.0);
  CHECK(control.slider == Approx(1.0F).margin(0.01));
}

TEST_CASE("the level that follows the camera is coarser from afar and off by no more pixels than asked") {
  const auto model = cliff_model();
  LevelControl control;
  control.attach(*model);
  control.mode = LevelMode::Automatic;
  control.max_error_px = 2.0F;
  Cursor cursor{model, {.motion = Motion::Hard, .start_level = model->record_count()}};
  const Box bounds = model->bounds();
  const Sphere sphere{.center = bounds.center(), .radius_m = bounds.diagonal_m() * 0.5};
  const View near = framed_view(bounds, {}, 1280, 720, 0.8);
  std::uint32_t last = cursor.triangle_count();
  for (const double times : {2.0, 8.0, 32.0}) {
    View view = near;
    view.eye = bounds.center() + (near.eye - bounds.center()) * times;
    control.drive(cursor, view, 0.1);
    cursor.step({}, 0.1);
    CHECK(error_px(view, cursor.error_m(), sphere) <= 2.0);
    CHECK(cursor.triangle_count() < last);
    control.drive(cursor, view, 0.1);  // the slider follows with the next frame
    CHECK(control.triangles_of(control.slider) == Approx(std::max(12U, cursor.triangle_count())).epsilon(0.01));
    last = cursor.triangle_count();
  }
  control.drive(cursor, near, 0.1);
  cursor.step({}, 0.1);
  CHECK(cursor.triangle_count() > 4 * last);
}
