// SPDX-License-Identifier: MIT
/// \file
/// A cursor is one instance of a progressive model on the screen: it holds the stack pointer and the arrays to draw.
///
///     lodestone::Cursor cursor{model};                        // starts at the base
///     cursor.set_target(lodestone::Target::ratio(0.25));
///     while (drawing) {
///       cursor.step({.max_records = 20'000}, dt_s);           // moves towards the target, morphing
///       for (auto r : cursor.dirty_vertices()) upload_vertices(r, cursor);
///       for (auto r : cursor.dirty_indices()) upload_indices(r, cursor);
///       cursor.clear_dirty();
///       for (const auto& draw : cursor.draws()) draw_triangles(draw.material, draw.first_index, draw.index_count);
///     }
///
/// All memory is taken at construction; set_target, step and jump allocate nothing, cannot fail and cost O(records
/// moved). Construction costs O(slots + records) with a morph (which looks up where each vertex merges), else O(slots +
/// start level). One cursor belongs to one thread; many cursors share one model.
///
/// Geomorph (Hoppe 1996, section 3.2, bounded in time). A record on its way is drawn with the finer topology, its
/// vertices part of the way to where they merge: position, normal, uv and colour together. Faces go, or come, only at
/// the end where they have no area. Every record takes `morph_seconds`; turning back at any instant is seamless.
///
/// Faces drawn anew. Facet shifts of windows and doors end in faces that no vertex of those before glides to; with
/// Morph these appear at the record's end. With MorphFade they fade in, where they are, while all else glides (but what
/// would go farther than 2 % of the model's diagonal beside such a record fades too). While fade() is above 0, draw
/// beside() as well, and blend that picture over the first by fade():
///
///     draw(cursor, first_frame);
///     if (cursor.fade() > 0.0F) draw(*cursor.beside(), second_frame);
///     present(mix(first_frame, second_frame, cursor.fade()));
///
/// Dithering does as well: the second picture where a pixel's noise (a fixed pattern in 0..1) is below fade(). Records
/// that fade take `morph_seconds` too, with those set in motion together with them; what is asked for meanwhile waits
/// until they have arrived. Models of edge collapses never fade.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <lodestone/progressive_model.h>
#include <lodestone/view.h>

namespace lodestone {

struct DetailFit;

/// Where a cursor should go. The model turns it into a level.
class Target {
 public:
  [[nodiscard]] static Target level(Level level) noexcept { return {Kind::ByLevel, static_cast<double>(level)}; }
  /// At most so many triangles.
  [[nodiscard]] static Target triangles(std::uint32_t count) noexcept {
    return {Kind::ByTriangles, static_cast<double>(count)};
  }
  /// At most this share of the source's triangles, 0..1.
  [[nodiscard]] static Target ratio(double ratio) noexcept { return {Kind::ByRatio, ratio}; }
  /// The coarsest level that deviates by at most so many metres.
  [[nodiscard]] static Target error_m(double error_m) noexcept { return {Kind::ByError, error_m}; }
  /// What an eye cannot tell from the source at `distance_m` from the middle of the model: the coarsest level that
  /// deviates by at most half a pixel there (equation 17 of perception.h). `focal_px` as in view.h. Needs no
  /// preparation, and bounds movement only: many thin bars that go at one small error may be noticed. Where that
  /// matters use the measured plan of `lodestone distances`: `Target::level(needed_level(plan, distance_m))`
  /// (discrete_levels.h).
  [[nodiscard]] static Target perceptual(double distance_m, double focal_px) noexcept {
    return {Kind::ByError, distance_m / (2.0 * focal_px)};
  }
  /// As much of the detail as is seen from `beyond_m` metres beyond the first distance d1 (equation 11 of
  /// perception.h): that share of the source's triangles; all of them up to d1. The paper's optimal level, a bound of
  /// what could be saved; it looks at no level of the model. To choose a level to show use the other ways.
  [[nodiscard]] static Target perceptual(const DetailFit& fit, double beyond_m) noexcept;
  /// The coarsest level that deviates by at most `max_error_px` on the screen. With hysteresis: the target stays while
  /// the error of the present target lies within [1 - h, 1 + h] times the limit, so a camera that rests does not
  /// flicker.
  [[nodiscard]] static Target pixels(const View& view, double max_error_px, double hysteresis = 0.15) noexcept;

