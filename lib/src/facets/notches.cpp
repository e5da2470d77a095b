// SPDX-License-Identifier: MIT
#include "facets/notches.h"

#include <algorithm>
#include <cmath>

#include "facets/outline.h"

namespace lodestone::facets {
namespace {

constexpr std::size_t most_corners = 64;
constexpr double straight_cosine = 0.998;  // of the foot of the wall on both sides
constexpr double upright_z = 0.9;          // the wall stands on its foot
constexpr double on_line_m = 0.02;
constexpr double least_height_m = 0.3;

// Without the missing side: what closes it is as far from the wall as in a hole twice as high.
double perimeter_m(const FacetMesh& mesh, const std::vector<std::uint32_t>& loop) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < loop.size(); ++i) sum += glm::length(mesh.at(loop[i]) - mesh.at(loop[i + 1]));
  return sum;
}

}  // namespace

std::vector<Opening> find_notches(const FacetMesh& mesh, const std::vector<std::uint32_t>& outline,
                                  const glm::dvec3& normal) {
  std::vector<Opening> found;
  const std::size_t n = outline.size();
  const auto at = [&](std::size_t i) { return mesh.at(outline[i % n]); };
  const auto side = [&](std::size_t i) { return at(i + 1) - at(i); };
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 before = side(i + n - 1);
    if (glm::length(before) < on_line_m) continue;
    const glm::dvec3 along = glm::normalize(before);
    const glm::dvec3 up = glm::cross(normal, along);
    if (up.z < upright_z || glm::dot(up, side(i)) < on_line_m) continue;
    double highest_m = 0.0;
    for (std::size_t k = 1; k < std::min(most_corners, n - 2); ++k) {
      const glm::dvec3 way = at(i + k) - at(i);
      const double height_m = glm::dot(up, way);
      highest_m = std::max(highest_m, height_m);
      if (height_m > on_line_m) continue;
      const glm::dvec3 after = side(i + k);
      if (height_m < -on_line_m || highest_m < least_height_m || glm::dot(along, way) < on_line_m ||
          glm::dot(along, after) < straight_cosine * glm::length(after)) {
        break;
      }
      Opening notch{.is_notch = true};
      for (std::size_t j = 0; j <= k; ++j) notch.loop.push_back(outline[(i + j) % n]);
      notch.area_m2 = -signed_area(mesh, notch.loop, normal);
      notch.perimeter_m = perimeter_m(mesh, notch.loop);
      if (notch.area_m2 > 0.0) found.push_back(std::move(notch));
      break;
    }
  }
  return found;
}

}  // namespace lodestone::facets
