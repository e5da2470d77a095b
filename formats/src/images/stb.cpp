// SPDX-License-Identifier: MIT
// The only file that names stb_image, compiled here with just the formats that nobody else of ours reads.
#include <limits>

#include "codecs.h"

// NOLINTBEGIN(readability-identifier-naming): names of stb
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_GIF
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_NO_FAILURE_STRINGS
// NOLINTEND(readability-identifier-naming)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace lodestone {

Result<Image> decode_stb(ByteSpan bytes, std::uint64_t max_pixels) {
  int width = 0;
  int height = 0;
  int channels = 0;
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return Error{ErrorCode::TooLarge, "the image file is larger than 2 GB", {}};
  }
  const int size = static_cast<int>(bytes.size());
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
    return Error{ErrorCode::BadData, "the image header is broken", {}};
  }
  if (auto fits = check_image_size(width, height, max_pixels); !fits) return fits.error();
  stbi_uc* pixels = stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 0);
  if (pixels == nullptr) return Error{ErrorCode::BadData, "the image data is damaged or cut off", {}};
  Image image{
      static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), static_cast<std::uint32_t>(channels), {}};
  image.pixels.assign(pixels, pixels + static_cast<std::size_t>(width) * height * channels);
  stbi_image_free(pixels);
  return image;
}

}  // namespace lodestone
