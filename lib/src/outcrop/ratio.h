// SPDX-License-Identifier: MIT
// How many triangles a level keeps of the one below, where nobody says so.
#pragma once

#include <algorithm>
#include <cmath>

#include <lodestone/outcrop.h>

namespace lodestone::outcrop {

inline constexpr double untextured_ratio = 0.4;

[[nodiscard]] inline double texture_ratio(const OutcropOptions& options) noexcept {
  if (options.texture_ratio > 0.0) return options.texture_ratio;
  return options.ratio > 0.0 ? options.ratio : 0.5;
}

// Of the first step, before anything is measured, and the bounds of those that follow the measure. They are meant for
// textures that halve. Where these shrink more slowly, as much as over a whole halving is spread over more levels, or
// triangles would run out long before texels do.
struct FollowedRatio {
  double least = 0.2, first = untextured_ratio, most = 0.7;
};
[[nodiscard]] inline FollowedRatio followed_ratio(const OutcropOptions& options) noexcept {
  const double halvings = std::min(1.0, -std::log2(texture_ratio(options)));
  const FollowedRatio whole;
  return {std::pow(whole.least, halvings), std::pow(whole.first, halvings), std::pow(whole.most, halvings)};
}

}  // namespace lodestone::outcrop
