// SPDX-License-Identifier: MIT
// The plan as a file, and who follows it.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include <lodestone/cursor.h>
#include <lodestone/discrete_levels.h>
#include <lodestone/edge_collapse.h>

#include "data.h"
#include "shapes.h"
#include "viewer/render/camera.h"
#include "viewer/window/level_control.h"

using namespace lodestone;

namespace {

std::shared_ptr<const ProgressiveModel> model_of(const Mesh& mesh) {
  auto built = build_by_edge_collapse(mesh);
  REQUIRE(built.ok());
  return built->model;
}

}  // namespace

TEST_CASE("a plan reads back as it was written, and a broken one is refused") {
  const auto folder = test::scratch_folder("level_plan");
  const LevelPlan plan{.levels = {{0.0, 10, 100, 0.0}, {31.25, 7, 40, 0.125}, {1000.0 / 3.0, 7, 40, 0.125}},
                       .last_m = 20000.0,
                       .radius_m = 7.5,
                       .focal_px = 1710.38,
                       .height_px = 1024.0,
                       .width_px = 1280.0,
                       .needed = {{20.0, 10}, {80.0, 6}, {320.0, 1}}};
  REQUIRE(write_level_plan(plan, folder / "plan.json").ok());
  const auto again = read_level_plan(folder / "plan.json");
  REQUIRE(again.ok());
  REQUIRE(again->levels.size() == 3);
  CHECK(again->levels[2].from_m == plan.levels[2].from_m);
  CHECK(again->levels[1].triangles == 40);
  CHECK(again->last_m == plan.last_m);
  REQUIRE(again->needed.size() == 3);
  CHECK(again->needed[1].distance_m == 80.0);
  CHECK(again->needed[1].level == 6);
  CHECK_FALSE(write_levels(*model_of(test::sphere(16, 32)), *again, folder / "levels").ok());  // of another model
  CHECK_FALSE(read_level_plan(folder / "none.json").ok());
  LevelPlan wrong = plan;
  std::swap(wrong.levels[1], wrong.levels[2]);
  wrong.levels[1].from_m = 1e9;
  CHECK_FALSE(write_level_plan(wrong, folder / "wrong.json").ok());
  wrong = plan;
  wrong.needed[1].level = 11;  // finer than the one before
  CHECK_FALSE(write_level_plan(wrong, folder / "wrong.json").ok());
  for (const char* text : {"", "[]", "{}", R"({"format":"lodestone level plan","version":1})",
                           R"({"format":"lodestone level plan","version":1,"last_m":1,"radius_m":1,"focal_px":1,
                              "width_px":1,"height_px":1,"levels":[{"from_m":"x"}]})"}) {
    std::ofstream{folder / "bad.json"} << text;
    const auto bad = read_level_plan(folder / "bad.json");
    REQUIRE_FALSE(bad.ok());
    CHECK(bad.error().code == ErrorCode::BadData);
  }
}

TEST_CASE("the level that is needed lies between those that were measured, or is that of the discrete plan") {
  LevelPlan plan{.levels = {{0.0, 10, 100, 0.0}, {40.0, 7, 70, 0.1}, {200.0, 0, 4, 0.5}},
                 .needed = {{20.0, 10}, {80.0, 6}, {320.0, 2}}};
  CHECK(needed_level(plan, 0.0) == 10);
  CHECK(needed_level(plan, 20.0) == 10);
  CHECK(needed_level(plan, 40.0) == 8);  // half way, by factors
  CHECK(needed_level(plan, 80.0) == 6);
  CHECK(needed_level(plan, 160.0) == 4);
  CHECK(needed_level(plan, 1e9) == 2);
  plan.needed.clear();
  CHECK(needed_level(plan, 39.9) == 10);
  CHECK(needed_level(plan, 40.0) == 7);
  CHECK(needed_level(plan, 1e9) == 0);
}

TEST_CASE("the window goes to the level that its plan needs from where the camera stands, on a screen of its size") {
  const auto model = model_of(test::sphere(16, 32));
  render::LevelControl control;
  control.attach(*model);
  control.mode = render::LevelMode::Automatic;
  control.plan = LevelPlan{.levels = {{0.0, model->record_count(), model->triangle_count(), 0.0}},
                           .last_m = 1e4,
                           .radius_m = 7.5,
                           .focal_px = 1000.0,
                           .height_px = 1024.0,
                           .width_px = 1280.0,
                           .needed = {{20.0, model->record_count()}, {2000.0, 0}}};
  Cursor cursor{model, {.motion = Motion::Hard}};
  const glm::dvec3 middle = model->bounds().center();
  for (const double distance_m : {10.0, 50.0, 200.0, 5000.0}) {
    const View view =
        render::look_at(middle + glm::dvec3{0.0, -distance_m, 0.0}, middle, 640, 500, 2.0 * std::atan(0.5));
    REQUIRE(focal_px(view) == Approx(500.0));  // half of the plan's: as from twice as far
    control.drive(cursor, view, 0.1);
    CHECK(cursor.target_level() == needed_level(*control.plan, 2.0 * distance_m));
  }
}
