// SPDX-License-Identifier: MIT
// Levels with names on the slider, and the street of houses.
#include <lodestone/facet_shift.h>
#include <lodestone/generate.h>

#include <viewer/window/level_control.h>
#include <viewer/window/orbit_camera.h>
#include <viewer/window/street.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;
using namespace lodestone::render;

namespace {

std::shared_ptr<const ProgressiveModel> house_model() {
  const auto house = generate_house({{.triangles = 3'000, .texture_size_px = 16}, Roof::Hip});
  REQUIRE(house.ok());
  const auto built = build_by_facet_shift(*house);
  REQUIRE(built.ok());
  return built->model;
}

std::shared_ptr<const ProgressiveModel> without_names(const ProgressiveModel& model) {
  ModelData data = model.data();
  data.named_levels.clear();
  auto made = ProgressiveModel::from_data(std::move(data));
  REQUIRE(made.ok());
  return *made;
}

}  // namespace

TEST_CASE("the slider's marks lead to the levels that the model names, and say which of them one is in") {
  const auto model = house_model();
  LevelControl control;
  control.attach(*model);
  Cursor cursor{model, {.motion = Motion::Hard, .start_level = model->record_count()}};
  const auto& marks = control.marks();
  REQUIRE(marks.size() >= 2);
  CHECK(marks.front().name == "LoD3");
  CHECK(marks.back().name.find("block") != std::string::npos);
  std::size_t names = 0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    names += 1 + static_cast<std::size_t>(std::count(marks[i].name.begin(), marks[i].name.end(), ','));
    if (i > 0) CHECK(marks[i].level < marks[i - 1].level);
    if (i > 0) CHECK(marks[i].slider <= marks[i - 1].slider);
    control.mode = LevelMode::Sweep;
    control.go_to(marks[i].level, *model);
    control.drive(cursor, {}, 0.1);
    cursor.step({}, 0.1);
    CHECK(cursor.level() == marks[i].level);
    CHECK(control.slider == marks[i].slider);
    // Its range goes from it up to the next finer one.
    CHECK(control.name_of(marks[i].level) == marks[i].name);
    const Level next = i == 0 ? model->record_count() + 1 : marks[i - 1].level;
    CHECK(control.name_of(next - 1) == marks[i].name);
  }
  CHECK(names == model->data().named_levels.size());
  if (marks.back().level > 0) CHECK(control.name_of(marks.back().level - 1).empty());

  // Moved away, the slider is what counts again.
  control.slider = 1.0F;
  control.drive(cursor, {}, 0.1);
  cursor.step({}, 0.1);
  CHECK(cursor.level() == model->record_count());
  control.attach(*without_names(*model));
  CHECK(control.marks().empty());
  CHECK(control.name_of(0).empty());
}

TEST_CASE("the street's houses stand apart in two rows, and need less the farther they are") {
  const auto made = make_street({.house_count = 10, .house_triangles = 3'000});
  REQUIRE(made.ok());
  const Street& street = **made;
  REQUIRE(street.houses.size() == 10);
  const View view{.eye = near_end(street).eye, .width_px = 640, .height_px = 480};
  std::vector<Box> boxes;
  std::vector<std::uint32_t> triangles;
  for (const Street::House& house : street.houses) {
    const Box& own = house.model->bounds();
    boxes.push_back({own.min + house.offset_m, own.max + house.offset_m});
    CHECK(boxes.back().min.z == Approx(0.0).margin(1e-9));
    CHECK((boxes.back().max.x < -5.0 || boxes.back().min.x > 5.0));  // nothing stands on the roadway
    View from_house = view;
    from_house.eye -= house.offset_m;
    Cursor cursor{house.model, {.motion = Motion::Hard}};
    cursor.set_target(Target::pixels(from_house, 1.0));
    cursor.step({}, 1.0);
    triangles.push_back(cursor.triangle_count());
  }
  for (std::size_t i = 2; i < boxes.size(); ++i) CHECK(boxes[i].min.y > boxes[i - 2].max.y);
  // The fifth of a row is like its first.
  for (const std::size_t row : {0U, 1U}) {
    CHECK(street.houses[row].model == street.houses[row + 8].model);
    CHECK(triangles[row + 8] < triangles[row]);
  }

  // Along the roadway, above it, and back to the start.
  const View start = along_street(street, 0.0, 640, 480);
  const View far_end = along_street(street, 0.5, 640, 480);
  CHECK(glm::length(start.eye - near_end(street).eye) < 1e-9);
  CHECK(far_end.eye.y > boxes[4].max.y);
  CHECK(far_end.eye.y < boxes.back().min.y);  // something is ahead still
  CHECK(std::abs(far_end.eye.x) < 1e-9);
  CHECK(far_end.forward.y > 0.9);
  CHECK(glm::length(along_street(street, 1.0, 640, 480).eye - start.eye) < 1e-9);
  OrbitCamera camera;
  camera.stand(near_end(street).eye, near_end(street).target, street.bounds.diagonal_m());
  CHECK(glm::length(camera.view().eye - start.eye) < 1e-6);
  CHECK(glm::length(camera.view().forward - start.forward) < 1e-9);
}
