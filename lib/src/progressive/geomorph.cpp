// SPDX-License-Identifier: MIT
// Based on: Hoppe 1996, Progressive Meshes, section 3.2 (geomorphs: a vertex moves to its ancestor, attributes too).
// Differs: bounded in time, not tied to two levels: any number of records glide at once, each batch by its own clock,
// and the picture is a function of (level, batches) alone, so turning back at any instant is seamless. Records that
// draw faces anew are cross-faded as well (Li et al. 2019, section 3.3, fade between two whole models; here two levels
// of one cursor that are a fraction of a second apart, and only while such records are on their way).
#include "progressive/geomorph.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lodestone::progressive {
namespace {

// Starts and ends at rest.
[[nodiscard]] float smooth(float progress) noexcept { return progress * progress * (3.0F - 2.0F * progress); }

[[nodiscard]] glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) noexcept {
  const float square = glm::dot(v, v);
  return square > 1e-12F ? v / std::sqrt(square) : otherwise;
}

[[nodiscard]] std::uint8_t to_byte(float value) noexcept {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

// Draws `slot` the share `weight` of the way to where `target` is drawn.
void blend(const VertexPointers& shown, VertexId slot, VertexId target, float weight) noexcept {
  shown.positions[slot] += weight * (shown.positions[target] - shown.positions[slot]);
  if (shown.normals != nullptr) {
    const glm::vec3 normal = shown.normals[slot];
    shown.normals[slot] = unit_or(normal + weight * (shown.normals[target] - normal), normal);
  }
  if (shown.uvs != nullptr) shown.uvs[slot] += weight * (shown.uvs[target] - shown.uvs[slot]);
  if (shown.colors != nullptr) {
    for (int i = 0; i < 4; ++i) {
      const float from = shown.colors[slot][i];
      shown.colors[slot][i] = to_byte(from + weight * (static_cast<float>(shown.colors[target][i]) - from));
    }
  }
}

// Adds `weight` times (coarse - fine) to what is shown, where `values` turns fine into coarse; `exact` is left coarse.
void add_move(const MorphArrays& arrays, VertexId slot, const std::uint32_t* values, float weight) noexcept {
  const VertexPointers& exact = arrays.exact;
  const VertexPointers& shown = arrays.shown;
  const glm::vec3 position = exact.positions[slot];
  const glm::vec3 normal = exact.normals != nullptr ? exact.normals[slot] : glm::vec3{0.0F};
  const glm::vec2 uv = exact.uvs != nullptr ? exact.uvs[slot] : glm::vec2{0.0F};
  const glm::u8vec4 color = exact.colors != nullptr ? exact.colors[slot] : glm::u8vec4{0};
  xor_value(exact, slot, values);
  shown.positions[slot] += weight * (exact.positions[slot] - position);
  if (exact.normals != nullptr) shown.normals[slot] += weight * (exact.normals[slot] - normal);
  if (exact.uvs != nullptr) shown.uvs[slot] += weight * (exact.uvs[slot] - uv);
  if (exact.colors != nullptr) {
    for (int i = 0; i < 4; ++i) {
      const float change = static_cast<float>(exact.colors[slot][i]) - static_cast<float>(color[i]);
      shown.colors[slot][i] = to_byte(static_cast<float>(shown.colors[slot][i]) + weight * change);
    }
  }
}

}  // namespace

std::uint32_t Geomorph::step(StackPosition& at, Level target, std::uint32_t max_records, double dt_s,
                             DirtyMap& dirty) noexcept {
  restore(at, dirty);
  target = reachable(at, target);
  split_at(at, target);
  std::uint32_t moved = start(at, target, max_records);
  const double share = morph_seconds_ > 0.0 ? std::clamp(dt_s / morph_seconds_, 0.0, 1.0) : 1.0;
  advance(target, static_cast<float>(share));
  moved += land(at, target);
  show(at, dirty);
  return moved;
}

bool Geomorph::any_fades(Level begin, Level end) const noexcept {
  return arrays_.fades != nullptr && std::memchr(arrays_.fades + begin, 1, end - begin) != nullptr;
}

