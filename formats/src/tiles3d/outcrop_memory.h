// SPDX-License-Identifier: MIT
// What writing an outcrop will take, told before work begins, and how many may work at once within a limit.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <lodestone/tileset_writer.h>

namespace lodestone {

// An image before it is decoded.
struct Photograph {
  TextureInfo info;
  double decode_bytes = 0.0;  // a pixel, the most while it is decoded
};

struct MemoryPlan {
  unsigned geometry_workers = 1;
  unsigned photograph_workers = 1;
  unsigned tile_workers = 1;  // on the tiles of each photograph
  bool fewer = false;         // than asked for, because of the limit
};

// As many workers as the limit allows. TooLarge if it does not allow one: names what is needed, rounded up, with which
// it will do.
[[nodiscard]] Result<MemoryPlan> plan_memory(const OutcropSize& size, std::span<const Photograph> photographs,
                                             const OutcropOptions& options, const Context& context,
                                             const std::string& where);

}  // namespace lodestone
