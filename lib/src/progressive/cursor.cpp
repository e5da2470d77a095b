// SPDX-License-Identifier: MIT
#include <lodestone/cursor.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include "progressive/dirty.h"
#include "progressive/geomorph.h"
#include "progressive/play.h"

namespace lodestone {

using progressive::DirtyMap;
using progressive::StackPosition;
using progressive::VertexPointers;

namespace {

constexpr double most_glide_ratio = 0.02;  // of the model's diagonal, beside records that fade

// Hands out arrays from one block. Without a block it only counts the bytes.
class Carver {
 public:
  explicit Carver(std::byte* block) noexcept : block_(block) {}

  template <class T>
  [[nodiscard]] T* take(std::size_t count) noexcept {
    constexpr std::size_t line_bytes = 64;
    size_ = (size_ + line_bytes - 1) / line_bytes * line_bytes;
    const std::size_t at = size_;
    size_ += count * sizeof(T);
    return block_ == nullptr ? nullptr : reinterpret_cast<T*>(block_ + at);
  }
  [[nodiscard]] VertexPointers take_vertices(const VertexArrays& like) noexcept {
    return {take<glm::vec3>(like.positions.size()), like.normals.empty() ? nullptr : take<glm::vec3>(like.size()),
            like.uvs.empty() ? nullptr : take<glm::vec2>(like.size()),
            like.colors.empty() ? nullptr : take<glm::u8vec4>(like.size())};
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::byte* block_;
  std::size_t size_ = 0;
};

void copy_all(const VertexPointers& to, const VertexArrays& from) {
  std::copy(from.positions.begin(), from.positions.end(), to.positions);
  if (to.normals != nullptr) std::copy(from.normals.begin(), from.normals.end(), to.normals);
  if (to.uvs != nullptr) std::copy(from.uvs.begin(), from.uvs.end(), to.uvs);
  if (to.colors != nullptr) std::copy(from.colors.begin(), from.colors.end(), to.colors);
}

}  // namespace

struct Cursor::State {
  StackPosition at;
  Level target = 0;
  bool morphs = false;
  std::uint32_t index_bytes = 4;
  std::size_t block_bytes = 0;
  progressive::PlayArrays arrays;
  progressive::PlayFunction play = nullptr;
  VertexPointers shown;  // what is drawn; positions null if it is the model's own arrays
  VertexId* merges = nullptr;
  std::uint8_t* fading = nullptr;  // per record: 1 if it draws faces anew; null if nothing is to fade
  progressive::Geomorph geomorph;
  DirtyMap dirty_indices, dirty_vertices;

