// SPDX-License-Identifier: MIT
// Sizes of images from their heads: within the limit, no more than the file can hold, and those of the decoded picture.
#include "doors.h"
#include "images/codecs.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  constexpr std::uint64_t most_pixels = 1U << 20U;
  const std::string name = "fuzz.tga";  // others are told by their first bytes
  const auto start = image_head({data, size / 2}, size, name, most_pixels);
  const auto head = image_head({data, size}, size, name, most_pixels);
  for (const auto& one : {start, head}) {
    if (!one) {
      if (one.error().message.empty()) __builtin_trap();
      continue;
    }
    const double pixels = static_cast<double>(one->size.x) * one->size.y;
    if (!(pixels >= 1.0 && pixels <= double{most_pixels})) __builtin_trap();
    if (pixels > one->byte_pixels * static_cast<double>(size) || !(one->decode_bytes >= 1.0)) __builtin_trap();
  }
  const auto image = decode_image({data, size}, name, most_pixels);
  if (image && (!head || image->width != head->size.x || image->height != head->size.y)) __builtin_trap();
  return 0;
}
