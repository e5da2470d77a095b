// SPDX-License-Identifier: MIT
// Luminance of a pixel: Rec. 709 weights on the 8-bit values, as the eye model takes it.
#pragma once

#include <cmath>
#include <cstdint>

#include <lodestone/image.h>

namespace lodestone::perception {

[[nodiscard]] inline float luminance(const Image& image, std::size_t pixel) noexcept {
  const std::uint8_t* p = image.pixels.data() + pixel * image.channels;
  if (image.channels < 3) return static_cast<float>(p[0]);
  return 0.2126F * static_cast<float>(p[0]) + 0.7152F * static_cast<float>(p[1]) + 0.0722F * static_cast<float>(p[2]);
}

/// Rounded, so that it can be compared with a simulated picture.
[[nodiscard]] inline std::uint8_t grey(const Image& image, std::size_t pixel) noexcept {
  return static_cast<std::uint8_t>(std::lround(luminance(image, pixel)));
}

}  // namespace lodestone::perception