  // Only edits can draw faces anew.
  static bool fades(const ProgressiveModel& model, const CursorOptions& options) {
    return options.motion == Motion::MorphFade && !model.data().edits.empty();
  }
  static std::size_t carve(std::byte* block, const ProgressiveModel& model, const CursorOptions& options);
  void fill(const ProgressiveModel& model, const CursorOptions& options, Level start);
  void look_up_merges(const ModelData& data);
  [[nodiscard]] bool draws_anew(const progressive::EditBlock& edit, std::uint32_t first_vertex) const;
  template <class Index>
  void fill_base(const ModelData& data);
  [[nodiscard]] VertexId index(CornerId corner) const noexcept {
    return index_bytes == 2 ? static_cast<const std::uint16_t*>(arrays.indices)[corner]
                            : static_cast<const std::uint32_t*>(arrays.indices)[corner];
  }
};

// Lays out the block; with a null block only tells its size.
std::size_t Cursor::State::carve(std::byte* block, const ProgressiveModel& model, const CursorOptions& options) {
  constexpr std::uint32_t short_slots = 1U << 16U;
  constexpr std::uint32_t least_dirty_block = 64;
  const ModelData& data = model.data();
  const std::uint32_t slots = model.vertex_slot_count();
  const std::uint32_t corners = 3 * model.face_slot_count();
  const bool moves = !data.value_xor.empty();
  const auto shift = static_cast<unsigned>(std::bit_width(std::max(options.dirty_block, least_dirty_block)) - 1);

  Carver carver{block};
  State fields;
  State* place = carver.take<State>(1);
  fields.morphs = options.motion != Motion::Hard;
  fields.index_bytes = options.index_width == IndexWidth::Smallest && slots <= short_slots ? 2 : 4;
  fields.play = progressive::select_play(fields.index_bytes, data.corner_bytes);
  fields.arrays.indices = carver.take<std::byte>(static_cast<std::size_t>(corners) * fields.index_bytes);
  fields.arrays.draws = carver.take<DrawRange>(model.material_count());
  fields.arrays.mark_shift = shift;
  if (moves) fields.arrays.exact = carver.take_vertices(data.vertices);
  fields.shown = fields.arrays.exact;
  if (fields.morphs) {
    fields.shown = carver.take_vertices(data.vertices);
    fields.merges = carver.take<VertexId>(slots);
    if (fades(model, options)) fields.fading = carver.take<std::uint8_t>(data.shapes.size());
    if (moves) fields.arrays.shown = fields.shown;
  }
  const auto take_dirty = [&](std::uint32_t elements) {
    auto* marks = carver.take<std::uint8_t>(DirtyMap::block_count(elements, shift));
    auto* ranges = carver.take<Range>(DirtyMap::range_count(elements, shift));
    return block == nullptr ? DirtyMap{} : DirtyMap{elements, shift, marks, ranges};
  };
  fields.dirty_indices = take_dirty(corners);
  fields.dirty_vertices = take_dirty(slots);
  fields.arrays.index_marks = fields.dirty_indices.marks();
  fields.arrays.vertex_marks = fields.dirty_vertices.marks();
  fields.block_bytes = carver.size();
  if (block != nullptr) new (place) State{fields};
  return carver.size();
}

template <class Index>
void Cursor::State::fill_base(const ModelData& data) {
  auto* indices = static_cast<Index*>(arrays.indices);
  const VertexId* from = data.base_indices.data();
  for (MaterialId m = 0; m < data.base_face_counts.size(); ++m) {
    arrays.draws[m] = {m, 3 * data.face_begin[m], 3 * data.base_face_counts[m]};
    for (std::uint32_t i = 0; i < arrays.draws[m].index_count; ++i) {
      indices[arrays.draws[m].first_index + i] = static_cast<Index>(*from++);
    }
    at.triangles += data.base_face_counts[m];
  }
}

void Cursor::State::fill(const ProgressiveModel& model, const CursorOptions& options, Level start) {
  const ModelData& data = model.data();
  std::memset(arrays.indices, 0, 3 * static_cast<std::size_t>(data.face_begin.back()) * index_bytes);
  if (index_bytes == 2) {
    fill_base<std::uint16_t>(data);
  } else {
    fill_base<std::uint32_t>(data);
  }
  at.vertices = data.base_vertex_count;
  target = start;
  if (arrays.exact.positions != nullptr) copy_all(arrays.exact, data.vertices);
  if (morphs) {
    copy_all(shown, data.vertices);
    look_up_merges(data);
    progressive::MorphArrays morph;
    morph.exact = arrays.exact;
    morph.fine = arrays.exact.positions != nullptr ? read_only(arrays.exact) : progressive::pointers(data.vertices);
    morph.shown = shown;
    morph.merges = merges;
    morph.fades = fading;
    morph.most_glide_m = static_cast<float>(most_glide_ratio * model.bounds().diagonal_m());
    geomorph = progressive::Geomorph{&data, &arrays, play, morph, std::clamp(options.morph_seconds, 0.0, 10.0)};
  }
  play(data, arrays, at, start);
  geomorph.rest(at);
}

// Plays the whole stack up, noting where each fan's vertex splits from and which edits draw faces anew, and down again.
void Cursor::State::look_up_merges(const ModelData& data) {
  for (VertexId slot = 0; slot < data.base_vertex_count; ++slot) merges[slot] = slot;
  const std::uint32_t words = data.value_words();
  while (at.level < data.shapes.size()) {
    const StackPosition below = at;
    StackPosition walk = at;
    const progressive::RecordView record = progressive::walk_up(data, walk, words);
    for (std::uint32_t i = 0; i < record.vertex_count; ++i) {
      merges[record.first_vertex + i] =
          record.merges != nullptr ? record.merges[i] : index(progressive::load_corner(data, at.fan_corner));
    }
    play(data, arrays, at, at.level + 1);
    if (fading == nullptr) continue;
    const bool anew = record.merges != nullptr &&
                      draws_anew(progressive::EditBlock{data.edits.data() + below.edit_word}, below.vertices);
    fading[below.level] = anew ? 1 : 0;
    // What fades stays where it is: gliding to where the new faces are not would shear the old ones.
    for (VertexId slot = below.vertices; anew && slot < at.vertices; ++slot) merges[slot] = slot;
  }
  play(data, arrays, at, 0);
}

// Whether faces are elsewhere once all vertices of this edit have come to where they merge: a corner that is re-pointed
// to another vertex than that, or a face that goes and still has an area. A fan never does either. The indices are
// those above the edit.
bool Cursor::State::draws_anew(const progressive::EditBlock& edit, std::uint32_t first_vertex) const {
  const auto end_of = [&](VertexId slot) {
    while (slot >= first_vertex && merges[slot] != slot) slot = merges[slot];
    return slot;
  };
  for (const std::uint32_t* pair = edit.corners(); pair != edit.moved(); pair += 2) {
    const VertexId fine = index(pair[0]);
    if (end_of(fine) != (fine ^ pair[1])) return true;
  }
  for (const std::uint32_t* group = edit.groups(); group != edit.corners(); group += 2 + 3 * group[1]) {
    for (std::uint32_t face = 0; face < group[1]; ++face) {
      const std::uint32_t* corners = group + 2 + 3 * face;
      const VertexId a = end_of(corners[0]);
      const VertexId b = end_of(corners[1]);
      const VertexId c = end_of(corners[2]);
      if (a != b && b != c && c != a) return true;
    }
  }
  return false;
}

Target Target::pixels(const View& view, double max_error_px, double hysteresis) noexcept {
  Target target{Kind::ByPixels, max_error_px};
  target.hysteresis_ = hysteresis;
  target.view_ = view;
  return target;
}

Cursor::Cursor(std::shared_ptr<const ProgressiveModel> model, const CursorOptions& options) : model_(std::move(model)) {
  assert(model_ != nullptr);
  block_.reset(new std::byte[State::carve(nullptr, *model_, options)]);
  State::carve(block_.get(), *model_, options);
  state_ = std::launder(reinterpret_cast<State*>(block_.get()));
  state_->fill(*model_, options, std::min(options.start_level, model_->record_count()));
  if (!State::fades(*model_, options)) return;
  CursorOptions still = options;
  still.motion = Motion::Hard;
  beside_ = std::make_unique<Cursor>(model_, still);
}

void Cursor::set_target(const Target& target) noexcept {
  const double value = target.value_ > 0.0 ? target.value_ : 0.0;  // NaN too
  const auto count = [](double v) { return static_cast<std::uint32_t>(std::min(v, static_cast<double>(none))); };
  switch (target.kind_) {
    case Target::Kind::ByLevel:
      state_->target = std::min(count(value), model_->record_count());
      break;
    case Target::Kind::ByTriangles:
      state_->target = model_->level_of_triangles(count(value));
      break;
    case Target::Kind::ByRatio:
      state_->target = model_->level_of_triangles(count(std::round(value * model_->triangle_count())));
      break;
    case Target::Kind::ByError:
      state_->target = model_->level_of_error(value);
      break;
    case Target::Kind::ByPixels: {
      const Box& box = model_->bounds();
      const Sphere sphere = box.empty() ? Sphere{} : Sphere{box.center(), 0.5 * box.diagonal_m()};
      const double now_px = error_px(target.view_, model_->error_m(state_->target), sphere);
      const bool near_limit =
          now_px >= (1.0 - target.hysteresis_) * value && now_px <= (1.0 + target.hysteresis_) * value;
      if (!near_limit) state_->target = model_->level_of_error(error_m_at(target.view_, value, sphere));
      break;
    }
  }
}

StepResult Cursor::step(const StepBudget& budget, double dt_s) noexcept {
  State& s = *state_;
  StepResult result;
  if (s.morphs) {
    result.changed = !s.geomorph.resting();
    result.records_moved = s.geomorph.step(s.at, s.target, budget.max_records, dt_s, s.dirty_vertices);
    if (s.geomorph.fading()) beside_->jump(s.geomorph.fade_level());
    result.changed = result.changed || result.records_moved > 0 || !s.geomorph.resting();
    result.arrived = s.geomorph.resting() && s.at.level == s.target;
    return result;
  }
  const Level from = s.at.level;
  const Level to = s.target > from ? from + std::min(budget.max_records, s.target - from)
                                   : from - std::min(budget.max_records, from - s.target);
  s.play(model_->data(), s.arrays, s.at, to);
  result.records_moved = to > from ? to - from : from - to;
  result.changed = to != from;
  result.arrived = to == s.target;
  return result;
}

void Cursor::jump(Level level) noexcept {
  State& s = *state_;
  if (s.morphs) s.geomorph.restore(s.at, s.dirty_vertices);
  s.target = std::min(level, model_->record_count());
  s.play(model_->data(), s.arrays, s.at, s.target);
  s.geomorph.rest(s.at);
}

Level Cursor::level() const noexcept { return state_->at.level; }
Level Cursor::target_level() const noexcept { return state_->target; }
bool Cursor::morphing() const noexcept { return !state_->geomorph.resting(); }
std::uint32_t Cursor::vertex_count() const noexcept { return state_->at.vertices; }
std::uint32_t Cursor::triangle_count() const noexcept { return state_->at.triangles; }

float Cursor::fade() const noexcept { return state_->geomorph.fading() ? state_->geomorph.fade_share() : 0.0F; }

double Cursor::error_m() const noexcept {
  return model_->error_m(morphing() ? state_->geomorph.low_level() : state_->at.level);
}

namespace {

template <class T>
std::span<const T> own_or_shared(const T* own, bool shared, const std::vector<T>& models) noexcept {
  if (shared) return models;
  return {own, own == nullptr ? 0 : models.size()};
}

}  // namespace

std::span<const glm::vec3> Cursor::positions() const noexcept {
  const VertexPointers& shown = state_->shown;
  return own_or_shared(shown.positions, shown.positions == nullptr, model_->data().vertices.positions);
}
std::span<const glm::vec3> Cursor::normals() const noexcept {
  const VertexPointers& shown = state_->shown;
  return own_or_shared(shown.normals, shown.positions == nullptr, model_->data().vertices.normals);
}
std::span<const glm::vec2> Cursor::uvs() const noexcept {
  const VertexPointers& shown = state_->shown;
  return own_or_shared(shown.uvs, shown.positions == nullptr, model_->data().vertices.uvs);
}
std::span<const glm::u8vec4> Cursor::colors() const noexcept {
  const VertexPointers& shown = state_->shown;
  return own_or_shared(shown.colors, shown.positions == nullptr, model_->data().vertices.colors);
}

std::uint32_t Cursor::index_bytes() const noexcept { return state_->index_bytes; }
std::span<const std::byte> Cursor::indices() const noexcept {
  return {static_cast<const std::byte*>(state_->arrays.indices),
          3 * static_cast<std::size_t>(model_->face_slot_count()) * state_->index_bytes};
}
VertexId Cursor::index(CornerId corner) const noexcept { return state_->index(corner); }

std::span<const DrawRange> Cursor::draws() const noexcept { return {state_->arrays.draws, model_->material_count()}; }

std::span<const Range> Cursor::dirty_vertices() const noexcept { return state_->dirty_vertices.ranges(); }
std::span<const Range> Cursor::dirty_indices() const noexcept { return state_->dirty_indices.ranges(); }
void Cursor::clear_dirty() noexcept {
  state_->dirty_vertices.clear();
  state_->dirty_indices.clear();
}

bool Cursor::vertex_in_use(VertexId slot) const noexcept { return slot < state_->at.vertices; }
bool Cursor::face_in_use(FaceId slot) const noexcept {
  if (slot >= model_->face_slot_count()) return false;
  const auto draws_all = draws();
  const auto above = std::upper_bound(draws_all.begin(), draws_all.end(), 3 * slot,
                                      [](CornerId c, const DrawRange& draw) { return c < draw.first_index; });
  if (above == draws_all.begin()) return false;
  // Ranges without faces share their beginning with the next; the last of them holds the slot.
  const DrawRange& draw = *std::prev(above);
  return 3 * slot - draw.first_index < draw.index_count;
}

std::size_t Cursor::memory_bytes() const noexcept {
  return sizeof(*this) + state_->block_bytes + (beside_ ? beside_->memory_bytes() : 0);
}

}  // namespace lodestone
