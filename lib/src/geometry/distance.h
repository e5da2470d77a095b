// SPDX-License-Identifier: MIT
// Squared distances from a point; every one is right for degenerate shapes as well.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>

namespace lodestone {

[[nodiscard]] inline double squared_length(const glm::dvec3& v) noexcept { return glm::dot(v, v); }

// Place on the segment a + t * ab nearest to a + ap, 0 <= t <= 1.
[[nodiscard]] inline double nearest_on_segment(const glm::dvec3& ap, const glm::dvec3& ab) noexcept {
  const double length2 = squared_length(ab);
  return length2 > 0.0 ? std::clamp(glm::dot(ap, ab) / length2, 0.0, 1.0) : 0.0;
}

[[nodiscard]] inline double squared_distance_to_segment(const glm::dvec3& p, const glm::dvec3& a,
                                                        const glm::dvec3& b) noexcept {
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ap = p - a;
  return squared_length(ap - nearest_on_segment(ap, ab) * ab);
}

[[nodiscard]] inline double squared_distance_to_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                                         const glm::dvec3& c) noexcept {
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ap = p - a;
  const glm::dvec3 n = glm::cross(ab, c - a);
  const double n2 = squared_length(n);
  if (!(n2 > 0.0)) {
    return std::min({squared_distance_to_segment(p, a, b), squared_distance_to_segment(p, b, c),
                     squared_distance_to_segment(p, c, a)});
  }
  // Outside a triangle the nearest point lies on a side that has p on its outer side.
  const bool outside_ab = glm::dot(glm::cross(ab, ap), n) < 0.0;
  const bool outside_bc = glm::dot(glm::cross(c - b, p - b), n) < 0.0;
  const bool outside_ca = glm::dot(glm::cross(a - c, p - c), n) < 0.0;
  if (!outside_ab && !outside_bc && !outside_ca) {
    const double height = glm::dot(ap, n);
    return height * height / n2;
  }
  double best = outside_ab ? squared_distance_to_segment(p, a, b) : std::numeric_limits<double>::infinity();
  if (outside_bc) best = std::min(best, squared_distance_to_segment(p, b, c));
  if (outside_ca) best = std::min(best, squared_distance_to_segment(p, c, a));
  return best;
}

}  // namespace lodestone
