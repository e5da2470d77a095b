// SPDX-License-Identifier: MIT
// The base and the records of a model to and from columns, by replaying the stack on both sides.
//
// Based on: Hoppe 1996 and 1998 (a vertex split is a vertex and two edges of its ring); Lindstrom and Isenburg 2006
// (floats as ordered integers). Differs: a split names a run of corners in a list that both sides keep, so that dirty
// meshes need no half-edges; the depth of a new vertex is predicted on the plane of its ring once its two other
// coordinates are known.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/progressive_model.h>

#include "columns.h"
#include "topology.h"
#include "values.h"

namespace lodestone::model_file {

// The columns of every block, in file order. `Values` are groups of nine: position 3, normal 3, uv 2, colour 1.
enum Column : std::uint32_t {
  Summary,     // counts of the block
  ErrorLevel,  // error steps
  ErrorBits,
  Kind,                 // per record: RecordKind, + 4 moves, + 8 NameMode, + 32 split vertex lies before the last
  Split,                // distance of the split vertex from the one before
  Ring,                 // 8 columns by valence 1..8: start * valence + count - 1
  RingWide = Ring + 8,  // start, count where the valence is larger
  Corner,               // count, then corners by place in the list or by number
  Material,             // 0: that of the first corner's face
  Feature,
  NewValues,  // vertices that fans add, and those of the base
  MovedValues = NewValues + 9,
  EditValues = MovedValues + 9,
  EditCount = EditValues + 9,  // per edit 5 counts
  EditMerge,
  EditGroup,
  EditFace,  // the Edit* columns below name a vertex or corner by its place in the edit's vocabulary
  EditCorner,
  EditTo,
  EditMoved,
  EditEscape,  // what the vocabulary lacks
  EditSame,
  ColumnCount,
};
static_assert(ColumnCount == 53);

enum class NameMode : std::uint32_t {
  Run = 0,     // a run of the ring around the split vertex
  List = 1,    // places in its list
  Number = 2,  // corner numbers: the vertex has no list
};

using WrittenColumns = std::array<ColumnWriter, ColumnCount>;
using ReadColumns = std::array<ColumnReader, ColumnCount>;

// Writes the base, then blocks of records in order. `data` must be that of a valid model.
class StackWriter {
 public:
  StackWriter(const ModelData& data, const Grid& grid);
  ~StackWriter();
  StackWriter(const StackWriter&) = delete;
  StackWriter& operator=(const StackWriter&) = delete;
  void base(WrittenColumns& columns);
  void records(std::uint32_t count, WrittenColumns& columns);

  class Implementation;

 private:
  std::unique_ptr<Implementation> implementation_;
};

// What stands in the `Summary` column of a block.
struct BlockSummary {
  std::uint32_t vertices = 0;
  std::uint32_t error_steps = 0;
  std::vector<std::pair<MaterialId, std::uint32_t>> faces;
};
// Takes the summary from the front of the block's columns; empty if it is not one.
[[nodiscard]] std::optional<BlockSummary> read_summary(ReadColumns& columns);

// Appends to `data` what blocks hold. Before: `data.vertices` empty but for what `contents` tells, face_begin whole
// (the faces of all blocks to come). A returned string says what is wrong; empty if nothing is.
class StackReader {
 public:
  struct Contents {
    bool normals = false, uvs = false, colors = false, features = false;
    std::uint32_t vertices = 0, records = 0;  // of all blocks to come; only to make room once
  };
  StackReader(ModelData& data, const Grid& grid, const Contents& contents);
  ~StackReader();
  StackReader(const StackReader&) = delete;
  StackReader& operator=(const StackReader&) = delete;
  [[nodiscard]] std::string base(const BlockSummary& summary, ReadColumns& columns);
  [[nodiscard]] std::string records(std::uint32_t count, const BlockSummary& summary, ReadColumns& columns);

  class Implementation;

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lodestone::model_file
