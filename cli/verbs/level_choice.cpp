// SPDX-License-Identifier: MIT
#include "level_choice.h"

#include <cmath>

namespace lodestone::cli {

void LevelChoice::declare(Arguments& arguments) {
  arguments.count("--triangles", triangles_, 0, none, "The finest level with at most so many triangles");
  arguments.number("--ratio", ratio_, 0.0, 1.0, "The same as a share of the source's triangles");
  arguments.length_m("--error", error_m_, "The coarsest level that deviates by at most this");
  arguments.count("--level", level_, 0, none, "This level; 0 is the base");
}

int LevelChoice::ways() const noexcept {
  return int{triangles_.has_value()} + int{ratio_.has_value()} + int{error_m_.has_value()} + int{level_.has_value()};
}

Result<Level> LevelChoice::in(const ProgressiveModel& model) const {
  if (triangles_) return model.level_of_triangles(*triangles_);
  if (ratio_) {
    return model.level_of_triangles(static_cast<std::uint32_t>(std::floor(*ratio_ * model.face_slot_count())));
  }
  if (error_m_) return model.level_of_error(*error_m_);
  if (*level_ <= model.record_count()) return Level{*level_};
  return Error{
      ErrorCode::BadArgument,
      "--level " + std::to_string(*level_) + " is not there, the finest is " + std::to_string(model.record_count()),
      ""};
}

}  // namespace lodestone::cli
