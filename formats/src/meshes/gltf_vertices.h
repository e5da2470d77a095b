// SPDX-License-Identifier: MIT
// Vertices as glTF has them: Y up, uv origin top-left, unit normals, linear colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone {

[[nodiscard]] std::vector<glm::vec3> turned_positions(const VertexArrays& vertices);

[[nodiscard]] glm::vec3 normal_for_gltf(const glm::vec3& normal);
[[nodiscard]] std::vector<glm::vec3> normals_for_gltf(const VertexArrays& vertices);

// 16 bits each, four a vertex.
[[nodiscard]] std::vector<std::uint16_t> linear_colors(const VertexArrays& vertices);

[[nodiscard]] std::vector<std::uint8_t> bytes_of(std::span<const std::byte> raw);

}  // namespace lodestone
