// SPDX-License-Identifier: MIT
// Base, fans and edits, one text for writing and reading (see value_codec.h).
#pragma once

#include "replay.h"

namespace lodestone::model_file {

// `Store` is a WriteStore or a ReadStore. Every function returns what is wrong, null if nothing is; writing a valid
// model cannot fail.
template <class Space, class Io, class Store>
class RecordCodec : protected Replay<Space, Io> {
  using Base = Replay<Space, Io>;

 public:
  using Fault = const char*;
  static constexpr Fault fine = nullptr;

  RecordCodec(const ModelData& data, const ValueLayout& layout, Store store)
      : Base(data, layout), store_(std::move(store)) {}

  // Sees to it that room for so many vertices is taken once.
  void reserve(std::uint32_t vertices) {
    Base::reserve(vertices);
    store_.reserve(vertices);
  }
  // Makes room for the vertices of a block.
  void open_block(std::uint32_t vertices) {
    Base::make_room(topology_.vertex_count() + vertices);
    store_.open_block(vertices);
  }
  [[nodiscard]] VertexId last_split() const noexcept { return last_split_; }
  // One step of a LookAhead.
  template <class Ahead>
  void fetch_ahead(Ahead& ahead) const noexcept {
    ahead.step(topology_, [this](VertexId v) { __builtin_prefetch(Base::value(v)); });
  }
  // Whether the block had just as many.
  [[nodiscard]] bool full() const noexcept { return !topology_.has_room_for_vertices(1); }

  // `counts`: base faces per material; `indices`: 3 per face, filled when reading.
  Fault base(Io& io, std::uint32_t vertex_count, std::span<const std::uint32_t> counts, std::span<VertexId> indices) {
    if (!topology_.has_room_for_vertices(vertex_count)) return too_many_vertices;
    for (std::uint32_t v = 0; v < vertex_count; ++v) topology_.add_vertex();
    VertexId* corner = indices.data();
    VertexId previous = 0;
    for (MaterialId m = 0; m < counts.size(); ++m) {
      if (!topology_.has_room(m, counts[m])) return "the base has more faces than the model";
      for (std::uint32_t f = 0; f < counts[m]; ++f, corner += 3) {
        for (int c = 0; c < 3; ++c) {
          corner[c] = previous = code_difference(io, Split, corner[c], previous);
          if (previous >= vertex_count) return "a base face names no vertex";
        }
        code_feature(io, topology_.add_face(m, corner[0], corner[1], corner[2]), Base::last_feature_);
        previous = corner[0];
      }
    }
    for (VertexId v = 0; v < vertex_count; ++v) code_new(io, NewValues, v, guess_base(v), true);
    return fine;
  }

  ErrorStep error_step(Io& io, ErrorStep step) {
    step.level = last_error_.level + io.code(ErrorLevel, step.level - last_error_.level);
    const auto before = std::bit_cast<std::uint32_t>(last_error_.error_m);
    step.error_m =
        std::bit_cast<float>(before - io.code(ErrorBits, before - std::bit_cast<std::uint32_t>(step.error_m)));
    return last_error_ = step;
  }

  // `kind_word`: the word of the Kind column.
  Fault fan(Io& io, std::uint32_t kind_word, Fan& fan) {
    const auto mode = static_cast<NameMode>((kind_word >> 3) & 3U);
    VertexId split = none;
    if (const Fault fault = code_corners(io, mode, (kind_word & 32U) != 0, fan, split); fault != fine) return fault;
    fan.material = code_material(io, fan);
    const Guess guess = Base::guess_inside(Base::ring_of(fan, split));
    const FeatureId expected = store_.has_features() ? features_[fan.corners[0] / 3] : none;
    if (!topology_.has_room_for_vertices(1)) return too_many_vertices;
    const VertexId added = topology_.add_vertex();
    const FaceId face = fan.material < topology_.material_count() ? topology_.next_face(fan.material) : 0;
    if (!Base::apply(fan, split, added)) return "a fan does not fit the faces";
    code_new(io, NewValues, added, guess, true);
    for (FaceId f = face; f < face + (fan.kind == RecordKind::FanBoth ? 2 : 1); ++f) code_feature(io, f, expected);
    if (fan.moves) {
      Guess back = Base::guess_like(split);
      back.position += back.position - Base::position(added);
      back.across = guess.across;
      code_move(io, MovedValues, split, back);
    }
    return fine;
  }

