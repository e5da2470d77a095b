// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019, section 2.4 (a stack pointer that moves either way over fixed slots); Hoppe 1996 (vertex
// split and edge collapse).
// Differs: no record names what it adds, and the corners of the records to come are fetched ahead: memory latency, not
// work, is what a record costs.
#include "progressive/play.h"

#include "progressive/record.h"

namespace lodestone::progressive {
namespace {

// Corners that are fetched ahead of their use: about eight records.
constexpr std::uint64_t fetch_ahead = 40;
// The same for the vertex that a record moves, which is found through a corner fetched before: corners ahead when
// refining, faces ahead when coarsening.
constexpr std::uint64_t fetch_values_ahead = 20;
constexpr CornerId fetch_faces_ahead = 14;

void fetch_vertex(const VertexPointers& vertices, VertexId slot) noexcept {
  __builtin_prefetch(vertices.positions + slot, 1);
  if (vertices.normals != nullptr) __builtin_prefetch(vertices.normals + slot, 1);
  if (vertices.uvs != nullptr) __builtin_prefetch(vertices.uvs + slot, 1);
}

void move_vertex(const PlayArrays& arrays, VertexId slot, const std::uint32_t* words) noexcept {
  xor_value(arrays.exact, slot, words);
  if (arrays.shown.positions != nullptr) copy_value(arrays.shown, read_only(arrays.exact), slot);
  arrays.vertex_marks[slot >> arrays.mark_shift] = 1;
}

template <class Index, unsigned Bytes>
class Player {
 public:
  Player(const ModelData& data, const PlayArrays& arrays, StackPosition& at) noexcept
      : data_(data),
        arrays_(arrays),
        at_(at),
        indices_(static_cast<Index*>(arrays.indices)),
        words_(data.value_words()),
        moves_vertices_(arrays.exact.positions != nullptr) {}

  void refine(Level to) noexcept;
  void coarsen(Level to) noexcept;

 private:
  void refine_edit() noexcept;
  void coarsen_edit() noexcept;

  [[nodiscard]] DrawRange& fan_draw(std::uint32_t fan_record) const noexcept {
    return arrays_.draws[data_.fan_materials.empty() ? 0 : data_.fan_materials[fan_record]];
  }
  void xor_corners(const EditBlock& block) noexcept {
    for (const std::uint32_t* pair = block.corners(); pair != block.moved(); pair += 2) {
      indices_[pair[0]] = static_cast<Index>(indices_[pair[0]] ^ pair[1]);
      arrays_.index_marks[pair[0] >> arrays_.mark_shift] = 1;
    }
  }
  void move_all(const EditBlock& block) noexcept {
    const std::uint32_t* values = data_.value_xor.data() + at_.value_word;
    for (std::uint32_t i = 0; i < block.move_count(); ++i, values += words_) {
      move_vertex(arrays_, block.moved()[i], values);
    }
  }

