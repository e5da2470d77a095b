// SPDX-License-Identifier: MIT
// When one sphere encloses another, by the same arithmetic wherever it is asked.
#pragma once

#include <lodestone/types.h>

namespace lodestone {

// The radius that `outer` needs, around its centre, to enclose `inner`.
[[nodiscard]] inline double reach_m(const Sphere& outer, const Sphere& inner) noexcept {
  return glm::length(outer.center - inner.center) + inner.radius_m;
}

[[nodiscard]] inline bool encloses(const Sphere& outer, const Sphere& inner) noexcept {
  return reach_m(outer, inner) <= outer.radius_m;
}

}  // namespace lodestone