  // What the Kind column says of a fan that is to be written.
  [[nodiscard]] std::uint32_t kind_word(const Fan& fan) {
    const VertexId split = topology_.vertex(fan.corners[0]);
    NameMode mode = NameMode::Number;
    if (topology_.listed(split)) {
      const auto star = topology_.star(split);
      std::array<CornerId, max_fan_corners> run;
      const bool runs = Base::walk_ring(star, place(star, fan.corners[0]), fan.count, run.data());
      mode = runs && std::equal(run.begin(), run.begin() + fan.count, fan.corners.begin()) ? NameMode::Run
                                                                                           : NameMode::List;
    }
    return static_cast<std::uint32_t>(fan.kind) | (fan.moves ? 4U : 0U) | static_cast<std::uint32_t>(mode) << 3 |
           (split < last_split_ ? 32U : 0U);
  }

  Fault edit(Io& io, Edit& edit) {
    for (auto* count : {&edit.vertices, &edit.faces, &edit.groups, &edit.corners, &edit.moves}) {
      *count = io.code(EditCount, *count);
    }
    if constexpr (!Io::writing) {
      const auto left = [&](Column column) { return (*io.columns)[column].left(); };
      if (edit.vertices > left(EditMerge) || edit.groups > left(EditGroup) || 3ULL * edit.faces > left(EditFace) ||
          edit.corners > left(EditCorner) || edit.moves > left(EditMoved)) {
        return "an edit is longer than its block";
      }
      edit.words.resize(std::size_t{edit.vertices} + 2 * std::size_t{edit.groups} + 3 * std::size_t{edit.faces} +
                        2 * std::size_t{edit.corners} + edit.moves);
    }
    const VertexId first = topology_.vertex_count();
    std::uint32_t* at = edit.words.data();
    for (std::uint32_t i = 0; i < edit.vertices; ++i) {
      at[i] = Base::last_vertex_ = code_difference(io, EditMerge, at[i], Base::last_vertex_);
      if (at[i] > first + i) return "a vertex merges into a later one";
    }
    const std::span<const std::uint32_t> merges{at, edit.vertices};
    Base::build_vocabulary(first, merges);
    if (!topology_.has_room_for_vertices(edit.vertices)) return too_many_vertices;
    for (std::uint32_t i = 0; i < edit.vertices; ++i) topology_.add_vertex();
    std::uint32_t* groups = at + edit.vertices;
    std::uint32_t* corners = groups + 2 * std::size_t{edit.groups} + 3 * std::size_t{edit.faces};
    std::uint32_t* moved = corners + 2 * std::size_t{edit.corners};
    if (const Fault fault = edit_corners(io, {corners, moved}); fault != fine) return fault;
    if (const Fault fault = edit_faces(io, edit.groups, {groups, corners}); fault != fine) return fault;
    return edit_values(io, first, merges, {moved, edit.moves});
  }

 private:
  static constexpr Fault too_many_vertices = "a block adds more vertices than it should";
  using Base::last_error_;
  using Base::last_split_;
  using Base::topology_;

  [[nodiscard]] static std::uint32_t place(std::span<const CornerId> star, CornerId corner) noexcept {
    return static_cast<std::uint32_t>(std::find(star.begin(), star.end(), corner) - star.begin());
  }

  // Names the corners of a fan, and with them the vertex that it splits.
  Fault code_corners(Io& io, NameMode mode, bool back, Fan& fan, VertexId& split) {
    if (mode == NameMode::Number) return code_numbers(io, fan, split);
    split = Io::writing ? topology_.vertex(fan.corners[0]) : none;
    const std::uint32_t step = io.code(Split, back ? last_split_ - split : split - last_split_);
    split = back ? last_split_ - step : last_split_ + step;
    if (split >= topology_.vertex_count() || !topology_.listed(split)) return "a fan splits no vertex";
    last_split_ = split;
    const auto star = topology_.star(split);
    if (star.empty()) return "a fan splits a vertex without faces";
    if (mode == NameMode::List) return code_list(io, star, fan);
    return mode == NameMode::Run ? code_run(io, star, fan) : "a record is of no known kind";
  }

