// SPDX-License-Identifier: MIT
// The four side planes of a view, for spheres.
#pragma once

#include <cmath>

#include <lodestone/view.h>

namespace lodestone {

class Frustum {
 public:
  explicit Frustum(const View& view) noexcept
      : eye_(view.eye), forward_(view.forward), right_(glm::normalize(glm::cross(view.forward, view.up))) {
    up_ = glm::cross(right_, forward_);
    const double half_y = view.fov_y_rad * 0.5;
    const double half_x = std::atan(std::tan(half_y) * view.width_px / view.height_px);
    cos_ = {std::cos(half_x), std::cos(half_y)};
    sin_ = {std::sin(half_x), std::sin(half_y)};
  }

  // Never true for a sphere that reaches into the view; may be false for one beside an edge of it.
  [[nodiscard]] bool outside(const Sphere& s) const noexcept {
    const glm::dvec3 d = s.center - eye_;
    const double z = glm::dot(d, forward_);
    const double x = std::abs(glm::dot(d, right_));
    const double y = std::abs(glm::dot(d, up_));
    return z < -s.radius_m || x * cos_.x - z * sin_.x > s.radius_m || y * cos_.y - z * sin_.y > s.radius_m;
  }

 private:
  glm::dvec3 eye_, forward_, right_;
  glm::dvec3 up_{0.0};
  glm::dvec2 cos_{0.0}, sin_{0.0};
};

}  // namespace lodestone
