// SPDX-License-Identifier: MIT
// Places that are finite numbers and yet damaged ones: so far from all others that floats are metres apart there.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include <lodestone/types.h>

namespace lodestone {

constexpr double near_enough = 1e7;  // metres, or units of the file: nothing within is ever taken for astray

// Around the middle of most places, as far as they may reach.
struct Whereabouts {
  glm::dvec3 middle{0.0};
  double reach = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool hold(const glm::dvec3& place) const noexcept { return glm::distance(place, middle) <= reach; }
};

// The medians of `places` (finite ones) and a thousand times their median distance, `near_enough` at least.
[[nodiscard]] Whereabouts whereabouts_of(const std::vector<glm::dvec3>& places);

// The box of the `count` places `at(i)` without those that are not finite or astray.
template <class At>
[[nodiscard]] Box box_without_strays(std::size_t count, const At& at) {
  const auto finite = [](const glm::dvec3& p) { return std::isfinite(p.x + p.y + p.z); };
  Box all;
  for (std::size_t i = 0; i < count; ++i) {
    if (const glm::dvec3 place = at(i); finite(place)) all.add(place);
  }
  if (all.empty() || !(all.diagonal_m() > near_enough)) return all;
  std::vector<glm::dvec3> places;
  for (std::size_t i = 0; i < count; ++i) {
    if (const glm::dvec3 place = at(i); finite(place)) places.push_back(place);
  }
  const Whereabouts whereabouts = whereabouts_of(places);
  Box box;
  for (const glm::dvec3& place : places) {
    if (whereabouts.hold(place)) box.add(place);
  }
  return box;
}

}  // namespace lodestone
