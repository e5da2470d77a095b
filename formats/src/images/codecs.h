// SPDX-License-Identifier: MIT
// One pair of functions per image library; images.cpp chooses among them. Decoders give pixels as they are meant to be
// seen, or an Error without a place: the caller knows the file's name.
#pragma once

#include <cstdint>
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
// Upright, from the head of a file.
[[nodiscard]] Result<glm::uvec2> jpeg_size(ByteSpan bytes);
// The most bytes a pixel that decode_jpeg() holds, from the head of a file.
[[nodiscard]] double jpeg_decode_bytes(ByteSpan bytes);
// From the head of a file: its size, and the most bytes a pixel that decoding holds.
struct ImageHead {
  glm::uvec2 size{0};
  double decode_bytes = 0.0;
};
[[nodiscard]] Result<ImageHead> webp_head(ByteSpan bytes);
[[nodiscard]] Result<ImageHead> stb_head(ByteSpan bytes);
[[nodiscard]] Result<Image> decode_png(ByteSpan bytes, std::uint64_t max_pixels);
[[nodiscard]] Result<Image> decode_webp(ByteSpan bytes, std::uint64_t max_pixels);
[[nodiscard]] Result<Image> decode_stb(ByteSpan bytes, std::uint64_t max_pixels);

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
