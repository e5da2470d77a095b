// SPDX-License-Identifier: MIT
// Small copies of pictures, to be shown until the whole ones are there.
#include <algorithm>

#include <lodestone/formats.h>

#include "codecs.h"
#include "reader.h"

namespace lodestone {
namespace {

// Means of the pixels that fall into each of the smaller ones.
Image averaged(const Image& image, std::uint32_t width, std::uint32_t height) {
  Image small{width, height, image.channels, {}};
  small.pixels.reserve(static_cast<std::size_t>(width) * height * image.channels);
  const auto range = [](std::uint64_t i, std::uint64_t from, std::uint64_t to) {
    return std::pair{static_cast<std::uint32_t>(i * from / to), static_cast<std::uint32_t>((i + 1) * from / to)};
  };
  for (std::uint32_t y = 0; y < height; ++y) {
    const auto [top, bottom] = range(y, image.height, height);
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto [left, right] = range(x, image.width, width);
      const std::uint64_t count = static_cast<std::uint64_t>(right - left) * (bottom - top);
      for (std::uint32_t c = 0; c < image.channels; ++c) {
        std::uint64_t sum = count / 2;
        for (std::uint32_t v = top; v < bottom; ++v) {
          for (std::uint32_t u = left; u < right; ++u) sum += image.at(u, v)[c];
        }
        small.pixels.push_back(static_cast<std::uint8_t>(sum / count));
      }
    }
  }
  return small;
}

}  // namespace

Result<Bytes> encode_preview(ByteSpan bytes, const std::string& source, std::uint32_t longest) {
  constexpr int quality = 60;
  const std::uint64_t max_pixels = ReadOptions{}.max_texture_pixels;
  auto image = image_mime_type(bytes) == "image/jpeg" ? decode_jpeg(bytes, max_pixels, longest)
                                                      : decode_image(bytes, source, max_pixels);
  if (!image) return image.error();
  const std::uint32_t longer = std::max(image->width, image->height);
  const auto scaled = [&](std::uint32_t size) {
    return std::max(1U, static_cast<std::uint32_t>(std::uint64_t{size} * std::min(longest, longer) / longer));
  };
  const Image small = averaged(*image, scaled(image->width), scaled(image->height));
  const bool alpha = small.channels == 2 || small.channels == 4;
  return alpha ? encode_png(small) : encode_jpeg(small, quality);
}

}  // namespace lodestone
