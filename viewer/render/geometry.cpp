// SPDX-License-Identifier: MIT
#include "geometry.h"

#include <cstring>

namespace lodestone::render {

VertexId DrawArrays::index(std::size_t element) const noexcept {
  if (index_bytes == 2) {
    std::uint16_t value = 0;
    std::memcpy(&value, indices.data() + element * 2, 2);
    return value;
  }
  std::uint32_t value = 0;
  std::memcpy(&value, indices.data() + element * 4, 4);
  return value;
}

std::uint32_t DrawArrays::triangle_count() const noexcept {
  std::uint32_t count = 0;
  for (const DrawRange& draw : draws) count += draw.index_count / 3;
  return count;
}

DrawArrays arrays_of(const Cursor& cursor) {
  return {.positions = cursor.positions(),
          .normals = cursor.normals(),
          .uvs = cursor.uvs(),
          .colors = cursor.colors(),
          .indices = cursor.indices(),
          .index_bytes = cursor.index_bytes(),
          .draws = cursor.draws()};
}

SortedMesh::SortedMesh(const Mesh& mesh) : vertices_(&mesh.vertices) {
  const std::size_t materials = std::max<std::size_t>(1, mesh.materials.size());
  draws_.resize(materials);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) draws_[mesh.face_material(f)].index_count += 3;
  std::uint32_t first = 0;
  for (MaterialId m = 0; m < materials; ++m) {
    draws_[m].material = m;
    draws_[m].first_index = first;
    first += draws_[m].index_count;
  }
  if (mesh.face_materials.empty()) {
    indices_ = mesh.indices;
    return;
  }
  indices_.resize(mesh.indices.size());
  std::vector<std::uint32_t> next;
  for (const DrawRange& draw : draws_) next.push_back(draw.first_index);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    std::uint32_t& to = next[mesh.face_material(f)];
    for (std::uint32_t corner = 0; corner < 3; ++corner) indices_[to + corner] = mesh.indices[3 * f + corner];
    to += 3;
  }
}

DrawArrays SortedMesh::arrays() const {
  return {.positions = vertices_->positions,
          .normals = vertices_->normals,
          .uvs = vertices_->uvs,
          .colors = vertices_->colors,
          .indices = std::as_bytes(std::span<const VertexId>{indices_}),
          .index_bytes = 4,
          .draws = draws_};
}

std::size_t SortedMesh::memory_bytes() const noexcept {
  const DrawArrays a = arrays();
  return a.positions.size_bytes() + a.normals.size_bytes() + a.uvs.size_bytes() + a.colors.size_bytes() +
         a.indices.size_bytes();
}

Geometry::Geometry(const Gl& gl, const DrawArrays& arrays) : gl_(gl), arrays_(arrays) {
  gl_.gen_vertex_arrays(1, &vertex_array_);
  gl_.gen_buffers(BufferCount, buffers_);
  gl_.bind_vertex_array(vertex_array_);
  create_attribute(Positions, arrays.positions, 3, GL_FLOAT, GL_FALSE);
  create_attribute(Normals, arrays.normals, 3, GL_FLOAT, GL_FALSE);
  create_attribute(Uvs, arrays.uvs, 2, GL_FLOAT, GL_FALSE);
  create_attribute(Colors, arrays.colors, 4, GL_UNSIGNED_BYTE, GL_TRUE);
  if (const VertexArrays* target = arrays.target; target != nullptr) {
    create_attribute(TargetPositions, std::span<const glm::vec3>{target->positions}, 3, GL_FLOAT, GL_FALSE);
    create_attribute(TargetNormals, std::span<const glm::vec3>{target->normals}, 3, GL_FLOAT, GL_FALSE);
    create_attribute(TargetUvs, std::span<const glm::vec2>{target->uvs}, 2, GL_FLOAT, GL_FALSE);
    create_attribute(TargetColors, std::span<const glm::u8vec4>{target->colors}, 4, GL_UNSIGNED_BYTE, GL_TRUE);
  }
  gl_.bind_buffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[Indices]);
  gl_.buffer_data(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(arrays.indices.size_bytes()), arrays.indices.data(),
                  GL_DYNAMIC_DRAW);
}

