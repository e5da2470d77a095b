// SPDX-License-Identifier: MIT
/// \file
/// A progressive model: a coarse base and a stack of records, each of which adds a little detail. Immutable once made;
/// share it between threads and cursors. Source: Li et al. 2019 (continuous LOD topological data structure, section
/// 2.4: fixed slots, in-use flags, a stack pointer that moves either way), Hoppe 1996 (progressive meshes).
///
/// Slots. Every vertex and every face that any level uses has a fixed slot. Slots are sorted by removal time: those in
/// use at a level are the first `vertex_count(level)` vertices and, per material, the first so many faces of its range.
///
/// Levels. Level 0 is the base, level `record_count()` the source. Record r turns level r into level r + 1 (refine)
/// and back (coarsen); both are the same slot edit, run in opposite order, and are exact to the bit.
///
/// Error. `error_m(level)` is the deviation of that level from the source in metres. It is 0 at the finest level
/// and never decreases towards the base.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lodestone/mesh.h>
#include <lodestone/result.h>
#include <lodestone/types.h>

namespace lodestone {

using Level = std::uint32_t;

/// From this level upwards (until the next step) the error is `error_m`.
struct ErrorStep {
  Level level = 0;
  float error_m = 0.0F;
  friend bool operator==(const ErrorStep&, const ErrorStep&) = default;
};

/// A level with a name: "lod3", "lod2", "lod1", "block".
struct NamedLevel {
  std::string name;
  Level level = 0;
};

/// How a record is stored. `shapes[r]` holds a kind, a corner count and a flag; the record's payload lies at the
/// running position in `fan_corners`, `edits` and `value_xor`, which are walked forwards to refine, backwards to
/// coarsen.
///
/// A *fan* record is the edge collapse of a vertex without seams. Everything but the re-pointed corners follows from
/// the slot order: it adds the vertex s = vertex_count(level) and the last one or two faces of one material. With
/// c0..ck the corners re-pointed from v to s, in ring order counter-clockwise about s, v is what c0 holds before
/// refining, and the faces added are (s, v, a) with a the corner after c0 [left], then (s, b, v) with b the corner
/// before ck [right].
///
/// An *edit* record is the general slot edit (seams, several materials, facet shifts, parts that vanish): a block of
/// 32-bit words in `edits`, laid out as in progressive/record.h and docs/FILE_FORMAT.md.
enum class RecordKind : std::uint8_t { FanBoth = 0, FanLeft = 1, FanRight = 2, Edit = 3 };

struct RecordShape {
  static constexpr std::uint8_t corner_mask = 0x1F;  ///< fan: number of re-pointed corners, 1..31
  static constexpr int kind_shift = 5;               ///< RecordKind, 2 bits
  static constexpr std::uint8_t moves_flag = 0x80;   ///< fan: v's value changes; its XOR is next in `value_xor`
};

/// The whole content of a model as plain arrays: what serialisers read and write.
struct ModelData : Surroundings {
  /// Slot order. The value of a slot is its value at the coarsest level that uses it.
  VertexArrays vertices;
  std::uint32_t base_vertex_count = 0;

  /// Face slots of material m are [face_begin[m], face_begin[m + 1]); size materials + 1.
  std::vector<FaceId> face_begin;
  /// Faces of material m in use at level 0; size materials.
  std::vector<std::uint32_t> base_face_counts;
  /// 3 per base face, material after material.
  std::vector<VertexId> base_indices;
  /// Feature of each face slot; empty if there are none.
  std::vector<FeatureId> face_features;

  /// The stack, in refining order.
  std::vector<std::uint8_t> shapes;          ///< one per record, see RecordShape
  std::uint32_t corner_bytes = 4;            ///< width of an element of fan_corners: 3 or 4
  std::vector<std::uint8_t> fan_corners;     ///< little-endian corner slots (3 * face slot + 0..2)
  std::vector<std::uint16_t> fan_materials;  ///< one per fan record; empty if there is one material
  std::vector<std::uint32_t> edits;          ///< blocks of edit records
  std::vector<std::uint32_t> value_xor;      ///< value_words() per moved vertex, see record.h for the order

