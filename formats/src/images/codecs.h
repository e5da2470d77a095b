// SPDX-License-Identifier: MIT
// One pair of functions per image library; images.cpp chooses among them. Decoders give pixels as they are meant to be
// seen, or an Error without a place: the caller knows the file's name.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <lodestone/image.h>
#include <lodestone/result.h>
#include <lodestone/types.h>

namespace lodestone {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

// With `at_least` not 0 possibly smaller: down to an eighth, its longer side at least so many pixels.
[[nodiscard]] Result<Image> decode_jpeg(ByteSpan bytes, std::uint64_t max_pixels, std::uint32_t at_least = 0);
[[nodiscard]] Result<Image> decode_png(ByteSpan bytes, std::uint64_t max_pixels);
[[nodiscard]] Result<Image> decode_webp(ByteSpan bytes, std::uint64_t max_pixels);
[[nodiscard]] Result<Image> decode_stb(ByteSpan bytes, std::uint64_t max_pixels);

// What the first bytes of a file say.
struct ImageHead {
  glm::uvec2 size{0};                                            // upright
  double decode_bytes = 0.0;                                     // a pixel, the most that decoding holds
  double byte_pixels = std::numeric_limits<double>::infinity();  // the most that a byte of the file stands for
};
[[nodiscard]] Result<ImageHead> jpeg_head(ByteSpan bytes);
[[nodiscard]] Result<ImageHead> png_head(ByteSpan bytes);
[[nodiscard]] Result<ImageHead> webp_head(ByteSpan bytes);
[[nodiscard]] Result<ImageHead> stb_head(ByteSpan bytes);
// Of any kind. Errors as those of decode_image(), which begins with it: more than `max_pixels`, or more than a file of
// so many bytes can hold, among them; or a head that is longer than the bytes given.
[[nodiscard]] Result<ImageHead> image_head(ByteSpan bytes, std::uint64_t file_bytes, const std::string& source,
                                           std::uint64_t max_pixels);

// The picture with its longer side at most `longest` pixels, as JPEG, or PNG where it has alpha.
[[nodiscard]] Result<Bytes> encode_preview(ByteSpan bytes, const std::string& source, std::uint32_t longest);

// Nothing if the size is fine; else TooLarge or, for an empty image, BadData.
[[nodiscard]] Status check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_pixels);

// TooLarge: a decoder got no memory, which is no damage.
[[nodiscard]] Error no_memory_for(std::uint64_t width, std::uint64_t height);

// The same picture with 3 or 4 channels.
[[nodiscard]] Image widened_to_rgb(const Image& image);

// EXIF orientation 1..8 undone, so that the first row is the top one.
[[nodiscard]] Image upright(Image image, int exif_orientation);

}  // namespace lodestone
