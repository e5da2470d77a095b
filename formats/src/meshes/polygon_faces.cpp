// SPDX-License-Identifier: MIT
#include "polygon_faces.h"

#include <lodestone/polygon.h>

namespace lodestone {
namespace {

// Newell's normal: twice the area, whatever the shape.
glm::dvec3 area_vector(std::span<const glm::dvec3> points) {
  glm::dvec3 sum{0.0};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    sum += glm::cross(points[i] - points[0], points[i + 1] - points[0]);
  }
  return sum;
}

bool sees_all(std::span<const glm::dvec3> points, std::size_t apex, const glm::dvec3& normal) {
  const std::size_t n = points.size();
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const glm::dvec3 a = points[(apex + i) % n] - points[apex];
    const glm::dvec3 b = points[(apex + i + 1) % n] - points[apex];
    if (!(glm::dot(glm::cross(a, b), normal) >= 0.0)) return false;
  }
  return true;
}

}  // namespace

void split_polygon(std::span<const glm::dvec3> points, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  triangles.clear();
  const auto n = static_cast<std::uint32_t>(points.size());
  if (n < 3) return;
  std::uint32_t apex = 0;
  if (n > 3) {
    const glm::dvec3 normal = area_vector(points);
    constexpr std::uint32_t most_tries = 8;
    while (apex < n && apex < most_tries && !sees_all(points, apex, normal)) ++apex;
    if (apex == n || apex == most_tries) {
      triangles = triangulate_polygon(points, std::span{&n, 1});
      if (!triangles.empty()) return;
      apex = 0;  // no area at all: keep it as the degenerate faces that the source has
    }
  }
  for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({apex, (apex + i) % n, (apex + i + 1) % n});
}

}  // namespace lodestone
