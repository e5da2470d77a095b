// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, equations 9 and 11: the optimal level has TD_0 PM(d) of detail.
#include <algorithm>

#include <lodestone/cursor.h>
#include <lodestone/perception.h>

namespace lodestone {

Target Target::perceptual(const DetailFit& fit, double beyond_m) noexcept {
  return ratio(beyond_m > 0.0 ? std::clamp(fit(beyond_m), 0.0, 1.0) : 1.0);
}

}  // namespace lodestone
