// SPDX-License-Identifier: MIT
// Slot edits in the numbering of the source, as those who make them hand them to those who record them.
#pragma once

#include <cstdint>
#include <span>

#include <lodestone/types.h>

namespace lodestone {

struct RemovedVertex {
  VertexId vertex = none;
  VertexId merges_into = none;
};

struct RepointedCorner {
  CornerId corner = none;
  VertexId to = none;
};

// Where the parts of one record end in the arrays of its log.
struct RecordEnds {
  float error_m = 0.0F;
  std::uint32_t faces = 0, vertices = 0, corners = 0, moves = 0;
};

// Many records at once: their parts one after the other, and where each record's end, counted from `base`. Runs of one
// pass but different lanes are about different faces and vertices.
struct EditRun {
  std::span<const FaceId> faces;
  std::span<const RemovedVertex> vertices;
  std::span<const RepointedCorner> corners;
  std::span<const VertexId> moved;
  std::span<const std::uint32_t> values;
  std::span<const RecordEnds> records;
  RecordEnds base;
  std::uint32_t pass = 0;
  std::uint32_t lane = 0;
};

}  // namespace lodestone
