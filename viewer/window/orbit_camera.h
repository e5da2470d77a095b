// SPDX-License-Identifier: MIT
// The camera that a mouse turns: it circles a target, moves it in the picture plane, and comes nearer.
#pragma once

#include "../render/camera.h"

namespace lodestone::render {

class OrbitCamera {
 public:
  /// Frames the box in a three-quarter view from this side.
  void frame(const Box& bounds, std::uint32_t width_px, std::uint32_t height_px, double yaw_rad = Orbit{}.yaw_rad);
  /// Stands at `eye` and circles `target`; `size_m` is that of what is seen, the scale of zooming.
  void stand(const glm::dvec3& eye, const glm::dvec3& target, double size_m);
  void resize(std::uint32_t width_px, std::uint32_t height_px);

  /// Mouse moved by so many pixels: a drag over the picture's height is half a turn.
  void turn(double dx_px, double dy_px);
  /// The point under the mouse follows it.
  void pan(double dx_px, double dy_px);
  /// One wheel notch is a tenth nearer or farther; never through the target, never beyond 1000 model sizes.
  void zoom(double notches);

  [[nodiscard]] View view() const;
  [[nodiscard]] double distance_m() const { return distance_m_; }

 private:
  Orbit orbit_;
  glm::dvec3 target_m_{0.0};
  double distance_m_ = 1.0;
  double size_m_ = 1.0;
  std::uint32_t width_px_ = 1;
  std::uint32_t height_px_ = 1;
};

}  // namespace lodestone::render
