// SPDX-License-Identifier: MIT
// Cameras that show a whole box, orbiting, and the matrices of a View.
#pragma once

#include <glm/glm.hpp>

#include <lodestone/types.h>
#include <lodestone/view.h>

namespace lodestone::render {

/// Direction a camera looks from: turned about the vertical, then raised.
struct Orbit {
  double yaw_rad = -0.62;   ///< 0 looks north (along +y) from the south; negative moves the eye to the south-west
  double pitch_rad = 0.38;  ///< above the horizon
};

/// The unit direction that a camera on the orbit looks in.
[[nodiscard]] glm::dvec3 forward_of(const Orbit& orbit);

/// A view along the orbit direction, at the distance where `bounds` just fits with a margin of 6 %.
[[nodiscard]] View framed_view(const Box& bounds, const Orbit& orbit, std::uint32_t width_px, std::uint32_t height_px,
                               double fov_y_rad = 0.6);

/// A view along one of the six axis directions, 0..5 = from +x, -x, +y, -y, +z, -z.
[[nodiscard]] View axis_view(const Box& bounds, int direction, std::uint32_t width_px, std::uint32_t height_px);

/// From `eye` towards `target`, Z up.
[[nodiscard]] View look_at(const glm::dvec3& eye, const glm::dvec3& target, std::uint32_t width_px,
                           std::uint32_t height_px, double fov_y_rad);

/// Frame of the thing viewed -> eye space (looking along -z).
[[nodiscard]] glm::dmat4 view_matrix(const View& view);

/// Eye space -> clip space. Near and far enclose `bounds`.
[[nodiscard]] glm::dmat4 projection_matrix(const View& view, const Box& bounds);

}  // namespace lodestone::render
