// SPDX-License-Identifier: MIT
// Numbers out of glTF buffers, every range checked. Names tinygltf, so only gltf_*.cpp include it.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/result.h>

namespace lodestone {

// All numbers of an accessor of so many components, normalised ones as shares. TooLarge beyond `cap` elements.
[[nodiscard]] Status read_floats(const tinygltf::Model& model, int accessor, int components, std::uint64_t cap,
                                 std::vector<float>& values);
[[nodiscard]] Status read_indices(const tinygltf::Model& model, int accessor, std::uint64_t cap,
                                  std::vector<std::uint32_t>& values);

// The bytes of a buffer view; empty if it lies outside its buffer.
[[nodiscard]] std::span<const std::uint8_t> view_bytes(const tinygltf::Model& model, int view);

}  // namespace lodestone
