// SPDX-License-Identifier: MIT
// glTF's factors and vertex colours are linear; ours are sRGB as the eye sees them.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace lodestone {

[[nodiscard]] inline double srgb_to_linear(double c) noexcept {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

[[nodiscard]] inline double linear_to_srgb(double c) noexcept {
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.0031308 ? c * 12.92 : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
}

}  // namespace lodestone
