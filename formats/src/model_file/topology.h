// SPDX-License-Identifier: MIT
// The faces in use while the stack is replayed, with the corners around each vertex. Writer and reader keep the same
// lists in the same order, so a corner costs a few bits: its place among the corners of a vertex.
//
// A list of up to eight corners lies in one half of a cache line, in slot order; longer ones move to a pool.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/types.h>

#include "large_pages.h"

namespace lodestone::model_file {

// A vertex with more corners than this loses its list for good and its corners are named by number. It bounds the
// work a hostile file can ask for.
inline constexpr std::uint32_t max_star = 250;

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
        vertices_(3 * static_cast<std::size_t>(face_begin.back()), none) {}

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return vertex_count_; }
  [[nodiscard]] std::uint32_t corner_count() const noexcept { return static_cast<std::uint32_t>(vertices_.size()); }
  // The vertex at a corner; `none` where the face is not in use.
  [[nodiscard]] VertexId vertex(CornerId corner) const noexcept { return vertices_[corner]; }
  [[nodiscard]] bool listed(VertexId vertex) const noexcept { return counts_[vertex] <= max_star; }
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

  // Makes room for so many vertices in all; reserve() only sees to it that this is cheap.
  void reserve(std::uint32_t count) {
    stars_.reserve(count);
    counts_.reserve(count);
  }
  void make_room(std::uint32_t count) {
    stars_.resize(count);
    counts_.resize(count, 0);
  }
  [[nodiscard]] bool has_room_for_vertices(std::uint32_t count) const noexcept {
    return count <= counts_.size() - vertex_count_;
  }
  // Precondition: there is room.
  VertexId add_vertex() noexcept { return vertex_count_++; }
  // Preconditions: has_room(m, 1); vertices exist. The corners become the last of their vertices' lists.
  FaceId add_face(MaterialId m, VertexId a, VertexId b, VertexId c) {
    const FaceId face = next_face_[m]++;
    link(a, 3 * face);
    link(b, 3 * face + 1);
    link(c, 3 * face + 2);
    return face;
  }

  // The corners of a vertex in list order. Precondition: listed(vertex). Valid until the lists change.
  [[nodiscard]] std::span<const CornerId> star(VertexId vertex) const noexcept {
    return {list(vertex), counts_[vertex]};
  }

  // Vertices there is room for, whether they exist yet or not.
  [[nodiscard]] std::uint32_t capacity() const noexcept { return static_cast<std::uint32_t>(counts_.size()); }
  // Whether a vertex (of any number) is there with a list of up to eight corners.
  [[nodiscard]] bool has_short_list(VertexId vertex) const noexcept {
    return vertex < vertex_count_ && counts_[vertex] <= inline_corners;
  }
  // See to it that memory soon to be read is near. Precondition: below capacity(). Inlined because a compiler may take
  // a call that only fetches for one without effect.
  [[gnu::always_inline]] void fetch_list(VertexId vertex) const noexcept {
    __builtin_prefetch(&stars_[vertex], 1);
    __builtin_prefetch(&counts_[vertex], 1);
  }
  [[gnu::always_inline]] void fetch_face(CornerId corner) const noexcept { __builtin_prefetch(&vertices_[corner], 1); }

  // The corner leaves its vertex's list, whose others keep their order, and becomes the last of that of `to`.
  void repoint(CornerId corner, VertexId to);

  // What a fan does: moves `run`, some of the corners of `from`, to the vertex `to`, which has no corners yet, in that
  // order. False, with the lists spoilt, if a corner of `run` does not belong to `from` or occurs twice.
  [[nodiscard]] bool split_star(VertexId from, std::span<const CornerId> run, VertexId to) {
    for (const CornerId corner : run) {
      if (vertices_[corner] != from) return false;
      link(to, corner);
    }
    if (counts_[from] > inline_corners) {
      if (listed(from)) drop_moved(from);
      return true;
    }
    CornerId* const first = stars_[from].data();
    CornerId* last = first;
    for (std::uint32_t i = 0; i < counts_[from]; ++i) {
      const CornerId corner = first[i];
      *last = corner;
      last += vertices_[corner] == from ? 1 : 0;
    }
    counts_[from] = static_cast<std::uint16_t>(last - first);
    return true;
  }

 private:
  static constexpr std::uint32_t inline_corners = 8;
  // The list itself where it is no longer than that; else where it lies in `pool_`, and the room it has there.
  using Inline = std::array<CornerId, inline_corners>;

  [[nodiscard]] const CornerId* list(VertexId vertex) const noexcept {
    return counts_[vertex] <= inline_corners ? stars_[vertex].data() : &pool_[stars_[vertex][0]];
  }
  [[nodiscard]] CornerId* list(VertexId vertex) noexcept {
    return counts_[vertex] <= inline_corners ? stars_[vertex].data() : &pool_[stars_[vertex][0]];
  }
  void link(VertexId vertex, CornerId corner) {
    vertices_[corner] = vertex;
    if (counts_[vertex] < inline_corners) {
      stars_[vertex][counts_[vertex]++] = corner;
    } else {
      link_long(vertex, corner);
    }
  }
  void link_long(VertexId vertex, CornerId corner);
  void unlink(VertexId vertex, CornerId corner);
  void drop_moved(VertexId from);
  std::uint32_t take(std::uint32_t room);
  void give_back(const Inline& place);
  // Sets the length of a list to one that is not longer.
  void shorten(VertexId vertex, std::uint32_t count);

  std::vector<FaceId> next_face_, face_begin_;
  LargeVector<VertexId> vertices_;  // per corner
  std::uint32_t vertex_count_ = 0;
  LargeVector<Inline> stars_;  // per vertex
  std::vector<std::uint16_t>
      counts_;  // wider than need be: bytes would alias everything the compiler keeps in registers
  std::vector<CornerId> pool_;
  std::array<std::vector<std::uint32_t>, 5> free_;  // places in the pool with room for 16, 32, ... 256
};

}  // namespace lodestone::model_file
