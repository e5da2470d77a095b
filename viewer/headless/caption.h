// SPDX-License-Identifier: MIT
// Text in pictures.
#pragma once

#include <string>

#include <lodestone/image.h>

namespace lodestone::render {

/// Height of a line of text in pixels.
inline constexpr std::uint32_t caption_height_px = 16;

/// Writes dark text into an RGB image with its upper left corner at (x, y); what lies beyond `end_x_px` or the image is
/// cut off.
void draw_caption(Image& image, std::uint32_t x_px, std::uint32_t y_px, std::uint32_t end_x_px,
                  const std::string& text);

}  // namespace lodestone::render
