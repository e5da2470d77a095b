// SPDX-License-Identifier: MIT
// How large the mesh of an OBJ file is, without reading it.
#pragma once

#include <filesystem>
#include <vector>

#include "reader.h"

namespace lodestone {

struct ObjCount {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  // to a hundredth
  std::uint32_t vertex_bytes = 0;
  std::vector<std::filesystem::path> textures;  // of the materials that faces name
};

// One pass over the lines, in little more than a megabyte. Errors: those of reading.
[[nodiscard]] Result<ObjCount> count_obj(const Input& input, const Context& context);

}  // namespace lodestone
