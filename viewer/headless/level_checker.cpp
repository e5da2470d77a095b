// SPDX-License-Identifier: MIT
#include "level_checker.h"

#include <algorithm>

namespace lodestone::render {

Result<const std::vector<ObjectPicture>*> LevelChecker::full_detail(double distance_m) {
  const auto known = full_.find(distance_m);
  if (known != full_.end()) return &known->second;
  // Every plan begins at the nearest distance, where pictures are the largest.
  if (full_.size() > 1) full_.erase(std::next(full_.begin()), full_.end());
  std::vector<ObjectPicture> pictures;
  stage_.set_level(model_->record_count());
  for (const LookedAt& side : sides_) {
    auto picture = stage_.picture(side.azimuth_rad, distance_m, Edges::Smooth);
    if (!picture) return picture.error();
    pictures.push_back(std::move(*picture));
  }
  return &full_.emplace(distance_m, std::move(pictures)).first->second;
}

Result<LevelCheck> LevelChecker::check(Level level, double distance_m) {
  if (level == model_->record_count()) return LevelCheck{distance_m, 1.0, 0.0};  // full detail itself
  const auto known = checked_.find({distance_m, level});
  if (known != checked_.end()) return known->second;
  const auto full = full_detail(distance_m);
  if (!full) return full.error();
  LevelCheck check{distance_m, 0.0, 0.0};
  double pixels = 0.0;
  stage_.set_level(level);
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    if (context_.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", ""};
    const ObjectPicture& fine = (**full)[i];
    const auto coarse = stage_.picture(sides_[i].azimuth_rad, distance_m, Edges::Smooth);
    if (!coarse) return coarse.error();
    // Of either: a level that grows beyond the outline of the source is seen there too.
    std::vector<std::uint8_t> object = fine.mask;
    for (std::size_t p = 0; p < object.size(); ++p) object[p] |= coarse->mask[p];
    const auto count = static_cast<double>(std::count(object.begin(), object.end(), std::uint8_t{1}));
    if (count == 0.0) continue;  // nothing is seen of either
    const auto seen = check_vision(fine.image, coarse->image, object, vision_);
    if (!seen) return seen.error();
    check.ssim += seen->ssim * count;
    check.noticeable_ratio += seen->noticeable_ratio * count;
    pixels += count;
  }
  stage_.set_level(model_->record_count());
  check.ssim = pixels > 0.0 ? check.ssim / pixels : 1.0;
  check.noticeable_ratio = pixels > 0.0 ? check.noticeable_ratio / pixels : 0.0;
  checked_.emplace(std::pair{distance_m, level}, check);
  return check;
}

Result<std::pair<Level, LevelCheck>> LevelChecker::coarsest_unnoticed(Level from, Level finest, double distance_m) {
  auto check = this->check(from, distance_m);
  if (!check) return check.error();
  if (check->noticeable_ratio <= limit_) return std::pair{from, *check};
  Level shows = from;
  auto full = this->check(finest, distance_m);
  if (!full) return full.error();
  std::pair<Level, LevelCheck> passes{finest, *full};
  const Level near_enough = std::max(Level{1}, model_->record_count() / 1000);
  while (passes.first - shows > near_enough) {
    const Level middle = shows + (passes.first - shows) / 2;
    check = this->check(middle, distance_m);
    if (!check) return check.error();
    if (check->noticeable_ratio > limit_) {
      shows = middle;
    } else {
      passes = {middle, *check};
    }
  }
  return passes;
}

}  // namespace lodestone::render
