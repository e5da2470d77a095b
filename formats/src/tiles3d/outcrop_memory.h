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
  double decode_bytes = 0.0;     // a pixel, the most while it is decoded
  std::uint64_t kept_bytes = 0;  // in memory all the time: an image that is in no file of its own
};

struct MemoryPlan {
  unsigned geometry_workers = 1;
  unsigned photograph_workers = 1;
  unsigned tile_workers = 1;        // on the tiles of each photograph
  bool fewer = false;               // than asked for, because of the limit
  double kept_bytes = 0.0;          // beside the triangles: the program and images that are in no file of their own
  double color_bytes = 0.0;         // a pixel
  std::vector<TextureInfo> images;  // of the mesh: sizes told by their heads, 0 where they cannot be used
};

// As many workers as the limit allows; warns of images that cannot be used. TooLarge if the limit does not allow one:
// names what is needed, rounded up, with which it will do.
[[nodiscard]] Result<MemoryPlan> plan_memory_of(const Mesh& mesh, const OutcropOptions& options, const Context& context,
                                                std::vector<Warning>& warnings);

// How many tiles of several images may be made at once: each loads its images' levels. TooLarge if not one.
[[nodiscard]] Result<unsigned> joined_at_once(const OutcropPyramid& pyramid, std::span<const std::uint32_t> joined,
                                              const MemoryPlan& plan, const Context& context);

}  // namespace lodestone
