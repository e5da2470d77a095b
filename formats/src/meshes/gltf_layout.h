// SPDX-License-Identifier: MIT
// The binary chunk of a GLB while it is planned: its views and accessors in the JSON, and how long it will be.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "gltf_meshopt.h"

namespace lodestone {

enum GltfConstant : int {
  ArrayBuffer = 34962,
  ElementArrayBuffer = 34963,
  Byte = 5120,
  UnsignedShort = 5123,
  UnsignedInt = 5125,
  Float = 5126,
};

[[nodiscard]] constexpr std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) & ~std::uint64_t{3}; }

class GltfLayout {
 public:
  using Json = nlohmann::ordered_json;
  // `root` is written to and must outlive the layout.
  explicit GltfLayout(Json& root) : root_{root} {}

  // Each returns the number of what it adds. `target` 0: none is said. What follows begins at a multiple of 4 bytes.
  int add_view(std::uint64_t size, int target);
  int add_accessor(int view, int type, std::uint64_t count, const char* shape);
  // Under EXT_meshopt_compression; the bytes are kept in packed().
  int add_packed_view(const packing::View& view, int target, std::vector<std::uint8_t> bytes);
  // The next view begins at a multiple of 8; returns the bytes that are left out for it.
  std::uint64_t align_to_8();
  // What the root says of the chunk and of the extension, once all is planned.
  void name_buffers(bool has_normals);

  [[nodiscard]] std::uint64_t size() const noexcept { return bytes_; }
  [[nodiscard]] const std::vector<std::vector<std::uint8_t>>& packed() const noexcept { return packed_; }

 private:
  Json& root_;
  std::uint64_t bytes_ = 0;
  std::uint64_t unpacked_bytes_ = 0;               // of the buffer that is not there
  std::vector<std::vector<std::uint8_t>> packed_;  // vertices and indices, in place of the meshes' own
};

}  // namespace lodestone
