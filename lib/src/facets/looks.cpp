// SPDX-License-Identifier: MIT
#include "facets/looks.h"

#include <algorithm>

#include <lodestone/metrics.h>

namespace lodestone::facets {
namespace {

// What looks wrong costs as if it stood so far off, where black is shown for white. The larger, the longer windows stay
// and the sooner forms go: at 1 m the distance at 10 % grows by a fifth, at 0.3 m windows of a few materials are lost.
constexpr double look_m = 0.6;
constexpr glm::dvec3 unknown_texel{0.5, 0.47, 0.45};  // of an image that is not decoded
constexpr glm::dvec3 dark_room{0.35};                 // behind glass
constexpr double least_contrast = 0.004;              // different materials are never quite alike
constexpr double hole_contrast = 0.05;                // of what is behind and not known

glm::dvec3 mean_texel(const Texture& texture) {
  return texture.image && !texture.image->empty() ? glm::dvec3{mean_color(*texture.image)} : unknown_texel;
}

}  // namespace

Looks::Looks(const Surroundings& source, const std::vector<glm::vec3>& texture_colors) {
  std::vector<glm::dvec3> texels{texture_colors.begin(), texture_colors.end()};
  for (std::size_t i = texels.size(); i < source.textures.size(); ++i) texels.push_back(mean_texel(source.textures[i]));
  for (const Material& material : source.materials) {
    const glm::dvec4 base{material.base_color};
    glm::dvec3 color{base};
    if (material.texture < texels.size()) color *= texels[material.texture];
    color_.push_back(glm::mix(dark_room, color, base.a));
  }
}

double Looks::contrast(MaterialId a, MaterialId b) const noexcept {
  if (a == b) return 0.0;
  const glm::dvec3 apart = color_[a] - color_[b];
  return std::max(least_contrast, glm::dot(apart, apart) / 3.0);
}

double Looks::cost(MaterialId a, MaterialId b, double area_m2) const noexcept {
  return contrast(a, b) * area_m2 * look_m * look_m;
}

double Looks::cost_of_hole(double area_m2) const noexcept { return hole_contrast * area_m2 * look_m * look_m; }

}  // namespace lodestone::facets
