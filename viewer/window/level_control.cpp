// SPDX-License-Identifier: MIT
#include "level_control.h"

#include <algorithm>
#include <cmath>

namespace lodestone::render {
namespace {

// "lod3" is how files and commands spell it; CityGML writes LoD3.
std::string shown_name(const std::string& name) { return name.starts_with("lod") ? "LoD" + name.substr(3) : name; }

}  // namespace

void LevelControl::attach(const ProgressiveModel& model) {
  finest_log_ = std::log(std::max(1.0, double(model.info(model.record_count()).triangles)));
  // A base of one or two triangles shows nothing: the slider's lower end keeps a shape.
  const double base = std::max<double>(model.info(0).triangles, 12.0);
  base_log_ = std::min(std::log(base), finest_log_);
  slider = 1.0F;
  exact_.reset();
  marks_.clear();
  std::vector<NamedLevel> named = model.data().named_levels;
  std::stable_sort(named.begin(), named.end(),
                   [](const NamedLevel& a, const NamedLevel& b) { return a.level > b.level; });
  for (const NamedLevel& n : named) {
    if (!marks_.empty() && marks_.back().level == n.level) {
      marks_.back().name += ", " + shown_name(n.name);
    } else {
      marks_.push_back({shown_name(n.name), n.level, slider_of(model.info(n.level).triangles)});
    }
  }
}

std::string LevelControl::name_of(Level level) const {
  const auto mark = std::find_if(marks_.begin(), marks_.end(), [&](const Mark& m) { return m.level <= level; });
  return mark == marks_.end() ? std::string{} : mark->name;
}

void LevelControl::go_to(Level level, const ProgressiveModel& model) {
  mode = LevelMode::Slider;
  slider = slider_of(model.info(level).triangles);
  exact_ = ExactPlace{slider, level};
}

float LevelControl::slider_of(std::uint32_t triangles) const {
  if (finest_log_ <= base_log_) return 1.0F;
  const double place = (std::log(std::max(1.0, double(triangles))) - base_log_) / (finest_log_ - base_log_);
  return static_cast<float>(std::clamp(place, 0.0, 1.0));
}

std::uint32_t LevelControl::triangles_of(float at) const {
  return static_cast<std::uint32_t>(std::lround(std::exp(base_log_ + (finest_log_ - base_log_) * double(at))));
}

// The distance from which the plan's screen shows the model as large as this view does.
Level LevelControl::needed_from(const View& view, const ProgressiveModel& model) const {
  const double distance_m = glm::length(model.bounds().center() - view.eye);
  return needed_level(*plan, distance_m * plan->focal_px / focal_px(view));
}

void LevelControl::drive(Cursor& cursor, const View& view, double dt_s) {
  if (mode == LevelMode::Automatic) {
    cursor.set_target(plan ? Target::level(needed_from(view, cursor.model()))
                           : Target::pixels(view, double(max_error_px)));
    slider = slider_of(cursor.triangle_count());
    return;
  }
  if (mode == LevelMode::Sweep) {
    double place = double(slider) + direction_ * dt_s * 2.0 / std::max(0.1, double(sweep_s));
    if (place <= 0.0 || place >= 1.0) direction_ = place <= 0.0 ? 1.0 : -1.0;
    place = std::clamp(place, 0.0, 1.0);
    slider = static_cast<float>(place);
  }
  if (exact_ && slider == exact_->slider && mode == LevelMode::Slider) {
    cursor.set_target(Target::level(exact_->level));
    return;
  }
  exact_.reset();
  // At the upper end exactly the source, whatever rounding says.
  cursor.set_target(slider >= 1.0F ? Target::level(cursor.model().record_count())
                                   : Target::triangles(triangles_of(slider)));
}

}  // namespace lodestone::render
