// SPDX-License-Identifier: MIT
#include "detailed_side.h"

#include <array>
#include <numbers>

namespace lodestone::render {

double detailed_yaw_rad(const DrawArrays& arrays) {
  const double usual = Orbit{}.yaw_rad;
  const std::array<double, 4> yaws{usual, -usual, std::numbers::pi + usual, std::numbers::pi - usual};
  std::array<glm::vec3, 4> toward{};
  for (std::size_t i = 0; i < yaws.size(); ++i)
    toward[i] = -glm::vec3{forward_of({.yaw_rad = yaws[i], .pitch_rad = 0.0})};
  std::array<double, 4> facing{};
  for (const DrawRange& draw : arrays.draws) {
    for (std::uint32_t i = draw.first_index; i < draw.first_index + draw.index_count; i += 3) {
      const glm::vec3 a = arrays.positions[arrays.index(i)];
      const glm::vec3 n =
          glm::cross(arrays.positions[arrays.index(i + 1)] - a, arrays.positions[arrays.index(i + 2)] - a);
      const float length = glm::length(n);
      if (!(length > 0.0F)) continue;
      for (std::size_t side = 0; side < facing.size(); ++side) {
        facing[side] += static_cast<double>(std::max(0.0F, glm::dot(n, toward[side]) / length));
      }
    }
  }
  std::size_t best = 0;
  for (std::size_t side = 1; side < facing.size(); ++side) {
    const double bar = best == 0 ? facing[0] * 1.1 : facing[best];
    if (facing[side] > bar) best = side;
  }
  return yaws[best];
}

}  // namespace lodestone::render
