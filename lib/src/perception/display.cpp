// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, equations 2, 8, 13, 14 and 17.
#include <lodestone/perception.h>

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {
constexpr double metres_per_inch = 0.0254;
constexpr double half_degree_rad = 0.5 * std::numbers::pi / 180.0;
}  // namespace

double focal_length_px(const Display& display) noexcept {
  return display.height_px / (2.0 * std::tan(0.5 * display.fov_y_rad));
}

double max_frequency_cpd(const Display& display) noexcept {
  const double pixels_per_degree =
      2.0 * display.viewing_distance_m * std::tan(half_degree_rad) * display.dots_per_inch / metres_per_inch;
  return 0.5 * pixels_per_degree;
}

double contrast_sensitivity(double frequency_cpd) noexcept {
  const double a = 0.144 * frequency_cpd;
  return 2.6 * (0.0192 + a) * std::exp(-std::pow(a, 1.1));
}

double first_distance_m(double radius_m, double fov_rad) noexcept { return radius_m / std::sin(0.5 * fov_rad); }

double last_distance_m(double radius_m, double focal_px) noexcept {
  return radius_m * std::sqrt(1.0 + 4.0 * focal_px * focal_px);
}

double imperceptible_error_m(double distance_m, double focal_px) noexcept { return distance_m / (2.0 * focal_px); }

}  // namespace lodestone