Geometry::~Geometry() {
  gl_.delete_buffers(BufferCount, buffers_);
  gl_.delete_vertex_arrays(1, &vertex_array_);
}

// The attribute's place in the shader is the buffer's number. An array that is not there leaves the constant value.
template <class T>
void Geometry::create_attribute(Buffer buffer, std::span<const T> values, GLint components, GLenum type,
                                GLboolean normalise) {
  if (values.empty()) return;
  gl_.bind_buffer(GL_ARRAY_BUFFER, buffers_[buffer]);
  gl_.buffer_data(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), GL_DYNAMIC_DRAW);
  gl_.enable_vertex_attrib_array(buffer);
  gl_.vertex_attrib_pointer(buffer, components, type, normalise, sizeof(T), nullptr);
}

void Geometry::update(const DrawArrays& arrays, std::span<const Range> vertices, std::span<const Range> indices) {
  arrays_ = arrays;
  const auto upload = [&](GLenum target, Buffer buffer, const void* data, std::size_t stride, std::size_t size,
                          std::span<const Range> ranges) {
    if (size == 0 || ranges.empty()) return;
    gl_.bind_buffer(target, buffers_[buffer]);
    for (const Range& range : ranges) {
      const auto offset = static_cast<GLintptr>(range.begin * stride);
      gl_.buffer_sub_data(target, offset, static_cast<GLsizeiptr>(range.size() * stride),
                          static_cast<const std::byte*>(data) + offset);
    }
  };
  gl_.bind_vertex_array(vertex_array_);
  upload(GL_ARRAY_BUFFER, Positions, arrays.positions.data(), sizeof(glm::vec3), arrays.positions.size(), vertices);
  upload(GL_ARRAY_BUFFER, Normals, arrays.normals.data(), sizeof(glm::vec3), arrays.normals.size(), vertices);
  upload(GL_ARRAY_BUFFER, Uvs, arrays.uvs.data(), sizeof(glm::vec2), arrays.uvs.size(), vertices);
  upload(GL_ARRAY_BUFFER, Colors, arrays.colors.data(), sizeof(glm::u8vec4), arrays.colors.size(), vertices);
  upload(GL_ELEMENT_ARRAY_BUFFER, Indices, arrays.indices.data(), arrays.index_bytes, arrays.indices.size(), indices);
}

std::size_t Geometry::update(Cursor& cursor) {
  const DrawArrays arrays = arrays_of(cursor);
  const auto elements = [](std::span<const Range> ranges) {
    std::size_t sum = 0;
    for (const Range& range : ranges) sum += range.size();
    return sum;
  };
  update(arrays, cursor.dirty_vertices(), cursor.dirty_indices());
  const std::size_t vertex_bytes = sizeof(glm::vec3) + (arrays.normals.empty() ? 0 : sizeof(glm::vec3)) +
                                   (arrays.uvs.empty() ? 0 : sizeof(glm::vec2)) +
                                   (arrays.colors.empty() ? 0 : sizeof(glm::u8vec4));
  const std::size_t bytes =
      elements(cursor.dirty_vertices()) * vertex_bytes + elements(cursor.dirty_indices()) * arrays.index_bytes;
  cursor.clear_dirty();
  return bytes;
}

void Geometry::bind() const {
  gl_.bind_vertex_array(vertex_array_);
  gl_.bind_buffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[Indices]);
  gl_.vertex_attrib_3f(Normals, 0.0F, 0.0F, 1.0F);
  gl_.vertex_attrib_3f(Uvs, 0.0F, 0.0F, 0.0F);
  gl_.vertex_attrib_4f(Colors, 1.0F, 1.0F, 1.0F, 1.0F);
  gl_.vertex_attrib_4f(TargetColors, 1.0F, 1.0F, 1.0F, 1.0F);
}

void Geometry::bind_with(std::span<const VertexId> indices) const {
  bind();
  gl_.bind_buffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[Sorted]);
  gl_.buffer_data(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
                  GL_STREAM_DRAW);
}

}  // namespace lodestone::render
