// SPDX-License-Identifier: MIT
#include "strays.h"

#include <algorithm>

namespace lodestone {
namespace {

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Whereabouts whereabouts_of(const std::vector<glm::dvec3>& places) {
  constexpr double usual_distances = 1000.0;
  Whereabouts out;
  if (places.empty()) return out;
  std::vector<double> values(places.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(places.begin(), places.end(), values.begin(), [&](const glm::dvec3& p) { return p[axis]; });
    out.middle[axis] = median(values);
  }
  std::transform(places.begin(), places.end(), values.begin(),
                 [&](const glm::dvec3& p) { return glm::distance(p, out.middle); });
  out.reach = std::max(near_enough, usual_distances * median(values));
  return out;
}

}  // namespace lodestone
