// SPDX-License-Identifier: MIT
#include "doors.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto image = lodestone::decode_image({data, size}, "fuzz", 1U << 20U);
  if (image.ok()) {
    const std::size_t expected = static_cast<std::size_t>(image->width) * image->height * image->channels;
    if (image->pixels.size() != expected || expected == 0) __builtin_trap();
  }
  return 0;
}
