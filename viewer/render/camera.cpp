// SPDX-License-Identifier: MIT
#include "camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace lodestone::render {
namespace {

constexpr double margin_ratio = 1.06;

// Moves the eye back along `forward` until every corner of the box is inside the picture.
View fitted(View view, const Box& bounds) {
  const glm::dvec3 center = bounds.center();
  const glm::dvec3 right = glm::normalize(glm::cross(view.forward, view.up));
  const glm::dvec3 up = glm::cross(right, view.forward);
  const double tan_y = std::tan(view.fov_y_rad * 0.5) / margin_ratio;
  const double tan_x = tan_y * view.width_px / view.height_px;
  double distance_m = 1e-3;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p{(corner & 1) != 0 ? bounds.max.x : bounds.min.x, (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                       (corner & 4) != 0 ? bounds.max.z : bounds.min.z};
    const glm::dvec3 d = p - center;
    const double needed = std::max(std::abs(glm::dot(d, right)) / tan_x, std::abs(glm::dot(d, up)) / tan_y);
    distance_m = std::max(distance_m, needed - glm::dot(d, view.forward));
  }
  view.eye = center - view.forward * distance_m;
  return view;
}

// An empty or flat-point box is given some room, so that every view is valid.
Box with_room(const Box& bounds) {
  if (bounds.empty()) return Box{glm::dvec3{-1.0}, glm::dvec3{1.0}};
  if (bounds.diagonal_m() > 0.0) return bounds;
  return Box{bounds.min - glm::dvec3{0.5}, bounds.max + glm::dvec3{0.5}};
}

}  // namespace

View framed_view(const Box& bounds, const Orbit& orbit, std::uint32_t width_px, std::uint32_t height_px,
                 double fov_y_rad) {
  View view;
  view.width_px = width_px;
  view.height_px = height_px;
  view.fov_y_rad = fov_y_rad;
  view.forward = glm::dvec3{-std::sin(orbit.yaw_rad) * std::cos(orbit.pitch_rad),
                            std::cos(orbit.yaw_rad) * std::cos(orbit.pitch_rad), -std::sin(orbit.pitch_rad)};
  view.up = glm::dvec3{0.0, 0.0, 1.0};
  return fitted(view, with_room(bounds));
}

View axis_view(const Box& bounds, int direction, std::uint32_t width_px, std::uint32_t height_px) {
  View view;
  view.width_px = width_px;
  view.height_px = height_px;
  view.fov_y_rad = 0.35;
  view.forward = glm::dvec3{0.0};
  view.forward[direction / 2] = direction % 2 == 0 ? -1.0 : 1.0;
  view.up = direction / 2 == 2 ? glm::dvec3{0.0, 1.0, 0.0} : glm::dvec3{0.0, 0.0, 1.0};
  return fitted(view, with_room(bounds));
}

View look_at(const glm::dvec3& eye, const glm::dvec3& target, std::uint32_t width_px, std::uint32_t height_px,
             double fov_y_rad) {
  View view;
  view.width_px = width_px;
  view.height_px = height_px;
  view.fov_y_rad = fov_y_rad;
  view.eye = eye;
  const glm::dvec3 toward = target - eye;
  const double length_m = glm::length(toward);
  if (length_m > 0.0) view.forward = toward / length_m;
  const bool vertical = std::abs(view.forward.z) > 0.9999;
  view.up = vertical ? glm::dvec3{0.0, 1.0, 0.0} : glm::dvec3{0.0, 0.0, 1.0};
  return view;
}

glm::dmat4 view_matrix(const View& view) { return glm::lookAt(view.eye, view.eye + view.forward, view.up); }

glm::dmat4 projection_matrix(const View& view, const Box& bounds) {
  const Box box = with_room(bounds);
  const double depth_m = glm::dot(box.center() - view.eye, view.forward);
  const double radius_m = box.diagonal_m() * 0.5;
  const double far_m = std::max(depth_m + radius_m, view.near_m * 2.0) * 1.01;
  const double near_m = std::clamp((depth_m - radius_m) * 0.99, std::max(view.near_m, far_m * 2e-4), far_m * 0.99);
  const double aspect = static_cast<double>(view.width_px) / view.height_px;
  return glm::perspective(view.fov_y_rad, aspect, near_m, far_m);
}

}  // namespace lodestone::render
