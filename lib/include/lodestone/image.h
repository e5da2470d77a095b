// SPDX-License-Identifier: MIT
/// \file
/// Pixels, without codecs (those are in `formats`). Row 0 is the top row, as in image files; rows are tightly packed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lodestone {

/// 8-bit image; 1 = grey, 2 = grey + alpha, 3 = RGB, 4 = RGBA; sRGB, straight alpha.
struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t channels = 0;
  std::vector<std::uint8_t> pixels;  ///< width * height * channels bytes

  [[nodiscard]] bool empty() const noexcept { return pixels.empty(); }
  [[nodiscard]] const std::uint8_t* at(std::uint32_t x, std::uint32_t y) const noexcept {
    return pixels.data() + (static_cast<std::size_t>(y) * width + x) * channels;
  }
  [[nodiscard]] std::uint8_t* at(std::uint32_t x, std::uint32_t y) noexcept {
    return pixels.data() + (static_cast<std::size_t>(y) * width + x) * channels;
  }
};

}  // namespace lodestone
