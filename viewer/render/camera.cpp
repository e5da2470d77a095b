// SPDX-License-Identifier: MIT
#include "camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

namespace lodestone::render {
namespace {

constexpr double margin_ratio = 1.06;

struct Extent {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
};

// Places the eye so that every corner of the box is inside the picture, as near as that allows, and the corners'
// outline is in its middle. Each turn backs off exactly, then centres; three suffice.
View fitted(View view, const Box& bounds) {
  const glm::dvec3 right = glm::normalize(glm::cross(view.forward, view.up));
  const glm::dvec3 up = glm::cross(right, view.forward);
  const double tan_y = std::tan(view.fov_y_rad * 0.5) / margin_ratio;
  const double tan_x = tan_y * view.width_px / view.height_px;
  glm::dvec3 aim = bounds.center();
  for (int turn = 0; turn < 4; ++turn) {
    double distance_m = 1e-3;
    std::array<glm::dvec3, 8> corners{};  // right, up, forward about the aim
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 p{(i & 1) != 0 ? bounds.max.x : bounds.min.x, (i & 2) != 0 ? bounds.max.y : bounds.min.y,
                         (i & 4) != 0 ? bounds.max.z : bounds.min.z};
      const glm::dvec3 d = p - aim;
      corners[i] = {glm::dot(d, right), glm::dot(d, up), glm::dot(d, view.forward)};
      const double needed_m = std::max(std::abs(corners[i].x) / tan_x, std::abs(corners[i].y) / tan_y);
      distance_m = std::max(distance_m, needed_m - corners[i].z);
    }
    view.eye = aim - view.forward * distance_m;
    Extent x;
    Extent y;
    for (const glm::dvec3& c : corners) {
      x.add(c.x / (distance_m + c.z));
      y.add(c.y / (distance_m + c.z));
    }
    aim += (right * (x.min + x.max) + up * (y.min + y.max)) * (0.5 * distance_m);
  }
  return view;
}

// An empty or flat-point box is given some room, so that every view is valid.
Box with_room(const Box& bounds) {
  if (bounds.empty()) return Box{glm::dvec3{-1.0}, glm::dvec3{1.0}};
  if (bounds.diagonal_m() > 0.0) return bounds;
  return Box{bounds.min - glm::dvec3{0.5}, bounds.max + glm::dvec3{0.5}};
}

}  // namespace

glm::dvec3 forward_of(const Orbit& orbit) {
  return {-std::sin(orbit.yaw_rad) * std::cos(orbit.pitch_rad), std::cos(orbit.yaw_rad) * std::cos(orbit.pitch_rad),
          -std::sin(orbit.pitch_rad)};
}

View framed_view(const Box& bounds, const Orbit& orbit, std::uint32_t width_px, std::uint32_t height_px,
                 double fov_y_rad) {
  View view;
  view.width_px = width_px;
  view.height_px = height_px;
  view.fov_y_rad = fov_y_rad;
  view.forward = forward_of(orbit);
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
