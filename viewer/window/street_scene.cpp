// SPDX-License-Identifier: MIT
#include "street_scene.h"

#include <algorithm>

namespace lodestone::render {

StreetScene::House::House(const Gl& gl, const Street::House& house, double morph_seconds)
    : cursor(house.model,
             {.motion = Motion::MorphFade, .morph_seconds = morph_seconds, .start_level = house.model->record_count()}),
      geometry(gl, arrays_of(cursor)) {
  cursor.clear_dirty();
  if (cursor.beside() != nullptr) beside.emplace(gl, arrays_of(*cursor.beside()));
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
  items_.resize(1 + houses_.size());
  for (std::size_t i = 0; i < houses_.size(); ++i) {
    House& house = *houses_[i];
    View from_house = view;
    from_house.eye -= street_->houses[i].offset_m;
    house.cursor.set_target(Target::pixels(from_house, error_px));
    const StepResult step = house.cursor.step({}, dt_s);
    still_ = still_ && step.arrived && !step.changed;
    uploaded_bytes_ += house.geometry.update(house.cursor);
    // Houses fade each by its own clock, so their pixels are shared out instead of blending two pictures.
    const float fade = house.cursor.fade();
    items_[1 + i].share = fade > 0.0F ? fade - 1.0F : 1.0F;
    if (fade <= 0.0F) continue;
    uploaded_bytes_ += house.beside->update(*house.cursor.beside());
    Item beside = items_[1 + i];
    beside.geometry = &*house.beside;
    beside.share = fade;
    items_.push_back(beside);
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
