// SPDX-License-Identifier: MIT
// A box around points as they are stored, half the size of `Box`: for what is kept or asked by the hundred thousand.
#pragma once

#include <limits>

#include <glm/glm.hpp>

namespace lodestone::facets {

// Empty until something is added.
struct FloatBox {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& p) noexcept {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  [[nodiscard]] bool contains(const glm::vec3& p) const noexcept {
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
  }
  [[nodiscard]] bool touches(const FloatBox& b) const noexcept {
    return low.x <= b.high.x && high.x >= b.low.x && low.y <= b.high.y && high.y >= b.low.y && low.z <= b.high.z &&
           high.z >= b.low.z;
  }
  [[nodiscard]] double squared_distance(const glm::dvec3& p) const noexcept {
    const glm::dvec3 d = glm::max(glm::max(glm::dvec3{low} - p, p - glm::dvec3{high}), glm::dvec3{0.0});
    return glm::dot(d, d);
  }
  [[nodiscard]] double squared_distance(const FloatBox& b) const noexcept {
    const glm::dvec3 d =
        glm::max(glm::max(glm::dvec3{low} - glm::dvec3{b.high}, glm::dvec3{b.low} - glm::dvec3{high}), glm::dvec3{0.0});
    return glm::dot(d, d);
  }
};

}  // namespace lodestone::facets
