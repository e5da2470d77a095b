// SPDX-License-Identifier: MIT
// What the drivers have in common: bytes go in at a door, anything may come out but a crash, a hang or a flood.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "reader.h"

namespace lodestone::fuzz {

// Small caps: a fuzzer that may build a gigabyte tests the allocator.
inline ReadOptions small_caps() {
  ReadOptions options;
  options.textures = LoadTextures::Decoded;
  options.max_vertices = 1U << 20U;
  options.max_triangles = 1U << 20U;
  options.max_texture_pixels = 1U << 20U;
  return options;
}

inline Input input_of(const std::uint8_t* data, std::size_t size, std::string name) {
  return Input::from_bytes({data, size}, std::move(name), "/nonexistent");
}

// What read_input promises: an error with a message, or a mesh that validates.
inline void demand_valid(const Result<LoadedMesh>& result) {
  if (result.ok() ? !validate(result->mesh).ok() : result.error().message.empty()) __builtin_trap();
}

}  // namespace lodestone::fuzz

// A mesh door: one reader behind the checks of read_input. libFuzzer's entry point.
#define LODESTONE_MESH_DOOR(name)                                                             \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {         \
    using namespace lodestone;                                                                \
    fuzz::demand_valid(read_input(fuzz::input_of(data, size, name), fuzz::small_caps(), {})); \
    return 0;                                                                                 \
  }