  Fault code_run(Io& io, std::span<const CornerId> star, Fan& fan) {
    const auto valence = static_cast<std::uint32_t>(star.size());
    std::uint32_t start = Io::writing ? place(star, fan.corners[0]) : 0;
    if (valence <= 8) {
      const std::uint32_t both = io.code(Ring + valence - 1, start * valence + fan.count - 1);
      start = both / valence;
      fan.count = both % valence + 1;
    } else {
      start = io.code(RingWide, start);
      fan.count = io.code(RingWide, fan.count);
    }
    if (start >= valence || fan.count == 0 || fan.count > max_fan_corners) return "a fan has no corners";
    return Base::walk_ring(star, start, fan.count, fan.corners.data()) ? fine : "a fan does not follow the ring";
  }

  Fault code_list(Io& io, std::span<const CornerId> star, Fan& fan) {
    fan.count = io.code(Corner, fan.count);
    if (fan.count == 0 || fan.count > max_fan_corners) return "a fan has no corners";
    for (std::uint32_t i = 0; i < fan.count; ++i) {
      const std::uint32_t at = io.code(Corner, Io::writing ? place(star, fan.corners[i]) : 0);
      if (at >= star.size()) return "a corner is not in its list";
      fan.corners[i] = star[at];
    }
    return fine;
  }

  Fault code_numbers(Io& io, Fan& fan, VertexId& split) {
    fan.count = io.code(Corner, fan.count);
    if (fan.count == 0 || fan.count > max_fan_corners) return "a fan has no corners";
    for (std::uint32_t i = 0; i < fan.count; ++i) {
      const CornerId corner = code_difference(io, Corner, fan.corners[i], Base::last_corner_);
      if (!in_use(corner)) return "a corner is not in use";
      fan.corners[i] = Base::last_corner_ = corner;
    }
    split = topology_.vertex(fan.corners[0]);
    return topology_.listed(split) ? "a corner is named by number without need" : fine;
  }

  [[nodiscard]] bool in_use(CornerId corner) const noexcept {
    return corner < topology_.corner_count() && topology_.vertex(corner) != none;
  }

  MaterialId code_material(Io& io, const Fan& fan) {
    if (!Base::multi_material_) return 0;
    const MaterialId near = topology_.material(fan.corners[0] / 3);
    const std::uint32_t coded = io.code(Material, fan.material == near ? 0 : fan.material + 1);
    return coded == 0 ? near : coded - 1;
  }

  void code_feature(Io& io, FaceId face, FeatureId expected) {
    if (!store_.has_features()) return;
    if (features_.empty()) features_.resize(topology_.corner_count() / 3, none);
    features_[face] = Base::last_feature_ = code_difference(io, Feature, store_.feature(face), expected);
    store_.set_feature(face, features_[face]);
  }

  // Base vertices come in slot order: a mean of the neighbours already known, else the one before.
  [[nodiscard]] Guess guess_base(VertexId v) {
    std::array<VertexId, 2 * max_star> known;
    std::size_t count = 0;
    for (const CornerId corner : topology_.listed(v) ? topology_.star(v) : std::span<const CornerId>{}) {
      for (const CornerId other : {next_corner(corner), previous_corner(corner)}) {
        if (topology_.vertex(other) < v) known[count++] = topology_.vertex(other);
      }
    }
    if (count == 0) return v == 0 ? Guess{} : Base::guess_like(v - 1);
    Guess guess = Base::guess_inside(std::span{known}.first(count));
    guess.across = glm::dvec3{0.0};
    return guess;
  }

  void code_new(Io& io, std::uint32_t group, VertexId slot, const Guess& guess, bool with_position) {
    std::uint32_t* words = Base::value(slot);
    store_.before_new(slot, words);
    const PositionWords position = with_position ? Base::codec_.code_position(io, group, guess, words)
                                                 : PositionWords{words[0], words[1], words[2]};
    position.store(words);
    Base::codec_.code_attributes(io, group, guess, words);
    store_.after_new(slot, position, words);
  }

