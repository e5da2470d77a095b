// SPDX-License-Identifier: MIT
// Material libraries of OBJ files.
#pragma once

#include <map>
#include <string>

#include "reader.h"

namespace lodestone {

struct MtlMaterial {
  glm::vec4 color{1.0F};
  std::string texture;  // map_Kd, as the model's folder knows it
  std::string place;    // of its line
  std::string mask;     // map_d, in the same way
};
using MtlLibrary = std::map<std::string, MtlMaterial, std::less<>>;

// Adds the materials of one file; the first definition of a name stays. Textures lie beside it or beside the model.
void read_mtl(const Input& input, const std::filesystem::path& model_folder, const Context& context,
              MtlLibrary& library, Warnings& warnings);

// The files that a model's line names: a name may hold blanks, or there are several, and a comment may follow.
[[nodiscard]] std::vector<std::string> library_names(const std::filesystem::path& model_folder, std::string_view text);

}  // namespace lodestone
