// SPDX-License-Identifier: MIT
/// \file
/// A camera, and the only formula that turns an error in metres into pixels.
#pragma once

#include <algorithm>
#include <cmath>

#include <lodestone/types.h>

namespace lodestone {

/// Perspective camera; positions in the frame of the thing viewed (relative to its origin).
struct View {
  glm::dvec3 eye{0.0};
  glm::dvec3 forward{0.0, 1.0, 0.0};  ///< unit
  glm::dvec3 up{0.0, 0.0, 1.0};       ///< unit, not parallel to forward
  double fov_y_rad = 0.8;             ///< full vertical angle, (0, pi)
  std::uint32_t width_px = 1280;
  std::uint32_t height_px = 720;
  double near_m = 0.01;  ///< Nothing is taken to be nearer than this.
};

/// Pixels that one metre across the line of sight covers at distance 1 m: H / (2 tan(fov_y / 2)).
[[nodiscard]] inline double focal_px(const View& view) noexcept {
  return view.height_px / (2.0 * std::tan(view.fov_y_rad * 0.5));
}

/// Size on the screen of a deviation `error_m` that may lie anywhere in `bounds`: taken at the point of the sphere
/// nearest to the eye, so it is an upper bound at the image centre. Infinite only if the error is.
[[nodiscard]] inline double error_px(const View& view, double error_m, const Sphere& bounds) noexcept {
  const double distance_m = glm::length(bounds.center - view.eye) - bounds.radius_m;
  return error_m * focal_px(view) / std::max(distance_m, view.near_m);
}

/// The inverse: the error in metres that covers `error_px` pixels there.
[[nodiscard]] inline double error_m_at(const View& view, double error_px, const Sphere& bounds) noexcept {
  const double distance_m = glm::length(bounds.center - view.eye) - bounds.radius_m;
  return error_px * std::max(distance_m, view.near_m) / focal_px(view);
}

}  // namespace lodestone
