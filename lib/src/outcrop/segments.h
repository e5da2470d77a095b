// SPDX-License-Identifier: MIT
// The outcrop cut into what each image covers, with texture coordinates that mean one place in the image.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/outcrop.h>

namespace lodestone::outcrop {

struct Segmentation {
  std::vector<OutcropSegment> segments;            // by texture, the untextured one last
  std::vector<glm::uvec2> image_px;                // per segment: whole photograph
  std::vector<std::uint32_t> segment_of_material;  // per material of the mesh
  std::vector<std::vector<FaceId>> faces;          // per segment, ascending
  std::uint32_t plain_faces = 0;                   // that were left without their texture
  FaceId first_plain = none;
};

// Shifts every chart of the mesh by whole repeats of its texture so that it begins within 0..1, face by face where a
// chart is wider than the image (its vertices are split there). Faces that repeat their texture more than four times,
// or lie too many repeats away, lose it.
[[nodiscard]] Segmentation segment_by_image(Mesh& mesh, std::span<const TextureInfo> textures);

// Pixels from the top left of the photograph.
[[nodiscard]] inline glm::dvec2 to_pixels(const glm::vec2& uv, const glm::uvec2& image_px) noexcept {
  return {double{uv.x} * image_px.x, (1.0 - double{uv.y}) * image_px.y};
}

[[nodiscard]] inline double area_px2(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept {
  const glm::dvec2 u = b - a;
  const glm::dvec2 v = c - a;
  return 0.5 * std::abs(u.x * v.y - u.y * v.x);
}

}  // namespace lodestone::outcrop
