// SPDX-License-Identifier: MIT
// Material libraries of OBJ files.
#pragma once

#include <map>
#include <string>

#include "reader.h"

namespace lodestone {

struct MtlMaterial {
  glm::vec4 color{1.0F};
  std::string texture;    // map_Kd, as written
  bool has_mask = false;  // map_d
};
using MtlLibrary = std::map<std::string, MtlMaterial, std::less<>>;

// Adds the materials of one file; the first definition of a name stays.
void read_mtl(const Input& input, const Context& context, MtlLibrary& library, Warnings& warnings);

}  // namespace lodestone
