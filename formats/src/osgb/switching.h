// SPDX-License-Identifier: MIT
// Errors in metres and OpenSceneGraph's ranges, one from the other.
//
// Based on: OSG's CullVisitor: px = 2 R / z * sqrt(p^2 + (W^2 + H^2) / 8), p = H / (2 tan(fov_y / 2)), at the sphere's
// middle. An error is taken at the sphere's nearest point, so z = error * p + R where it covers a pixel.
#pragma once

#include <algorithm>
#include <cmath>

namespace lodestone::osgb {

// The view that ranges are made for; others switch a little earlier or later.
inline constexpr double width_px = 1920.0;
inline constexpr double height_px = 1080.0;
inline constexpr double fov_y_rad = 0.8;

[[nodiscard]] inline double focal_px() { return height_px / (2.0 * std::tan(fov_y_rad * 0.5)); }

// Size on OSG's screen of a sphere at the distance z from its middle.
[[nodiscard]] inline double size_px(double radius_m, double z_m) {
  const double diagonal2 = (width_px * width_px + height_px * height_px) / 8.0;
  return 2.0 * radius_m / z_m * std::sqrt(focal_px() * focal_px() + diagonal2);
}

// Size on OSG's screen at which an error in the sphere's nearest point covers a pixel.
[[nodiscard]] inline float threshold_px(double radius_m, double error_m) {
  return static_cast<float>(size_px(radius_m, error_m * focal_px() + radius_m));
}

// The error that covers a pixel at this distance from the sphere's middle, and where the sphere has this size.
[[nodiscard]] inline double error_at_distance_m(double radius_m, double z_m) {
  return std::max(0.0, z_m - radius_m) / focal_px();
}
[[nodiscard]] inline double error_at_size_m(double radius_m, double px) {
  return px > 0.0 ? error_at_distance_m(radius_m, size_px(radius_m, 1.0) / px) : 1e9;
}

}  // namespace lodestone::osgb
