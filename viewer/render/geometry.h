// SPDX-License-Identifier: MIT
// Vertex and index buffers of one mesh, or of a cursor that moves.
#pragma once

#include <span>
#include <vector>

#include <lodestone/cursor.h>
#include <lodestone/mesh.h>

#include "gl.h"

namespace lodestone::render {

/// What a draw needs, as views of arrays owned by a cursor or a SortedMesh.
struct DrawArrays {
  std::span<const glm::vec3> positions;
  std::span<const glm::vec3> normals;   ///< empty: faces are lit flat
  std::span<const glm::vec2> uvs;       ///< may be empty
  std::span<const glm::u8vec4> colors;  ///< may be empty
  std::span<const std::byte> indices;
  std::uint32_t index_bytes = 4;  ///< 2 or 4
  std::span<const DrawRange> draws;
  /// Where each vertex travels to as Item::morph grows, arrays of the same lengths; null: nowhere.
  const VertexArrays* target = nullptr;

  [[nodiscard]] VertexId index(std::size_t element) const noexcept;
  [[nodiscard]] std::uint32_t triangle_count() const noexcept;
};

[[nodiscard]] DrawArrays arrays_of(const Cursor& cursor);

/// A mesh's faces sorted by material, so that each material is one draw. Refers to the mesh's vertices: keep it.
class SortedMesh {
 public:
  explicit SortedMesh(const Mesh& mesh);
  [[nodiscard]] DrawArrays arrays() const;
  /// Bytes that drawing this level takes: vertices and indices.
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  const VertexArrays* vertices_;
  std::vector<VertexId> indices_;
  std::vector<DrawRange> draws_;
};

/// Buffers on the GPU. The arrays that it was made of must outlive it: blended faces are sorted from them.
class Geometry {
 public:
  Geometry(const Gl& gl, const DrawArrays& arrays);
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;
  ~Geometry();

  /// Uploads what changed in arrays of the same sizes and addresses; `draws` is taken anew.
  void update(const DrawArrays& arrays, std::span<const Range> vertices, std::span<const Range> indices);
  /// The same from a cursor, whose dirty ranges are cleared. Returns the bytes uploaded.
  std::size_t update(Cursor& cursor);

  [[nodiscard]] const DrawArrays& arrays() const { return arrays_; }
  /// Binds vertices and indices for drawing.
  void bind() const;
  /// Binds the vertices with a list of indices of its own (32 bits), filled for this frame only.
  void bind_with(std::span<const VertexId> indices) const;

 private:
  enum Buffer {
    Positions,
    Normals,
    Uvs,
    Colors,
    TargetPositions,
    TargetNormals,
    TargetUvs,
    TargetColors,
    Indices,
    Sorted,
    BufferCount
  };
  template <class T>
  void create_attribute(Buffer buffer, std::span<const T> values, GLint components, GLenum type, GLboolean normalise);

  const Gl& gl_;
  DrawArrays arrays_;
  GLuint vertex_array_ = 0;
  GLuint buffers_[BufferCount] = {};
};

}  // namespace lodestone::render
