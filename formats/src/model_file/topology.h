// SPDX-License-Identifier: MIT
// The faces in use while the stack is replayed, with the corners around each vertex. Writer and reader keep the same
// lists in the same order, so a corner costs a few bits: its place among the corners of a vertex.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/types.h>

namespace lodestone::model_file {

// A vertex with more corners than this loses its list for good and its corners are named by number. It bounds the
// work a hostile file can ask for.
inline constexpr std::uint32_t max_star = 250;

struct Star {
  std::array<CornerId, max_star> corners;
  std::uint32_t count = 0;
};

[[nodiscard]] inline CornerId next_corner(CornerId corner) noexcept {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}
[[nodiscard]] inline CornerId previous_corner(CornerId corner) noexcept {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}

class Topology {
 public:
  // `face_begin` as in ModelData: the slots of each material.
  explicit Topology(std::span<const FaceId> face_begin)
      : next_face_(face_begin.begin(), face_begin.end()),
        face_begin_(face_begin.begin(), face_begin.end()),
        vertices_(3 * static_cast<std::size_t>(face_begin.back()), none),
        next_(3 * static_cast<std::size_t>(face_begin.back()), none) {}

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return static_cast<std::uint32_t>(first_.size()); }
  [[nodiscard]] std::uint32_t corner_count() const noexcept { return static_cast<std::uint32_t>(vertices_.size()); }
  // The vertex at a corner; `none` where the face is not in use.
  [[nodiscard]] VertexId vertex(CornerId corner) const noexcept { return vertices_[corner]; }
  [[nodiscard]] bool listed(VertexId vertex) const noexcept { return valence_[vertex] <= max_star; }
  [[nodiscard]] std::uint32_t material_count() const noexcept {
    return static_cast<std::uint32_t>(face_begin_.size() - 1);
  }
  // The material whose range holds a face slot.
  [[nodiscard]] MaterialId material(FaceId face) const noexcept;
  [[nodiscard]] bool has_room(MaterialId m, std::uint32_t faces) const noexcept {
    return m < material_count() && faces <= face_begin_[m + 1] - next_face_[m];
  }
  // The slot the next face of this material takes.
  [[nodiscard]] FaceId next_face(MaterialId m) const noexcept { return next_face_[m]; }

  VertexId add_vertex() {
    first_.push_back(none);
    valence_.push_back(0);
    return vertex_count() - 1;
  }

  // Preconditions: has_room(m, 1); vertices exist. The corners become the first of their vertices' lists.
  FaceId add_face(MaterialId m, VertexId a, VertexId b, VertexId c) noexcept;

  // The corners of a vertex in list order. Precondition: listed(vertex).
  void gather(VertexId vertex, Star& star) const noexcept {
    std::uint32_t count = 0;
    for (CornerId c = first_[vertex]; c != none; c = next_[c]) star.corners[count++] = c;
    star.count = count;
  }

  void repoint(CornerId corner, VertexId to) noexcept;

  // What a fan does: moves `run`, a part of the list `star` of `from`, to the vertex `to`, which has no corners yet, in
  // that order. False, with the lists spoilt, if a corner of `run` does not belong to `from` or occurs twice. `star` is
  // ignored where `from` has no list.
  [[nodiscard]] bool split_star(VertexId from, const Star& star, std::span<const CornerId> run, VertexId to) noexcept;

 private:
  void link(VertexId vertex, CornerId corner) noexcept;
  void unlink(VertexId vertex, CornerId corner) noexcept;

  std::vector<FaceId> next_face_, face_begin_;
  std::vector<VertexId> vertices_;     // per corner
  std::vector<CornerId> next_;         // per corner: the next of the same vertex
  std::vector<CornerId> first_;        // per vertex
  std::vector<std::uint8_t> valence_;  // per vertex; max_star + 1: no list
};

}  // namespace lodestone::model_file
