// SPDX-License-Identifier: MIT
// A place in the stack, and the walk over records without applying them.
#pragma once

#include <cstdint>

#include "progressive/record.h"

namespace lodestone::progressive {

// Where a stack pointer stands: running positions in the payload arrays, and what is in use.
struct StackPosition {
  std::uint64_t fan_corner = 0;
  std::uint64_t edit_word = 0;
  std::uint64_t value_word = 0;
  std::uint32_t fan_record = 0;
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
  Level level = 0;
};

// What a record does to vertices, seen from the walk.
struct RecordView {
  std::uint32_t first_vertex = 0;  // slots that refining adds
  std::uint32_t vertex_count = 0;
  std::uint32_t move_count = 0;
  const std::uint32_t* moved = nullptr;   // null for a fan, where the only one is what `first_vertex` merges into
  const std::uint32_t* merges = nullptr;  // of an edit
  const std::uint32_t* values = nullptr;  // XOR words of the moved vertices
};

// Moves `at` over the record above it and tells what that is. Precondition: there is one.
inline RecordView walk_up(const ModelData& data, StackPosition& at, std::uint32_t words) noexcept {
  RecordView view;
  view.first_vertex = at.vertices;
  view.values = data.value_xor.data() + at.value_word;
  const std::uint8_t shape = data.shapes[at.level++];
  if (kind_of(shape) == RecordKind::Edit) {
    const EditBlock block{data.edits.data() + at.edit_word};
    view.vertex_count = block.vertex_count();
    view.move_count = block.move_count();
    view.moved = block.moved();
    view.merges = block.merges();
    at.edit_word += block.length();
    at.triangles += block.face_count();
  } else {
    view.vertex_count = 1;
    view.move_count = moves(shape) ? 1 : 0;
    at.fan_corner += corners_of(shape);
    at.fan_record += 1;
    at.triangles += fan_faces(kind_of(shape));
  }
  at.vertices += view.vertex_count;
  at.value_word += static_cast<std::uint64_t>(view.move_count) * words;
  return view;
}

// The same over the record below.
inline RecordView walk_down(const ModelData& data, StackPosition& at, std::uint32_t words) noexcept {
  RecordView view;
  const std::uint8_t shape = data.shapes[--at.level];
  if (kind_of(shape) == RecordKind::Edit) {
    at.edit_word -= data.edits[at.edit_word - 1];
    const EditBlock block{data.edits.data() + at.edit_word};
    view.vertex_count = block.vertex_count();
    view.move_count = block.move_count();
    view.moved = block.moved();
    view.merges = block.merges();
    at.triangles -= block.face_count();
  } else {
    view.vertex_count = 1;
    view.move_count = moves(shape) ? 1 : 0;
    at.fan_corner -= corners_of(shape);
    at.fan_record -= 1;
    at.triangles -= fan_faces(kind_of(shape));
  }
  at.vertices -= view.vertex_count;
  at.value_word -= static_cast<std::uint64_t>(view.move_count) * words;
  view.first_vertex = at.vertices;
  view.values = data.value_xor.data() + at.value_word;
  return view;
}

}  // namespace lodestone::progressive
