// SPDX-License-Identifier: MIT
// The only file that names stb_image, compiled here with just the formats that nobody else of ours reads.
#include <algorithm>
#include <iterator>
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

// Bytes that stb asks for piece by piece. From memory it would take zeros for what is cut off.
struct Source {
  ByteSpan bytes;
  std::size_t at = 0;
  bool cut_off = false;
};

int read_some(void* user, char* out, int wanted) {
  auto& source = *static_cast<Source*>(user);
  constexpr int ahead = 128;  // so many it asks for as there may be; of anything else it needs each
  const std::size_t left = source.bytes.size() - source.at;
  const std::size_t count = std::min(left, static_cast<std::size_t>(wanted));
  if (count == 0 || (wanted != ahead && count < static_cast<std::size_t>(wanted))) source.cut_off = true;
  std::copy_n(source.bytes.begin() + static_cast<std::ptrdiff_t>(source.at), count, out);
  source.at += count;
  return static_cast<int>(count);
}

// Back, too. Beyond the end without complaint: some writers leave out what only fills the last row up.
void skip_some(void* user, int count) {
  auto& source = *static_cast<Source*>(user);
  const auto target = static_cast<std::ptrdiff_t>(source.at) + count;
  source.at = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(target, 0, std::ssize(source.bytes)));
}

int at_end(void* user) {
  const auto& source = *static_cast<const Source*>(user);
  return source.at >= source.bytes.size() ? 1 : 0;
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
  const std::string type = image_mime_type(bytes);
  ImageHead result{.size = {head->width, head->height}, .decode_bytes = 2.0 * head->channels};
  if (type == "image/gif") {
    result.decode_bytes = gif;  // a frame may be smaller than the picture, so its bytes say nothing
  } else if (type == "image/bmp") {
    result.byte_pixels = 8.0;  // black and white
  } else {
    constexpr std::uint8_t packed = 8;
    const bool plain = bytes[2] < packed;
    result.byte_pixels = plain ? 8.0 / std::max<double>(bytes[16], 8.0) : 64.0;  // 128 of a grey in two bytes
  }
  return result;
}

Result<Image> decode_stb(ByteSpan bytes, std::uint64_t max_pixels) {
  const auto head = read_head(bytes);
  if (!head) return head.error();
  auto [width, height, channels] = *head;
  if (auto fits = check_image_size(width, height, max_pixels); !fits) return fits.error();
  Source source{bytes};
  const stbi_io_callbacks reading{read_some, skip_some, at_end};
  const std::unique_ptr<stbi_uc, Free> pixels{
      stbi_load_from_callbacks(&reading, &source, &width, &height, &channels, 0)};
  if (!pixels || source.cut_off) {
    const char* reason = stbi_failure_reason();
    if (!pixels && reason != nullptr && std::string_view{reason} == "outofmem") return no_memory_for(width, height);
    return Error{ErrorCode::BadData, "the image data is damaged or cut off", {}};
  }
  Image image{
      static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), static_cast<std::uint32_t>(channels), {}};
  image.pixels.assign(pixels.get(), pixels.get() + static_cast<std::size_t>(width) * height * channels);
  return image;
}

}  // namespace lodestone
