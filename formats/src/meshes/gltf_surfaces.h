// SPDX-License-Identifier: MIT
// Textures and materials of a mesh as glTF has them.
#pragma once

#include <vector>

#include "gltf_layout.h"
#include "writers.h"

namespace lodestone {

class GltfSurfaces {
 public:
  // Adds images, textures, samplers and materials to `root`, and the images' views. A texture that cannot be had is a
  // warning.
  void plan(const Mesh& mesh, GltfLook look, nlohmann::ordered_json& root, GltfLayout& layout,
            std::vector<Warning>& warnings);
  // In the order of their views.
  [[nodiscard]] const std::vector<EncodedTexture>& images() const noexcept { return images_; }

 private:
  void plan_textures(const Mesh& mesh, nlohmann::ordered_json& root, GltfLayout& layout,
                     std::vector<Warning>& warnings);
  [[nodiscard]] nlohmann::ordered_json material_json(const Material& material) const;

  GltfLook look_ = GltfLook::Lit;
  std::vector<EncodedTexture> images_;
  std::vector<int> texture_ids_;  // -1 for those left out
};

}  // namespace lodestone
