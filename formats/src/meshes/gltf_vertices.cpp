// SPDX-License-Identifier: MIT
#include "gltf_vertices.h"

#include <array>
#include <cmath>

#include "axes.h"
#include "gltf_colors.h"

namespace lodestone {

std::vector<glm::vec3> turned_positions(const VertexArrays& vertices) {
  std::vector<glm::vec3> turned;
  turned.reserve(vertices.positions.size());
  for (const glm::vec3& p : vertices.positions) turned.push_back(z_up_to_y_up(p));
  return turned;
}

glm::vec3 normal_for_gltf(const glm::vec3& normal) {
  const glm::vec3 n = z_up_to_y_up(normal);
  const float length = glm::length(n);
  constexpr float tolerance = 4e-4F;  // gltf-validator allows 5e-4
  if (std::abs(length - 1.0F) < tolerance) return n;
  return length > 0.0F ? n / length : glm::vec3{0.0F, 1.0F, 0.0F};
}

std::vector<glm::vec3> normals_for_gltf(const VertexArrays& vertices) {
  std::vector<glm::vec3> normals;
  normals.reserve(vertices.normals.size());
  for (const glm::vec3& n : vertices.normals) normals.push_back(normal_for_gltf(n));
  return normals;
}

std::vector<std::uint16_t> linear_colors(const VertexArrays& vertices) {
  std::array<std::uint16_t, 256> linear{};
  for (int c = 0; c < 256; ++c)
    linear[c] = static_cast<std::uint16_t>(std::lround(srgb_to_linear(c / 255.0) * 65535.0));
  std::vector<std::uint16_t> colors;
  colors.reserve(4 * vertices.colors.size());
  for (const glm::u8vec4& color : vertices.colors) {
    for (int c = 0; c < 3; ++c) colors.push_back(linear[color[c]]);
    colors.push_back(static_cast<std::uint16_t>(color.a * 257));
  }
  return colors;
}

std::vector<std::uint8_t> bytes_of(std::span<const std::byte> raw) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(raw.data());
  return {first, first + raw.size()};
}

}  // namespace lodestone