 private:
  friend class Cursor;
  enum class Kind : std::uint8_t { ByLevel, ByTriangles, ByRatio, ByError, ByPixels };
  Target(Kind kind, double value) noexcept : kind_(kind), value_(value) {}
  Kind kind_;
  double value_;
  double hysteresis_ = 0.0;
  View view_{};
};

enum class IndexWidth : std::uint8_t {
  Smallest,  ///< 16 bits where every vertex slot fits, else 32
  Bits32,    ///< always 32
};

enum class Motion : std::uint8_t {
  Morph,      ///< records glide (geomorph)
  Hard,       ///< records snap
  MorphFade,  ///< as Morph, and what is drawn anew fades: two pictures are blended while such records are on their way
};

struct CursorOptions {
  /// Morph needs its own copy of the vertices; Hard shares the model's where no record moves a vertex. MorphFade holds
  /// a Hard cursor besides, if the model has edit records.
  Motion motion = Motion::Morph;
  /// Time that one record takes from start to end. Longer is smoother and lags more. Range 0..10.
  double morph_seconds = 0.35;
  IndexWidth index_width = IndexWidth::Smallest;
  /// Dirty ranges are kept at this granularity; smaller means less to upload and more ranges. A power of two, at least
  /// 64 (raised to it).
  std::uint32_t dirty_block = 1024;
  /// Level to start at; clamped to the model's.
  Level start_level = 0;
};

/// How much a step may do.
struct StepBudget {
  std::uint32_t max_records = none;  ///< records set in motion (Morph, MorphFade) or moved (Hard)
};

/// What a step did.
struct StepResult {
  std::uint32_t records_moved = 0;  ///< topology changes done
  bool changed = false;             ///< anything to upload or draw anew
  bool arrived = false;             ///< at the target, nothing in motion
};

/// One draw call: triangles of one material.
struct DrawRange {
  MaterialId material = 0;
  std::uint32_t first_index = 0;  ///< into indices()
  std::uint32_t index_count = 0;
};

class Cursor {
 public:
  explicit Cursor(std::shared_ptr<const ProgressiveModel> model, const CursorOptions& options = {});

  void set_target(const Target& target) noexcept;

  /// Moves towards the target: sets up to `budget` records in motion and advances those on their way by `dt_s` seconds.
  StepResult step(const StepBudget& budget, double dt_s) noexcept;

  /// Goes to the level at once, exactly, without morph; it becomes the target too.
  void jump(Level level) noexcept;

  [[nodiscard]] const ProgressiveModel& model() const noexcept { return *model_; }
  [[nodiscard]] Level level() const noexcept;  ///< of the topology drawn
  [[nodiscard]] Level target_level() const noexcept;
  [[nodiscard]] bool morphing() const noexcept;  ///< records are on their way
  [[nodiscard]] std::uint32_t vertex_count() const noexcept;
  [[nodiscard]] std::uint32_t triangle_count() const noexcept;
  [[nodiscard]] double error_m() const noexcept;  ///< of what is drawn: the coarsest level any record is on its way to

  /// Arrays to draw; sizes are the slot counts, only the in-use prefix is meaningful. Addresses never change.
  [[nodiscard]] std::span<const glm::vec3> positions() const noexcept;
  [[nodiscard]] std::span<const glm::vec3> normals() const noexcept;
  [[nodiscard]] std::span<const glm::vec2> uvs() const noexcept;
  [[nodiscard]] std::span<const glm::u8vec4> colors() const noexcept;
  /// 2 or 4 bytes per index.
  [[nodiscard]] std::uint32_t index_bytes() const noexcept;
  [[nodiscard]] std::span<const std::byte> indices() const noexcept;
  [[nodiscard]] VertexId index(CornerId corner) const noexcept;

  /// One per material, in order; empty ranges included.
  [[nodiscard]] std::span<const DrawRange> draws() const noexcept;

  /// Share 0..1 of beside()'s picture in what is to be seen; 0: this cursor's is all.
  [[nodiscard]] float fade() const noexcept;
  /// What to draw beside while fade() is above 0, with arrays, draws and dirty ranges of its own; step and jump are
  /// left to this cursor. Null if nothing can fade.
  [[nodiscard]] Cursor* beside() noexcept { return beside_.get(); }
  [[nodiscard]] const Cursor* beside() const noexcept { return beside_.get(); }

  /// Element ranges (vertices, indices) that changed since clear_dirty(); sorted, disjoint, blocks of `dirty_block`.
  /// At construction everything is dirty. They cover every changed byte of the arrays.
  [[nodiscard]] std::span<const Range> dirty_vertices() const noexcept;
  [[nodiscard]] std::span<const Range> dirty_indices() const noexcept;
  void clear_dirty() noexcept;

  /// The in-use flags of the paper (bInUse), one per slot.
  [[nodiscard]] bool vertex_in_use(VertexId slot) const noexcept;
  [[nodiscard]] bool face_in_use(FaceId slot) const noexcept;

  /// Bytes held by this cursor (not by the model).
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  struct State;
  std::shared_ptr<const ProgressiveModel> model_;
  std::unique_ptr<std::byte[]> block_;  ///< the one allocation: the state and all arrays
  State* state_ = nullptr;              ///< in block_
  std::unique_ptr<Cursor> beside_;      ///< MorphFade: the level that fades in or out
};

}  // namespace lodestone