  /// Descending errors, ascending levels; the first has level 0.
  std::vector<ErrorStep> errors;
  std::vector<NamedLevel> named_levels;
  std::string method;  ///< "edge-collapse", "facet-shift", "mixed"

  /// 32-bit words of one vertex value: position 3, then normal 3, uv 2, colour 1 where present.
  [[nodiscard]] std::uint32_t value_words() const noexcept;
};

/// Triangles, vertices and error at a level.
struct LevelInfo {
  Level level = 0;
  std::uint32_t triangles = 0;
  std::uint32_t vertices = 0;
  double error_m = 0.0;
};

namespace progressive {
class ModelMaker;
}

class ProgressiveModel {
 public:
  /// Takes data from a file or from a builder outside the library. Replays the whole stack once and checks every index,
  /// count and error, so that cursors need no checks. O(records). Errors: BadData with the record and what is wrong in
  /// it.
  [[nodiscard]] static Result<std::shared_ptr<const ProgressiveModel>> from_data(ModelData data);

  [[nodiscard]] const ModelData& data() const noexcept { return data_; }

  [[nodiscard]] Level record_count() const noexcept { return static_cast<Level>(data_.shapes.size()); }
  [[nodiscard]] std::uint32_t vertex_slot_count() const noexcept { return data_.vertices.size(); }
  [[nodiscard]] std::uint32_t face_slot_count() const noexcept { return data_.face_begin.back(); }
  [[nodiscard]] std::uint32_t material_count() const noexcept {
    return static_cast<std::uint32_t>(data_.base_face_counts.size());
  }

  /// What a level holds. O(log records + 256): checkpoints every 256 records, then the shapes between.
  [[nodiscard]] LevelInfo info(Level level) const noexcept;
  [[nodiscard]] double error_m(Level level) const noexcept;

  /// Triangles at the finest level.
  [[nodiscard]] std::uint32_t triangle_count() const noexcept { return finest_triangles_; }

  /// The finest level with at most this many triangles (level 0 if even that has more).
  [[nodiscard]] Level level_of_triangles(std::uint32_t triangles) const noexcept;
  /// The coarsest level whose error is at most `error_m`.
  [[nodiscard]] Level level_of_error(double error_m) const noexcept;
  /// The level that a name stands for, or BadArgument with the names there are.
  [[nodiscard]] Result<Level> level_of_name(const std::string& name) const;

  /// Box at the finest level, relative to the origin.
  [[nodiscard]] const Box& bounds() const noexcept { return bounds_; }

  /// One level as a mesh of its own: faces in slot order, unused vertices left out. O(records + size).
  [[nodiscard]] Mesh extract(Level level) const;

  /// Bytes held at run time by the arrays of this model, textures not counted.
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  friend class Cursor;
  friend class progressive::ModelMaker;
  ProgressiveModel() = default;

  /// Counts at every 256th level, and where its edits begin: what info() needs to go on from there.
  struct Checkpoint {
    std::uint64_t edit_word = 0;
    std::uint32_t vertices = 0;
    std::uint32_t triangles = 0;
  };

  ModelData data_;
  std::vector<Checkpoint> checkpoints_;
  std::uint32_t finest_triangles_ = 0;
  Box bounds_;
};

/// What a full sweep of the stack, down and up, found.
struct ModelReport {
  std::uint32_t records = 0;
  bool exact = false;              ///< refining after coarsening gave back every byte, at every level tried
  bool monotone = false;           ///< errors never decrease towards the base, triangle counts never increase
  bool in_use_consistent = false;  ///< in-use faces name only in-use vertices; in-use slots are prefixes
  std::string fault;               ///< the first thing found wrong, empty if none
};
[[nodiscard]] ModelReport validate(const ProgressiveModel& model);

/// Whether the finest level of `model` is `source`: the same triangles as a multiset, bit for bit with all attributes
/// (corner order up to rotation), material and feature. A triangle that a producer split to close T-junctions counts as
/// there if its pieces cover it exactly, in its plane within 2 mm, with its own vertices at its corners. Returns what
/// differs, empty if nothing does. O(triangles log triangles), plus the square of the triangles split.
[[nodiscard]] std::string compare_with_source(const ProgressiveModel& model, const Mesh& source);

}  // namespace lodestone