// A batch that fades is not split, it has one share: to a target within it, it goes back to its finer end first.
Level Geomorph::reachable(const StackPosition& at, Level target) const noexcept {
  if (!fading()) return target;
  const std::uint32_t place = fading_place();
  const Level end = end_of(place, at);
  return target > batches_[place].begin && target < end ? end : target;
}

void Geomorph::restore(const StackPosition& at, DirtyMap& dirty) noexcept {
  if (resting()) return;
  for (VertexId slot = low_.vertices; slot < at.vertices; ++slot) copy_value(arrays_.shown, arrays_.fine, slot);
  dirty.mark(low_.vertices, at.vertices);
  if (arrays_.exact.positions == nullptr) return;
  const std::uint32_t words = data_->value_words();
  for (StackPosition walk = low_; walk.level < at.level;) {
    const RecordView record = walk_up(*data_, walk, words);
    for (std::uint32_t i = 0; i < record.move_count; ++i) {
      const VertexId slot = record.moved != nullptr ? record.moved[i] : arrays_.merges[record.first_vertex];
      copy_value(arrays_.shown, arrays_.fine, slot);
      dirty.mark(slot);
    }
  }
}

// After it every batch lies wholly below or above the target.
void Geomorph::split_at(const StackPosition& at, Level target) noexcept {
  if (resting() || target <= low_.level || target >= at.level) return;
  make_room();
  std::uint32_t place = 0;
  while (place + 1 < count_ && batches_[place + 1].begin <= target) ++place;
  if (batches_[place].begin == target) return;
  StackPosition walk = low_;
  while (walk.level < target) walk_up(*data_, walk, 0);
  insert(place + 1, {target, walk.vertices, batches_[place].progress});
}

std::uint32_t Geomorph::start(StackPosition& at, Level target, std::uint32_t max_records) noexcept {
  if (resting()) low_ = at;
  if (fading()) return 0;
  if (target < low_.level) {
    const Level from = low_.level;
    const Level to = from - std::min(max_records, from - target);
    if (to == from) return 0;
    while (low_.level > to) walk_down(*data_, low_, data_->value_words());
    const bool fades = any_fades(to, from);
    if (fades) fading_ = Fading::Lowest;
    if (!resting() && !fades && batches_[0].progress <= join_progress) {
      batches_[0].begin = to;
      batches_[0].first_vertex = low_.vertices;
    } else {
      make_room();
      insert(0, {to, low_.vertices, 0.0F});
    }
    return 0;
  }
  if (target <= at.level || max_records == 0) return 0;
  const Batch batch{at.level, at.vertices, 1.0F};
  const std::uint32_t count = std::min(max_records, target - at.level);
  const bool fades = any_fades(at.level, at.level + count);
  // What is drawn beside is a level at rest, so what glides below it arrives first.
  if (fades && !resting()) return 0;
  play_(*data_, *play_arrays_, at, at.level + count);
  if (fades) fading_ = Fading::Topmost;
  if (resting() || batches_[count_ - 1].progress < 1.0F - join_progress) {
    make_room();
    insert(count_, batch);
  }
  return count;
}

void Geomorph::advance(Level target, float by) noexcept {
  for (std::uint32_t i = 0; i < count_; ++i) {
    float& progress = batches_[i].progress;
    progress = std::clamp(batches_[i].begin >= target ? progress + by : progress - by, 0.0F, 1.0F);
  }
  // The level below it all is what is seen when the lowest batch has faded: what else is on its way has arrived too.
  if (fading_ == Fading::Lowest && batches_[0].progress >= 1.0F) {
    for (std::uint32_t i = 1; i < count_; ++i) batches_[i].progress = 1.0F;
  }
}

std::uint32_t Geomorph::land(StackPosition& at, Level target) noexcept {
  std::uint32_t moved = 0;
  while (count_ > 0 && batches_[count_ - 1].progress >= 1.0F && batches_[count_ - 1].begin >= target) {
    if (fading() && fading_place() == count_ - 1) fading_ = Fading::No;
    const Level to = batches_[--count_].begin;
    moved += at.level - to;
    play_(*data_, *play_arrays_, at, to);
  }
  while (count_ > 0 && batches_[0].progress <= 0.0F && batches_[0].begin < target) {
    if (fading() && fading_place() == 0) fading_ = Fading::No;
    const Level end = end_of(0, at);
    while (low_.level < end) walk_up(*data_, low_, data_->value_words());
    erase(0);
  }
  if (resting()) low_ = at;
  return moved;
}

