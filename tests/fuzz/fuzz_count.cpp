// SPDX-License-Identifier: MIT
// Counting before reading: of whatever bytes, and never fewer triangles than reading then finds.
#include <string_view>

#include "doors.h"
#include "meshes/mesh_count.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  const bool json = size > 0 && data[0] == '{';
  const Input input = fuzz::input_of(data, size, json ? "fuzz.gltf" : "fuzz.obj");
  const ReadFunction reader = find_reader(input);
  const bool ply = reader == read_ply;
  if (!ply && reader != read_obj && reader != read_gltf) return 0;
  const auto count = ply ? count_ply(input, {}) : reader == read_obj ? count_obj(input, {}) : count_gltf(input);
  if (!count) {
    if (count.error().message.empty()) __builtin_trap();
    return 0;
  }
  const ReadOptions caps;
  if (count->triangles > caps.max_triangles || count->vertices > 2 * caps.max_vertices) __builtin_trap();
  if (reader != read_gltf && (count->triangles > size || count->vertices > 2 * size)) __builtin_trap();
  for (const InnerImage& image : count->images) {
    if (image.offset > size || image.size_bytes > size - image.offset) __builtin_trap();
  }
  // Polygons in text are only known when they are read; Draco's data count for themselves, whatever the file says.
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  if (ply || text.find("draco") != text.npos) return 0;
  const auto loaded = read_input(input, fuzz::small_caps(), {});
  if (loaded && loaded->mesh.triangle_count() > count->triangles) __builtin_trap();
  return 0;
}
