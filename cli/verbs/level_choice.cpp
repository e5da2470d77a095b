// SPDX-License-Identifier: MIT
#include "level_choice.h"

#include <charconv>
#include <cmath>

#include <lodestone/discrete_levels.h>
#include <lodestone/perception.h>

namespace lodestone::cli {

void LevelChoice::declare(Arguments& arguments) {
  arguments.count("--triangles", triangles_, 0, none, "The finest level with at most so many triangles");
  arguments.number("--ratio", ratio_, 0.0, 1.0, "The same as a share of the source's triangles");
  arguments.length_m("--error", error_m_, "The coarsest level that deviates by at most this");
  arguments.text("--level", level_, "This level, 0 is the base; or its name: lod3, lod2, lod1, block");
  arguments.length_m(
      "--perceptual", perceptual_m_,
      "The coarsest level that deviates by at most half a pixel from this distance, on a screen of 1280 x "
      "1024 under 33 degrees; with --plan the level that was measured to be needed there");
}

int LevelChoice::ways() const noexcept {
  return int{triangles_.has_value()} + int{ratio_.has_value()} + int{error_m_.has_value()} + int{level_.has_value()} +
         int{perceptual_m_.has_value()};
}

Result<Level> LevelChoice::in(const ProgressiveModel& model, const std::filesystem::path& plan_file) const {
  if (triangles_) return model.level_of_triangles(*triangles_);
  if (ratio_) {
    return model.level_of_triangles(static_cast<std::uint32_t>(std::lround(*ratio_ * model.face_slot_count())));
  }
  if (perceptual_m_ && !plan_file.empty()) {
    const auto plan = read_level_plan(plan_file);
    if (!plan) return plan.error();
    if (Status fits = check_level_plan(*plan, model); !fits) return fits.error();
    return needed_level(*plan, *perceptual_m_);
  }
  if (perceptual_m_) return model.level_of_error(imperceptible_error_m(*perceptual_m_, focal_length_px(Display{})));
  if (error_m_) return model.level_of_error(*error_m_);
  Level level = 0;
  const auto [end, fault] = std::from_chars(level_->data(), level_->data() + level_->size(), level);
  if (end != level_->data() + level_->size() || level_->empty()) return model.level_of_name(*level_);
  if (fault == std::errc{} && level <= model.record_count()) return level;
  return Error{ErrorCode::BadArgument,
               "--level " + *level_ + " is not there, the finest is " + std::to_string(model.record_count()), ""};
}

}  // namespace lodestone::cli
