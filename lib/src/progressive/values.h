// SPDX-License-Identifier: MIT
// Vertex values as 32-bit words, and the XOR that moves a vertex one record up or down.
#pragma once

#include <cstdint>
#include <cstring>

#include <lodestone/mesh.h>

namespace lodestone::progressive {

// Writable vertex arrays; null where the model has none.
struct VertexPointers {
  glm::vec3* positions = nullptr;
  glm::vec3* normals = nullptr;
  glm::vec2* uvs = nullptr;
  glm::u8vec4* colors = nullptr;
};

struct ConstVertexPointers {
  const glm::vec3* positions = nullptr;
  const glm::vec3* normals = nullptr;
  const glm::vec2* uvs = nullptr;
  const glm::u8vec4* colors = nullptr;
};

template <class Array>
[[nodiscard]] auto* data_or_null(Array& array) noexcept {
  return array.empty() ? nullptr : array.data();
}
[[nodiscard]] inline VertexPointers pointers(VertexArrays& arrays) noexcept {
  return {data_or_null(arrays.positions), data_or_null(arrays.normals), data_or_null(arrays.uvs),
          data_or_null(arrays.colors)};
}
[[nodiscard]] inline ConstVertexPointers pointers(const VertexArrays& arrays) noexcept {
  return {data_or_null(arrays.positions), data_or_null(arrays.normals), data_or_null(arrays.uvs),
          data_or_null(arrays.colors)};
}
[[nodiscard]] inline ConstVertexPointers read_only(const VertexPointers& p) noexcept {
  return {p.positions, p.normals, p.uvs, p.colors};
}

[[nodiscard]] inline std::uint32_t value_words(const VertexArrays& arrays) noexcept {
  return 3U + (arrays.normals.empty() ? 0U : 3U) + (arrays.uvs.empty() ? 0U : 2U) + (arrays.colors.empty() ? 0U : 1U);
}

// Calls visit(attribute element, first word) for each attribute of a vertex, in the order of the words.
template <class Visit>
inline void for_each_attribute(const VertexPointers& vertices, VertexId slot, Visit&& visit) noexcept {
  std::uint32_t word = 0;
  if (vertices.positions != nullptr) {
    visit(vertices.positions[slot], word);
    word += 3;
  }
  if (vertices.normals != nullptr) {
    visit(vertices.normals[slot], word);
    word += 3;
  }
  if (vertices.uvs != nullptr) {
    visit(vertices.uvs[slot], word);
    word += 2;
  }
  if (vertices.colors != nullptr) visit(vertices.colors[slot], word);
}

inline void xor_value(const VertexPointers& vertices, VertexId slot, const std::uint32_t* words) noexcept {
  for_each_attribute(vertices, slot, [words](auto& value, std::uint32_t word) {
    std::uint32_t bits[sizeof(value) / 4];
    std::memcpy(bits, &value, sizeof(value));
    for (auto& bit : bits) bit ^= words[word++];
    std::memcpy(&value, bits, sizeof(value));
  });
}

inline void copy_value(const VertexPointers& to, const ConstVertexPointers& from, VertexId slot) noexcept {
  if (to.positions != nullptr) to.positions[slot] = from.positions[slot];
  if (to.normals != nullptr) to.normals[slot] = from.normals[slot];
  if (to.uvs != nullptr) to.uvs[slot] = from.uvs[slot];
  if (to.colors != nullptr) to.colors[slot] = from.colors[slot];
}

inline void get_value(const VertexPointers& vertices, VertexId slot, std::uint32_t* words) noexcept {
  for_each_attribute(vertices, slot,
                     [words](auto& value, std::uint32_t word) { std::memcpy(words + word, &value, sizeof(value)); });
}

inline void set_value(const VertexPointers& vertices, VertexId slot, const std::uint32_t* words) noexcept {
  for_each_attribute(vertices, slot,
                     [words](auto& value, std::uint32_t word) { std::memcpy(&value, words + word, sizeof(value)); });
}

}  // namespace lodestone::progressive
