// SPDX-License-Identifier: MIT
// Small helpers around generated images.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <lodestone/context.h>
#include <lodestone/generate.h>
#include <lodestone/mesh.h>

#include "generate/sheet.h"

namespace lodestone::generate {

[[nodiscard]] inline Image blank(std::uint32_t size_px) {
  Image image;
  image.width = size_px;
  image.height = size_px;
  image.channels = 3;
  image.pixels.assign(std::size_t{3} * size_px * size_px, 128);
  return image;
}

// `color` in sRGB, 0..1, clamped.
inline void put(Image& image, std::uint32_t x, std::uint32_t y, const glm::vec3& color) noexcept {
  std::uint8_t* texel = image.at(x, y);
  for (int c = 0; c < 3; ++c)
    texel[c] = static_cast<std::uint8_t>(std::lround(std::clamp(color[c], 0.0F, 1.0F) * 255.0F));
}

// Completes a sheet: its pixels, if they are wanted.
template <class MakeImage>
[[nodiscard]] Result<Mesh> with_pixels(Mesh mesh, const GenerateOptions& options, const Context& context,
                                       MakeImage make_image) {
  for (std::uint32_t i = 0; options.pixels == Pixels::Make && i < mesh.textures.size(); ++i) {
    if (context.cancelled()) break;
    context.report("painting", static_cast<double>(i) / static_cast<double>(mesh.textures.size()));
    mesh.textures[i].image = std::make_shared<const Image>(make_image(options, i, context));
  }
  return finish(std::move(mesh), options, context);
}

}  // namespace lodestone::generate
