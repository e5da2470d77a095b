// SPDX-License-Identifier: MIT
#include "orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodestone::render {
namespace {

constexpr double steepest_rad = 1.5;  // short of vertical, where "up" would have no direction
constexpr double fov_y_rad = 0.6;

}  // namespace

void OrbitCamera::frame(const Box& bounds, std::uint32_t width_px, std::uint32_t height_px, double yaw_rad) {
  resize(width_px, height_px);
  orbit_ = Orbit{.yaw_rad = yaw_rad};
  size_m_ = std::max(bounds.diagonal_m(), 1e-6);
  const View view = framed_view(bounds, orbit_, width_px_, height_px_, fov_y_rad);
  const glm::dvec3 center = bounds.empty() ? glm::dvec3{0.0} : bounds.center();
  distance_m_ = glm::dot(center - view.eye, view.forward);
  target_m_ = view.eye + view.forward * distance_m_;
}

void OrbitCamera::stand(const glm::dvec3& eye, const glm::dvec3& target, double size_m) {
  size_m_ = std::max(size_m, 1e-6);
  distance_m_ = std::max(glm::length(target - eye), 1e-6);
  const glm::dvec3 forward = (target - eye) / distance_m_;
  orbit_ = {.yaw_rad = std::atan2(-forward.x, forward.y), .pitch_rad = std::asin(-forward.z)};
  target_m_ = target;
}

void OrbitCamera::resize(std::uint32_t width_px, std::uint32_t height_px) {
  width_px_ = std::max(1U, width_px);
  height_px_ = std::max(1U, height_px);
}

void OrbitCamera::turn(double dx_px, double dy_px) {
  const double rad_per_px = std::numbers::pi / height_px_;
  orbit_.yaw_rad = std::remainder(orbit_.yaw_rad - dx_px * rad_per_px, 2.0 * std::numbers::pi);
  orbit_.pitch_rad = std::clamp(orbit_.pitch_rad + dy_px * rad_per_px, -steepest_rad, steepest_rad);
}

void OrbitCamera::pan(double dx_px, double dy_px) {
  const View at = view();
  const glm::dvec3 right = glm::normalize(glm::cross(at.forward, at.up));
  const glm::dvec3 up = glm::cross(right, at.forward);
  const double m_per_px = distance_m_ / focal_px(at);
  target_m_ += (up * dy_px - right * dx_px) * m_per_px;
}

void OrbitCamera::zoom(double notches) {
  distance_m_ = std::clamp(distance_m_ * std::pow(0.9, notches), size_m_ * 1e-3, size_m_ * 1e3);
}

View OrbitCamera::view() const {
  View view;
  view.width_px = width_px_;
  view.height_px = height_px_;
  view.fov_y_rad = fov_y_rad;
  view.forward = forward_of(orbit_);
  view.up = glm::dvec3{0.0, 0.0, 1.0};
  view.eye = target_m_ - view.forward * distance_m_;
  return view;
}

}  // namespace lodestone::render
