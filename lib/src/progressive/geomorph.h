// SPDX-License-Identifier: MIT
// Records on their way. Those in flight are one stretch of the stack, [low, level): drawn with the finer topology,
// their vertices part of the way to where they merge. The stretch is cut into batches, each of one progress.
//
// Records that draw faces anew cannot glide: where their vertices end is not where the new faces lie. They stay as they
// are and fade: a batch with such a record is the last to start, at either end of the stretch, and until it has arrived
// the level below it is drawn too (by a second cursor), blended by its progress. Others of the batch glide as ever, but
// not far: chains of slides across a wall would shear what stays.
#pragma once

#include <cstdint>
#include <span>

#include "progressive/dirty.h"
#include "progressive/play.h"

namespace lodestone::progressive {

// Records [begin, begin of the next batch) or, for the last, [begin, level).
struct Batch {
  Level begin = 0;
  std::uint32_t first_vertex = 0;  // vertices in use at level `begin`
  float progress = 0.0F;           // 0 = drawn as it is at `level`, 1 = drawn as if coarsened
};

// Memory that a Geomorph uses, given at construction.
struct MorphArrays {
  ConstVertexPointers fine;             // values of the level drawn
  VertexPointers exact;                 // the same to write, positions null if no record moves a vertex
  VertexPointers shown;                 // what is drawn
  const VertexId* merges = nullptr;     // per slot: the lower slot it lies upon when it goes, or itself
  const std::uint8_t* fades = nullptr;  // per record: 1 if it draws faces anew; null: nothing fades
  float most_glide_m = 0.0F;            // of vertices in a batch that fades: those that go farther stay and fade too
};

class Geomorph {
 public:
  Geomorph() = default;
  Geomorph(const ModelData* data, const PlayArrays* play_arrays, PlayFunction play, const MorphArrays& arrays,
           double morph_seconds) noexcept
      : data_(data), play_arrays_(play_arrays), play_(play), arrays_(arrays), morph_seconds_(morph_seconds) {}

  // Everything rests at `at`.
  void rest(const StackPosition& at) noexcept {
    low_ = at;
    count_ = 0;
    fading_ = Fading::No;
  }
  [[nodiscard]] bool resting() const noexcept { return count_ == 0; }
  [[nodiscard]] Level low_level() const noexcept { return low_.level; }
  [[nodiscard]] bool fading() const noexcept { return fading_ != Fading::No; }
  // The level drawn beside, and its share 0..1 of the picture. Precondition: fading().
  [[nodiscard]] Level fade_level() const noexcept { return batches_[fading_place()].begin; }
  [[nodiscard]] float fade_share() const noexcept { return batches_[fading_place()].progress; }

  // One step: sets up to `max_records` in motion towards `target`, moves those on their way by `dt_s`, applies those
  // that arrived. Returns how many records changed the topology.
  std::uint32_t step(StackPosition& at, Level target, std::uint32_t max_records, double dt_s, DirtyMap& dirty) noexcept;

  // Gives every vertex in flight its value at the level drawn.
  void restore(const StackPosition& at, DirtyMap& dirty) noexcept;

 private:
  static constexpr std::uint32_t capacity = 256;
  // A batch that has come no further than this takes in the records of the next step: with the smooth start and end of
  // the motion they jump by 0.02 % of their way.
  static constexpr float join_progress = 1.0F / 128.0F;

  // Which batch fades. Nothing starts while one does, so it stays at its end of the stretch.
  enum class Fading : std::uint8_t { No, Lowest, Topmost };
  [[nodiscard]] std::uint32_t fading_place() const noexcept { return fading_ == Fading::Lowest ? 0 : count_ - 1; }
  [[nodiscard]] bool any_fades(Level begin, Level end) const noexcept;

  [[nodiscard]] Level reachable(const StackPosition& at, Level target) const noexcept;
  void split_at(const StackPosition& at, Level target) noexcept;
  std::uint32_t start(StackPosition& at, Level target, std::uint32_t max_records) noexcept;
  void advance(Level target, float by) noexcept;
  std::uint32_t land(StackPosition& at, Level target) noexcept;
  void show(const StackPosition& at, DirtyMap& dirty) noexcept;
  void add_moves(const StackPosition& at, DirtyMap& dirty) noexcept;
  void merge_vertices(const StackPosition& at) noexcept;
  [[nodiscard]] bool goes_far(VertexId slot, std::uint32_t first_vertex) const noexcept;

  void insert(std::uint32_t place, const Batch& batch) noexcept;
  void erase(std::uint32_t place) noexcept;
  void make_room() noexcept;
  [[nodiscard]] Level end_of(std::uint32_t place, const StackPosition& at) const noexcept {
    return place + 1 < count_ ? batches_[place + 1].begin : at.level;
  }

  const ModelData* data_ = nullptr;
  const PlayArrays* play_arrays_ = nullptr;
  PlayFunction play_ = nullptr;
  MorphArrays arrays_;
  double morph_seconds_ = 0.0;
  StackPosition low_;
  std::uint32_t count_ = 0;
  Fading fading_ = Fading::No;
  Batch batches_[capacity];  // by level, coarsest first
};

}  // namespace lodestone::progressive