  const ModelData& data_;
  const PlayArrays& arrays_;
  StackPosition& at_;
  Index* indices_;
  std::uint32_t words_;
  bool moves_vertices_;
};

template <class Index, unsigned Bytes>
void Player<Index, Bytes>::refine(Level to) noexcept {
  // Locals: stores through the byte arrays could alias members, which would then be read again for each record.
  Index* const indices = indices_;
  std::uint8_t* const marks = arrays_.index_marks;
  const unsigned shift = arrays_.mark_shift;
  const std::uint8_t* const corners = data_.fan_corners.data();
  const std::uint64_t corner_total = data_.fan_corners.size() / Bytes;
  const std::uint8_t* const shapes = data_.shapes.data();
  std::uint64_t corner_at = at_.fan_corner;
  const bool moves_vertices = moves_vertices_;
  std::uint32_t triangles = at_.triangles;
  for (Level record = at_.level; record < to; ++record) {
    const std::uint8_t shape = shapes[record];
    const RecordKind kind = kind_of(shape);
    if (kind == RecordKind::Edit) {
      at_.triangles = triangles;
      refine_edit();
      triangles = at_.triangles;
      continue;
    }
    const std::uint64_t count = corners_of(shape);
    const std::uint8_t* const from = corners + corner_at * Bytes;
    if (corner_at + count + fetch_ahead <= corner_total) {
      for (std::uint64_t i = 0; i < count; ++i) {
        __builtin_prefetch(indices + load_corner<Bytes>(from + (i + fetch_ahead) * Bytes), 1);
      }
      if (moves_vertices) fetch_vertex(arrays_.exact, indices[load_corner<Bytes>(from + fetch_values_ahead * Bytes)]);
    }
    const CornerId first = load_corner<Bytes>(from);
    const CornerId last = load_corner<Bytes>(from + (count - 1) * Bytes);
    const Index v = indices[first];
    const Index a = indices[next_corner(first)];
    const Index b = indices[previous_corner(last)];
    const auto s = static_cast<Index>(at_.vertices++);
    for (std::uint64_t i = 0; i < count; ++i) {
      const CornerId corner = load_corner<Bytes>(from + i * Bytes);
      indices[corner] = s;
      marks[corner >> shift] = 1;
    }
    corner_at += count;
    DrawRange& draw = fan_draw(at_.fan_record++);
    const CornerId begin = draw.first_index + draw.index_count;
    CornerId end = begin;
    if (kind != RecordKind::FanRight) {
      indices[end] = s;
      indices[end + 1] = v;
      indices[end + 2] = a;
      end += 3;
    }
    if (kind != RecordKind::FanLeft) {
      indices[end] = s;
      indices[end + 1] = b;
      indices[end + 2] = v;
      end += 3;
    }
    marks[begin >> shift] = 1;
    marks[(end - 1) >> shift] = 1;
    draw.index_count += end - begin;
    triangles += fan_faces(kind);
    if (moves(shape)) {
      move_vertex(arrays_, v, data_.value_xor.data() + at_.value_word);
      at_.value_word += words_;
    }
  }
  at_.fan_corner = corner_at;
  at_.triangles = triangles;
  at_.level = to;
}

template <class Index, unsigned Bytes>
void Player<Index, Bytes>::coarsen(Level to) noexcept {
  Index* const indices = indices_;
  std::uint8_t* const marks = arrays_.index_marks;
  const unsigned shift = arrays_.mark_shift;
  const std::uint8_t* const corners = data_.fan_corners.data();
  const std::uint8_t* const shapes = data_.shapes.data();
  std::uint64_t corner_at = at_.fan_corner;
  const bool moves_vertices = moves_vertices_;
  std::uint32_t triangles = at_.triangles;
  for (Level record = at_.level; record-- > to;) {
    const std::uint8_t shape = shapes[record];
    const RecordKind kind = kind_of(shape);
    if (kind == RecordKind::Edit) {
      at_.triangles = triangles;
      coarsen_edit();
      triangles = at_.triangles;
      continue;
    }
    const std::uint64_t count = corners_of(shape);
    corner_at -= count;
    const std::uint8_t* const from = corners + corner_at * Bytes;
    if (corner_at >= fetch_ahead) {
      for (std::uint64_t i = 0; i < count; ++i) {
        __builtin_prefetch(indices + load_corner<Bytes>(from + i * Bytes - fetch_ahead * Bytes), 1);
      }
    }
    DrawRange& draw = fan_draw(--at_.fan_record);
    const CornerId end = draw.first_index + draw.index_count;
    if (moves_vertices && draw.index_count > 3 * fetch_faces_ahead) {
      fetch_vertex(arrays_.exact, indices[end - 1 - 3 * fetch_faces_ahead]);
    }
    // v is corner 1 of a left face, corner 2 of a right one; the last face is left only if there is no right one.
    const Index v = indices[kind == RecordKind::FanLeft ? end - 2 : end - 1];
    draw.index_count -= 3 * fan_faces(kind);
    triangles -= fan_faces(kind);
    --at_.vertices;
    for (std::uint64_t i = 0; i < count; ++i) {
      const CornerId corner = load_corner<Bytes>(from + i * Bytes);
      indices[corner] = v;
      marks[corner >> shift] = 1;
    }
    if (moves(shape)) {
      at_.value_word -= words_;
      move_vertex(arrays_, v, data_.value_xor.data() + at_.value_word);
    }
  }
  at_.fan_corner = corner_at;
  at_.triangles = triangles;
  at_.level = to;
}

template <class Index, unsigned Bytes>
void Player<Index, Bytes>::refine_edit() noexcept {
  const EditBlock block{data_.edits.data() + at_.edit_word};
  xor_corners(block);
  for (const std::uint32_t* word = block.groups(); word != block.corners();) {
    DrawRange& draw = arrays_.draws[word[0]];
    const std::uint32_t count = 3 * word[1];
    word += 2;
    for (std::uint32_t i = 0; i < count; ++i, ++draw.index_count) {
      const CornerId corner = draw.first_index + draw.index_count;
      indices_[corner] = static_cast<Index>(*word++);
      arrays_.index_marks[corner >> arrays_.mark_shift] = 1;
    }
  }
  move_all(block);
  at_.value_word += static_cast<std::uint64_t>(block.move_count()) * words_;
  at_.vertices += block.vertex_count();
  at_.triangles += block.face_count();
  at_.edit_word += block.length();
}

template <class Index, unsigned Bytes>
void Player<Index, Bytes>::coarsen_edit() noexcept {
  at_.edit_word -= data_.edits[at_.edit_word - 1];
  const EditBlock block{data_.edits.data() + at_.edit_word};
  at_.value_word -= static_cast<std::uint64_t>(block.move_count()) * words_;
  at_.vertices -= block.vertex_count();
  at_.triangles -= block.face_count();
  for (const std::uint32_t* word = block.groups(); word != block.corners(); word += 2 + 3 * word[1]) {
    arrays_.draws[word[0]].index_count -= 3 * word[1];
  }
  xor_corners(block);
  move_all(block);
}

template <class Index, unsigned Bytes>
void play(const ModelData& data, const PlayArrays& arrays, StackPosition& at, Level to) noexcept {
  Player<Index, Bytes> player{data, arrays, at};
  if (to > at.level) {
    player.refine(to);
  } else {
    player.coarsen(to);
  }
}

}  // namespace

PlayFunction select_play(std::uint32_t index_bytes, std::uint32_t corner_bytes) noexcept {
  if (index_bytes == 2) return corner_bytes == 3 ? play<std::uint16_t, 3> : play<std::uint16_t, 4>;
  return corner_bytes == 3 ? play<std::uint32_t, 3> : play<std::uint32_t, 4>;
}

}  // namespace lodestone::progressive
