// SPDX-License-Identifier: MIT
#include "street_scene.h"

#include <algorithm>

namespace lodestone::render {

StreetScene::House::House(const Gl& gl, const Street::House& house, double morph_seconds)
    : cursor(house.model,
             {.motion = Motion::Morph, .morph_seconds = morph_seconds, .start_level = house.model->record_count()}),
      geometry(gl, arrays_of(cursor)) {
  cursor.clear_dirty();
}

StreetScene::StreetScene(const Gl& gl, std::shared_ptr<const Street> street, double morph_seconds)
    : street_(std::move(street)),
      sorted_ground_(street_->ground),
      ground_(gl, sorted_ground_.arrays()),
      ground_surfaces_(gl, street_->ground) {
  items_.push_back(
      {.geometry = &ground_, .surfaces = &ground_surfaces_, .size_m = bounds(street_->ground).diagonal_m()});
  for (const Street::House& house : street_->houses) {
    std::unique_ptr<Surfaces>& surfaces = surfaces_[house.model.get()];
    if (!surfaces) surfaces = std::make_unique<Surfaces>(gl, house.model->data());
    houses_.push_back(std::make_unique<House>(gl, house, morph_seconds));
    items_.push_back({.geometry = &houses_.back()->geometry,
                      .surfaces = surfaces.get(),
                      .offset_m = house.offset_m,
                      .size_m = house.model->bounds().diagonal_m()});
  }
}

void StreetScene::update(const View& view, double error_px, double dt_s) {
  still_ = true;
  uploaded_bytes_ = 0;
  for (std::size_t i = 0; i < houses_.size(); ++i) {
    House& house = *houses_[i];
    View from_house = view;
    from_house.eye -= street_->houses[i].offset_m;
    house.cursor.set_target(Target::pixels(from_house, error_px));
    const StepResult step = house.cursor.step({}, dt_s);
    still_ = still_ && step.arrived && !step.changed;
    uploaded_bytes_ += house.geometry.update(house.cursor);
  }
}

std::uint32_t StreetScene::triangle_count() const {
  std::uint32_t count = 0;
  for (const auto& house : houses_) count += house->cursor.triangle_count();
  return count;
}

std::pair<std::uint32_t, std::uint32_t> StreetScene::triangles_of_a_house() const {
  std::pair<std::uint32_t, std::uint32_t> range{none, 0};
  for (const auto& house : houses_) {
    range.first = std::min(range.first, house->cursor.triangle_count());
    range.second = std::max(range.second, house->cursor.triangle_count());
  }
  return range;
}

std::uint32_t StreetScene::finest_triangle_count() const {
  std::uint32_t count = 0;
  for (const Street::House& house : street_->houses) count += house.model->triangle_count();
  return count;
}

}  // namespace lodestone::render
