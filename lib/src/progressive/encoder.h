// SPDX-License-Identifier: MIT
// Turns records of a log into fans and edits, one after the other, while the mesh they speak of is kept up to date.
#pragma once

#include <cstdint>
#include <vector>

#include "progressive/recorder.h"

namespace lodestone::progressive {

// What becomes of some records: the arrays of ModelData, but front to back in coarsening order, corners in the
// source's numbering.
struct Encoded {
  std::vector<std::uint8_t> shapes;
  std::vector<CornerId> fan_corners;
  std::vector<std::uint16_t> fan_materials;
  std::vector<std::uint32_t> edits;  // each block back to front
  std::vector<std::uint32_t> value_xor;
};

// The level reached, in the numbering of the source.
struct Replayed {
  static constexpr std::uint8_t in_use = 3;  // rotation of a face that no record removed yet

  std::vector<VertexId> indices;
  VertexArrays values;                 // empty if nothing moves
  std::vector<std::uint8_t> rotation;  // corner of the source face that is corner 0 of its slot, or in_use
};

// Several may work on one log and one replay at once, if their records are about different faces and vertices.
class Encoder {
 public:
  Encoder(const Mesh& source, EditLog& log, const std::vector<VertexId>& vertex_slot, Replayed& replayed)
      : source_(source), log_(log), vertex_slot_(vertex_slot), replayed_(replayed) {}

  void encode(Range records, Encoded& out);

 private:
  using Spans = EditLog::Spans;

  void fetch(const Spans& record) const;
  void encode(const Spans& record);
  void gather_corners(const Spans& record);
  void gather_moves(const Spans& record);
  [[nodiscard]] const std::uint32_t* move_words(std::uint32_t move) const;
  [[nodiscard]] bool changes_value(std::uint32_t move) const;
  [[nodiscard]] bool fan(const Spans& record, RecordKind& kind);
  [[nodiscard]] bool rotate_to_front(FaceId face, VertexId s);
  [[nodiscard]] bool order_ring(VertexId a, VertexId b);
  void encode_fan(const Spans& record, RecordKind kind);
  void encode_edit(const Spans& record);
  void push_values();

  const Mesh& source_;
  EditLog& log_;
  const std::vector<VertexId>& vertex_slot_;  // of each source vertex
  Replayed& replayed_;
  Encoded* out_ = nullptr;
  std::vector<RepointedCorner> corners_;  // of the record at hand
  std::vector<std::uint32_t> moves_;      // likewise, positions in the log
  std::vector<std::uint32_t> scratch_;
};

}  // namespace lodestone::progressive
