// SPDX-License-Identifier: MIT
// The only file that names stb_image, compiled here with just the formats that nobody else of ours reads.
#include <limits>
#include <memory>
#include <string_view>

#include "codecs.h"
#include "reader.h"

// NOLINTBEGIN(readability-identifier-naming): names of stb
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_ONLY_GIF
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
// NOLINTEND(readability-identifier-naming)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace lodestone {
namespace {

struct StbHead {
  int width = 0;
  int height = 0;
  int channels = 0;
};

Result<StbHead> read_head(ByteSpan bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return Error{ErrorCode::TooLarge, "the image file is larger than 2 GB", {}};
  }
  StbHead head;
  const int size = static_cast<int>(bytes.size());
  if (stbi_info_from_memory(bytes.data(), size, &head.width, &head.height, &head.channels) == 0) {
    return Error{ErrorCode::BadData, "the image header is broken", {}};
  }
  return head;
}

struct Free {
  void operator()(stbi_uc* pixels) const noexcept { stbi_image_free(pixels); }
};

}  // namespace

Result<ImageHead> stb_head(ByteSpan bytes) {
  const auto head = read_head(bytes);
  if (!head) return head.error();
  if (head->width <= 0 || head->height <= 0) return Error{ErrorCode::BadData, "the image has no pixels", {}};
  constexpr double gif = 9.0;  // frame, background and which pixels were drawn
  const bool is_gif = image_mime_type(bytes) == "image/gif";
  return ImageHead{{static_cast<std::uint32_t>(head->width), static_cast<std::uint32_t>(head->height)},
                   is_gif ? gif : 2.0 * head->channels};
}

Result<Image> decode_stb(ByteSpan bytes, std::uint64_t max_pixels) {
  const auto head = read_head(bytes);
  if (!head) return head.error();
  auto [width, height, channels] = *head;
  if (auto fits = check_image_size(width, height, max_pixels); !fits) return fits.error();
  const int size = static_cast<int>(bytes.size());
  const std::unique_ptr<stbi_uc, Free> pixels{stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 0)};
  if (!pixels) {
    const char* reason = stbi_failure_reason();
    if (reason != nullptr && std::string_view{reason} == "outofmem") return no_memory_for(width, height);
    return Error{ErrorCode::BadData, "the image data is damaged or cut off", {}};
  }
  Image image{
      static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), static_cast<std::uint32_t>(channels), {}};
  image.pixels.assign(pixels.get(), pixels.get() + static_cast<std::size_t>(width) * height * channels);
  return image;
}

}  // namespace lodestone
