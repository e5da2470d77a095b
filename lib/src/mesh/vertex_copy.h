// SPDX-License-Identifier: MIT
// Vertices that are copies or blends of others.
#pragma once

#include <cmath>

#include <lodestone/mesh.h>

namespace lodestone {

namespace vertex_copy {

template <class T>
void append_copy(std::vector<T>& values, VertexId v) {
  if (values.empty()) return;
  const T copy = values[v];  // by value: push_back may move the array
  values.push_back(copy);
}

}  // namespace vertex_copy

inline VertexId append_vertex_copy(VertexArrays& vertices, VertexId v) {
  const VertexId id = vertices.size();
  vertex_copy::append_copy(vertices.positions, v);
  vertex_copy::append_copy(vertices.normals, v);
  vertex_copy::append_copy(vertices.uvs, v);
  vertex_copy::append_copy(vertices.colors, v);
  return id;
}

// The vertices of a list, in its order.
inline VertexArrays gathered(const VertexArrays& vertices, const std::vector<VertexId>& order) {
  VertexArrays result;
  const auto pick = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(order.size());
    for (const VertexId v : order) to.push_back(from[v]);
  };
  pick(vertices.positions, result.positions);
  pick(vertices.normals, result.normals);
  pick(vertices.uvs, result.uvs);
  pick(vertices.colors, result.colors);
  return result;
}

// A vertex at `position` whose other attributes lie at share t of the way from vertex a to vertex b.
inline VertexId append_vertex_between(VertexArrays& vertices, const glm::vec3& position, VertexId a, VertexId b,
                                      float t) {
  const VertexId id = append_vertex_copy(vertices, t < 0.5F ? a : b);
  vertices.positions[id] = glm::vec3{position};
  if (!vertices.normals.empty()) {
    const glm::vec3 n = glm::mix(vertices.normals[a], vertices.normals[b], t);
    const float length = glm::length(n);
    if (length > 0.0F) vertices.normals[id] = n / length;
  }
  if (!vertices.uvs.empty()) vertices.uvs[id] = glm::mix(vertices.uvs[a], vertices.uvs[b], t);
  if (!vertices.colors.empty()) {
    vertices.colors[id] = glm::u8vec4{glm::mix(glm::vec4{vertices.colors[a]}, glm::vec4{vertices.colors[b]}, t) + 0.5F};
  }
  return id;
}

}  // namespace lodestone
