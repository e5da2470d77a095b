// SPDX-License-Identifier: MIT
// How large the mesh of a file is, and what reading it will take, without reading it.
#pragma once

#include <filesystem>
#include <vector>

#include "reader.h"

namespace lodestone {

// An image that lies inside the mesh's file or a buffer's.
struct InnerImage {
  std::filesystem::path file;  // empty = the mesh's
  std::uint64_t offset = 0;
  std::uint64_t size_bytes = 0;
};

struct MeshCount {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  // of an OBJ to a hundredth
  std::uint32_t vertex_bytes = 0;
  std::vector<std::filesystem::path> textures{};  // of the materials that faces name
  std::vector<InnerImage> images{};
  std::uint64_t other_image_bytes = 0;  // of images in text: compressed
  double reading_bytes = 0.0;           // the most that reading holds at once, images inside included
};

// Counts are never more than the file's bytes could stand for, nor than the caps of ReadOptions; what claims more is
// damaged, as its reader will say.
//
// One pass over the lines, in little more than a megabyte. Errors: those of reading.
[[nodiscard]] Result<MeshCount> count_obj(const Input& input, const Context& context);
// From the header; of files of polygons in text a lower bound.
[[nodiscard]] Result<MeshCount> count_ply(const Input& input, const Context& context);
// From the JSON, no buffer is read; those beside the file are asked for their sizes. What is no glTF counts as nothing:
// its reader says what is wrong with it.
[[nodiscard]] Result<MeshCount> count_gltf(const Input& input);
// What count_gltf() holds itself.
[[nodiscard]] std::uint64_t gltf_json_bytes(const Input& input);

}  // namespace lodestone