void Geomorph::show(const StackPosition& at, DirtyMap& dirty) noexcept {
  if (resting()) return;
  if (arrays_.exact.positions != nullptr) add_moves(at, dirty);
  merge_vertices(at);
  dirty.mark(low_.vertices, at.vertices);
}

// A vertex that stays is drawn at its fine value plus each record's move by the share that record has gone. The fine
// values are walked down to `low` and back, which XOR makes exact.
void Geomorph::add_moves(const StackPosition& at, DirtyMap& dirty) noexcept {
  const std::uint32_t words = data_->value_words();
  StackPosition walk = at;
  for (std::uint32_t b = count_; b-- > 0;) {
    const float glided = smooth(batches_[b].progress);
    while (walk.level > batches_[b].begin) {
      const RecordView record = walk_down(*data_, walk, words);
      const float weight = arrays_.fades != nullptr && arrays_.fades[walk.level] != 0 ? 0.0F : glided;
      const std::uint32_t* values = record.values;
      for (std::uint32_t i = 0; i < record.move_count; ++i, values += words) {
        const VertexId slot = record.moved != nullptr ? record.moved[i] : arrays_.merges[record.first_vertex];
        add_move(arrays_, slot, values, weight);
        dirty.mark(slot);
      }
    }
  }
  while (walk.level < at.level) {
    const RecordView record = walk_up(*data_, walk, words);
    const std::uint32_t* values = record.values;
    for (std::uint32_t i = 0; i < record.move_count; ++i, values += words) {
      const VertexId slot = record.moved != nullptr ? record.moved[i] : arrays_.merges[record.first_vertex];
      xor_value(arrays_.exact, slot, values);
      if (arrays_.shown.normals == nullptr) continue;
      arrays_.shown.normals[slot] = unit_or(arrays_.shown.normals[slot], arrays_.fine.normals[slot]);
    }
  }
}

// Slots ascend, and a vertex merges into a lower one, so where that is drawn is known by then.
void Geomorph::merge_vertices(const StackPosition& at) noexcept {
  for (std::uint32_t b = 0; b < count_; ++b) {
    const float weight = smooth(batches_[b].progress);
    const std::uint32_t end = b + 1 < count_ ? batches_[b + 1].first_vertex : at.vertices;
    if (weight <= 0.0F) continue;
    const bool fades = fading() && b == fading_place();
    for (VertexId slot = batches_[b].first_vertex; slot < end; ++slot) {
      if (fades && goes_far(slot, batches_[b].first_vertex)) continue;
      blend(arrays_.shown, slot, arrays_.merges[slot], weight);
    }
  }
}

// From where it is to where it lies below its batch, whose vertices begin at `first_vertex`.
bool Geomorph::goes_far(VertexId slot, std::uint32_t first_vertex) const noexcept {
  VertexId end = slot;
  while (end >= first_vertex && arrays_.merges[end] != end) end = arrays_.merges[end];
  return glm::distance(arrays_.fine.positions[slot], arrays_.fine.positions[end]) > arrays_.most_glide_m;
}

void Geomorph::insert(std::uint32_t place, const Batch& batch) noexcept {
  std::copy_backward(batches_ + place, batches_ + count_, batches_ + count_ + 1);
  batches_[place] = batch;
  ++count_;
}

void Geomorph::erase(std::uint32_t place) noexcept {
  std::copy(batches_ + place + 1, batches_ + count_, batches_ + place);
  --count_;
}

// Joins the two neighbours nearest in progress when there is no place for two more batches.
void Geomorph::make_room() noexcept {
  while (count_ + 2 > capacity) {
    std::uint32_t best = 1;
    const auto gap = [&](std::uint32_t i) { return std::abs(batches_[i].progress - batches_[i - 1].progress); };
    for (std::uint32_t i = 2; i < count_; ++i) {
      if (gap(i) < gap(best)) best = i;
    }
    erase(best);
  }
}

}  // namespace lodestone::progressive
