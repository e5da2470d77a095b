// SPDX-License-Identifier: MIT
// Materials and textures of a mesh or model, ready to bind. Shared by every level and instance of it.
#pragma once

#include <vector>

#include <lodestone/mesh.h>

#include "gl.h"

namespace lodestone::render {

/// A material as the shader takes it.
struct Surface {
  glm::vec4 base_color{1.0F};  ///< linear, straight alpha
  GLuint texture = 0;          ///< never 0: a white texel where there is no image
  float alpha_cutoff = 0.0F;
  bool double_sided = true;
  bool transparent = false;
};

class Surfaces {
 public:
  /// Decodes what is not decoded yet (from `encoded`, else from `path`) and uploads it with mip levels. A texture that
  /// cannot be read is drawn white and listed in warnings().
  Surfaces(const Gl& gl, const Surroundings& source);
  Surfaces(const Surfaces&) = delete;
  Surfaces& operator=(const Surfaces&) = delete;
  ~Surfaces();

  [[nodiscard]] const Surface& operator[](MaterialId material) const { return surfaces_[material]; }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(surfaces_.size()); }
  [[nodiscard]] GLuint white() const { return textures_.front(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const { return warnings_; }

 private:
  const Gl& gl_;
  std::vector<Surface> surfaces_;
  std::vector<GLuint> textures_;  ///< [0] is white
  std::vector<Warning> warnings_;
};

}  // namespace lodestone::render