  void code_move(Io& io, std::uint32_t group, VertexId slot, const Guess& guess) {
    std::array<std::uint32_t, max_value_words> before;
    std::uint32_t* words = Base::value(slot);
    std::copy_n(words, Base::stride_, before.begin());
    store_.before_move(slot, words);
    Base::codec_.code_position(io, group, guess, words).store(words);
    Base::codec_.code_attributes(io, group, guess, words);
    store_.after_move(before.data(), words);
  }

  Fault edit_corners(Io& io, std::span<std::uint32_t> pairs) {
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
      const CornerId corner = Base::code_name(io, EditCorner, Base::words_.corners, pairs[i], Base::last_corner_);
      if (!in_use(corner)) return "a corner is not in use";
      const VertexId old = topology_.vertex(corner);
      const VertexId to = Base::code_name(io, EditTo, Base::words_.vertices, old ^ pairs[i + 1], Base::last_vertex_);
      if (to >= topology_.vertex_count()) return "a corner is re-pointed to no vertex";
      pairs[i] = corner;
      pairs[i + 1] = old ^ to;
      topology_.repoint(corner, to);
    }
    return fine;
  }

  Fault edit_faces(Io& io, std::uint32_t groups, std::span<std::uint32_t> words) {
    std::size_t at = 0;
    for (std::uint32_t g = 0; g < groups; ++g) {
      if (words.size() - at < 2) return "the faces of an edit do not fit its counts";
      const MaterialId m = code_difference(io, EditGroup, words[at], Base::last_material_);
      const std::uint32_t count = io.code(EditGroup, words[at + 1]);
      words[at] = Base::last_material_ = m;
      words[at + 1] = count;
      at += 2;
      if ((words.size() - at) / 3 < count || !topology_.has_room(m, count)) return "an edit adds too many faces";
      for (std::uint32_t f = 0; f < count; ++f, at += 3) {
        for (std::size_t c = at; c < at + 3; ++c) {
          words[c] = Base::code_name(io, EditFace, Base::words_.vertices, words[c], Base::last_vertex_);
          if (words[c] >= topology_.vertex_count()) return "a face names no vertex";
        }
        code_feature(io, topology_.add_face(m, words[at], words[at + 1], words[at + 2]), Base::last_feature_);
      }
    }
    return at == words.size() ? fine : "the faces of an edit do not fit its counts";
  }

  // Wedges share positions, so a value may say that its position is that of the value before.
  Fault edit_values(Io& io, VertexId first, std::span<const std::uint32_t> merges, std::span<std::uint32_t> moved) {
    std::array<std::uint32_t, 3> last{};
    for (std::uint32_t i = 0; i < merges.size(); ++i) {
      const VertexId slot = first + i;
      // The first vertex of a model whose base is empty has no other to be like.
      const Guess guess = slot == 0 ? Guess{} : Base::guess_like(merges[i] < slot ? merges[i] : slot - 1);
      std::uint32_t* words = Base::value(slot);
      store_.before_new(slot, words);
      const bool same = i > 0 && code_same(io, words, last);
      code_new(io, EditValues, slot, guess, !same);
      std::copy_n(words, 3, last.begin());
    }
    for (std::uint32_t& slot : moved) {
      slot = Base::code_name(io, EditMoved, Base::words_.vertices, slot, Base::last_vertex_);
      if (slot >= first) return "a vertex moves that one of the levels does not use";
      code_move(io, EditValues, slot, Base::guess_like(slot));
    }
    return fine;
  }

  bool code_same(Io& io, std::uint32_t* words, const std::array<std::uint32_t, 3>& last) {
    const bool same = io.code(EditSame, std::equal(last.begin(), last.end(), words) ? 1 : 0) != 0;
    if (same) std::copy(last.begin(), last.end(), words);
    return same;
  }

  Store store_;
  std::vector<FeatureId> features_;  // of the faces in use
};

}  // namespace lodestone::model_file
