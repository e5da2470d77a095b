// SPDX-License-Identifier: MIT
// The kernel that applies records: moves a stack pointer over any number of them, either way.
#pragma once

#include <cstdint>

#include <lodestone/cursor.h>

#include "progressive/stack.h"
#include "progressive/values.h"

namespace lodestone::progressive {

// What playing writes.
struct PlayArrays {
  void* indices = nullptr;     // 16 or 32 bits each
  DrawRange* draws = nullptr;  // index_count is the truth of the faces in use
  VertexPointers exact;        // values of the level; positions null if no record moves a vertex
  VertexPointers shown;        // a copy kept for drawing; positions null if `exact` is what is drawn
  std::uint8_t* index_marks = nullptr;
  std::uint8_t* vertex_marks = nullptr;  // null if no record moves a vertex
  unsigned mark_shift = 0;
};

// Goes to level `to`. Precondition: data passed check(), `at` and `arrays` belong together.
using PlayFunction = void (*)(const ModelData& data, const PlayArrays& arrays, StackPosition& at, Level to) noexcept;

// The kernel for this width of indices (2, 4) and corner slots (3, 4).
[[nodiscard]] PlayFunction select_play(std::uint32_t index_bytes, std::uint32_t corner_bytes) noexcept;

}  // namespace lodestone::progressive
