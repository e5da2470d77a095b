// SPDX-License-Identifier: MIT
// Uses the font that Dear ImGui carries, rasterised without a window.
#include "caption.h"

#include <imgui.h>

#include <algorithm>

namespace lodestone::render {
namespace {

// Built once, never changed after.
const ImFontAtlas& font_atlas() {
  static ImFontAtlas atlas;
  static const bool built = [] {
    ImFontConfig config;
    config.SizePixels = 13.0F;  // the size this bitmap-like font is sharp at
    config.OversampleH = 1;
    config.OversampleV = 1;
    config.PixelSnapH = true;
    atlas.AddFontDefault(&config);
    return atlas.Build();
  }();
  static_cast<void>(built);
  return atlas;
}

}  // namespace

void draw_caption(Image& image, std::uint32_t x_px, std::uint32_t y_px, std::uint32_t end_x_px,
                  const std::string& text) {
  const int end_x = static_cast<int>(std::min(end_x_px, image.width));
  const ImFontAtlas& atlas = font_atlas();
  const ImFont& font = *atlas.Fonts[0];
  float pen_px = static_cast<float>(x_px);
  for (const char c : text) {
    const ImFontGlyph* glyph = font.FindGlyph(static_cast<ImWchar>(static_cast<unsigned char>(c)));
    if (glyph == nullptr) continue;
    const int width = static_cast<int>(glyph->X1 - glyph->X0);
    const int height = static_cast<int>(glyph->Y1 - glyph->Y0);
    const int from_x = static_cast<int>(glyph->U0 * static_cast<float>(atlas.TexWidth) + 0.5F);
    const int from_y = static_cast<int>(glyph->V0 * static_cast<float>(atlas.TexHeight) + 0.5F);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int to_x = static_cast<int>(pen_px + glyph->X0) + x;
        const int to_y = static_cast<int>(static_cast<float>(y_px) + glyph->Y0) + y;
        if (to_x < 0 || to_y < 0 || to_x >= end_x || to_y >= static_cast<int>(image.height)) {
          continue;
        }
        const int ink = atlas.TexPixelsAlpha8[(from_y + y) * atlas.TexWidth + from_x + x];
        std::uint8_t* pixel = image.at(static_cast<std::uint32_t>(to_x), static_cast<std::uint32_t>(to_y));
        for (int channel = 0; channel < 3; ++channel) {
          pixel[channel] = static_cast<std::uint8_t>(pixel[channel] + (40 - pixel[channel]) * ink / 255);
        }
      }
    }
    pen_px += glyph->AdvanceX;
  }
}

}  // namespace lodestone::render
