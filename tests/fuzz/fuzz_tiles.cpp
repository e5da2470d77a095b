// SPDX-License-Identifier: MIT
// tileset.json and batched models; glTF has a door of its own.
#include "doors.h"
#include "tiles3d/read_tileset.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  const auto tileset = parse_tileset({data, size}, "fuzz");
  if (tileset.ok() ? tileset->tiles.empty() : tileset.error().message.empty()) __builtin_trap();
  const auto tile = parse_tile({data, size}, "/nonexistent/fuzz.b3dm", fuzz::small_caps());
  if (tile.ok() ? !validate(*tile).ok() : tile.error().message.empty()) __builtin_trap();
  return 0;
}
