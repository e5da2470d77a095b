// SPDX-License-Identifier: MIT
// The reader of quantized-mesh tiles, compressed or not.
#include <lodestone/terrain_files.h>

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto mesh = lodestone::decode_quantized_mesh({data, size});
  if (!mesh.ok()) {
    if (mesh.error().message.empty()) __builtin_trap();
    return 0;
  }
  for (const std::uint32_t vertex : mesh->triangles) {
    if (vertex >= mesh->u.size()) __builtin_trap();
  }
  return 0;
}
