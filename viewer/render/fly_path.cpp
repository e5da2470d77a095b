// SPDX-License-Identifier: MIT
#include "fly_path.h"

#include <cmath>
#include <numbers>

#include "camera.h"

namespace lodestone::render {

View fly_view(const Box& bounds, double turns, std::uint32_t width_px, std::uint32_t height_px) {
  constexpr double fov_y_rad = 0.8;
  const glm::dvec3 center = bounds.center();
  const glm::dvec3 half = 0.5 * (bounds.max - bounds.min);
  const double room_m = 0.12 * glm::length(half);
  const auto on_ellipse = [&](double angle, double size) {
    return center +
           glm::dvec3{size * (half.x + room_m) * std::sin(angle), -size * (half.y + room_m) * std::cos(angle), 0.0};
  };
  const double angle = 2.0 * std::numbers::pi * turns;
  glm::dvec3 eye = on_ellipse(angle, 1.0);
  eye.z += half.z + room_m * (0.4 + 0.9 * (1.0 - std::cos(angle)));
  const glm::dvec3 target = on_ellipse(angle + 0.7, 0.45);
  return look_at(eye, target, width_px, height_px, fov_y_rad);
}

}  // namespace lodestone::render
