// SPDX-License-Identifier: MIT
// The state both sides keep while they replay a stack, and the text of a record that both follow. See value_codec.h for
// how one text serves for writing and reading.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stack_codec.h"
#include "topology.h"
#include "value_codec.h"

namespace lodestone::model_file {

inline constexpr std::uint32_t max_fan_corners = RecordShape::corner_mask;

struct Fan {
  RecordKind kind = RecordKind::FanBoth;
  bool moves = false;
  MaterialId material = 0;
  std::uint32_t count = 0;
  std::array<CornerId, max_fan_corners> corners{};
};

// The counts and the words between head and tail of an edit block, see docs/FILE_FORMAT.md.
struct Edit {
  std::uint32_t vertices = 0, faces = 0, groups = 0, corners = 0, moves = 0;
  std::vector<std::uint32_t> words;
};

// Vertices and corners near an edit: what it names is mostly among them.
struct Vocabulary {
  static constexpr std::uint32_t capacity = 250;
  static constexpr std::uint32_t max_stars = 32;
  std::vector<VertexId> vertices;
  std::vector<CornerId> corners;
  void add(VertexId vertex) {
    if (vertices.size() < capacity && std::find(vertices.begin(), vertices.end(), vertex) == vertices.end()) {
      vertices.push_back(vertex);
    }
  }
};

template <class Space, class Io>
class Replay {
 public:
  Replay(const ModelData& data, const ValueLayout& layout)
      : layout_(layout),
        stride_(layout.words()),
        multi_material_(data.face_begin.size() > 2),
        codec_(layout),
        topology_(data.face_begin) {}

 protected:
  [[nodiscard]] const std::uint32_t* value(VertexId v) const noexcept { return &values_[std::size_t{v} * stride_]; }
  [[nodiscard]] std::uint32_t* value(VertexId v) noexcept { return &values_[std::size_t{v} * stride_]; }

  // Makes room for so many vertices in all.
  void make_room(std::uint32_t count) {
    values_.resize(std::size_t{count} * stride_);
    topology_.make_room(count);
  }
  void reserve(std::uint32_t count) {
    values_.reserve(std::size_t{count} * stride_);
    topology_.reserve(count);
  }

  [[nodiscard]] glm::dvec3 position(VertexId v) const noexcept {
    const std::uint32_t* w = value(v);
    return {Space::number(w[0]), Space::number(w[1]), Space::number(w[2])};
  }

  // A value expected to be that of one vertex.
  [[nodiscard]] Guess guess_like(VertexId v) const noexcept {
    Guess guess;
    guess.position = position(v);
    const std::uint32_t* w = value(v);
    if (layout_.normal_words == 3) {
      for (int i = 0; i < 3; ++i) guess.normal[i] = Space::number(w[3 + i]);
    } else if (layout_.normal_words == 2) {
      guess.octahedral = {w[3], w[4]};
    }
    if (layout_.uvs) guess.uv = {Space::number(w[layout_.uv()]), Space::number(w[layout_.uv() + 1])};
    if (layout_.colors) guess.color = w[layout_.color()];
    return guess;
  }

  // The value of the vertex that fills a hole with the corners `ring`[0] (the vertex it splits from), 1, 2, ...: their
  // mean, on the plane around the hole.
  [[nodiscard]] Guess guess_inside(std::span<const VertexId> ring) const noexcept {
    Guess guess = guess_like(ring[0]);
    const glm::dvec3 start = guess.position;
    glm::dvec3 before{0.0};
    for (const VertexId v : ring.subspan(1)) {
      const glm::dvec3 p = position(v);
      guess.position += p;
      guess.across += glm::cross(before, p - start);
      before = p - start;
    }
    const auto count = static_cast<double>(ring.size());
    guess.position /= count;
    if (layout_.normal_words == 3) {
      for (const VertexId v : ring.subspan(1)) {
        for (int c = 0; c < 3; ++c) guess.normal[c] += Space::number(value(v)[3 + c]);
      }
    }
    if (layout_.uvs) {
      for (const VertexId v : ring.subspan(1)) {
        guess.uv += glm::dvec2{Space::number(value(v)[layout_.uv()]), Space::number(value(v)[layout_.uv() + 1])};
      }
      guess.uv /= count;
    }
    return guess;
  }

  // The vertices around the hole that a fan fills, the split vertex first.
  [[nodiscard]] std::span<const VertexId> ring_of(const Fan& fan, VertexId split) noexcept {
    ring_[0] = split;
    ring_[1] = topology_.vertex(next_corner(fan.corners[0]));
    for (std::uint32_t i = 0; i < fan.count; ++i) ring_[2 + i] = topology_.vertex(previous_corner(fan.corners[i]));
    return std::span{ring_}.first(2 + fan.count);
  }

  // The `count` corners of `star` that follow each other counter-clockwise from place `start`; false if they do not.
  [[nodiscard]] bool walk_ring(std::span<const CornerId> star, std::uint32_t start, std::uint32_t count,
                               CornerId* out) noexcept {
    const auto valence = static_cast<std::uint32_t>(star.size());
    for (std::uint32_t i = 0; i < valence; ++i) after_[i] = topology_.vertex(next_corner(star[i]));
    std::uint32_t at = start;
    for (std::uint32_t done = 0;;) {
      out[done] = star[at];
      if (++done == count) return true;
      const VertexId wanted = topology_.vertex(previous_corner(star[at]));
      for (at = 0; at < valence && after_[at] != wanted;) ++at;
      if (at == valence) return false;
    }
  }

  // Applies a fan to the lists. False if it cannot be one.
  [[nodiscard]] bool apply(const Fan& fan, VertexId split, VertexId added) {
    const std::uint32_t faces = fan.kind == RecordKind::FanBoth ? 2 : 1;
    if (!topology_.has_room(fan.material, faces)) return false;
    const VertexId a = topology_.vertex(next_corner(fan.corners[0]));
    const VertexId b = topology_.vertex(previous_corner(fan.corners[fan.count - 1]));
    if (!topology_.split_star(split, std::span{fan.corners}.first(fan.count), added)) return false;
    if (fan.kind != RecordKind::FanRight) topology_.add_face(fan.material, added, split, a);
    if (fan.kind != RecordKind::FanLeft) topology_.add_face(fan.material, added, b, split);
    return true;
  }

  // Fills the vocabulary of an edit that adds `merges.size()` vertices from `first`.
  void build_vocabulary(VertexId first, std::span<const std::uint32_t> merges) {
    words_.vertices.clear();
    words_.corners.clear();
    const std::size_t used = std::min<std::size_t>(merges.size(), Vocabulary::max_stars);
    for (std::size_t i = 0; i < used; ++i) {
      words_.add(first + static_cast<std::uint32_t>(i));
      words_.add(merges[i]);
    }
    for (std::size_t i = 0; i < used; ++i) {
      const VertexId center = merges[i];
      const auto before = merges.first(i);
      if (center >= first || !topology_.listed(center)) continue;
      if (std::find(before.begin(), before.end(), center) != before.end()) continue;
      for (const CornerId corner : topology_.star(center)) {
        if (words_.corners.size() < Vocabulary::capacity) words_.corners.push_back(corner);
        words_.add(topology_.vertex(next_corner(corner)));
        words_.add(topology_.vertex(previous_corner(corner)));
      }
    }
  }

  // A word by its place among `known`, or, where it is not there, by its distance to the last such stranger.
  [[nodiscard]] std::uint32_t code_name(Io& io, std::uint32_t column, std::span<const std::uint32_t> known,
                                        std::uint32_t word, std::uint32_t& stranger) {
    const auto size = static_cast<std::uint32_t>(known.size());
    std::uint32_t place = size;
    if constexpr (Io::writing) {
      place = static_cast<std::uint32_t>(std::find(known.begin(), known.end(), word) - known.begin());
    }
    place = io.code(column, place);
    if (place < size) return known[place];
    stranger = code_difference(io, EditEscape, word, stranger);
    return stranger;
  }

  ValueLayout layout_;
  std::uint32_t stride_;
  bool multi_material_;
  ValueCodec<Space, Io> codec_;
  Topology topology_;
  LargeVector<std::uint32_t> values_;
  Vocabulary words_;
  VertexId last_split_ = 0;
  VertexId last_vertex_ = 0;  // strangers among the vertices an edit names
  CornerId last_corner_ = 0;  // and among the corners
  MaterialId last_material_ = 0;
  FeatureId last_feature_ = 0;
  ErrorStep last_error_;

 private:
  std::array<VertexId, max_fan_corners + 2> ring_{};
  std::array<VertexId, max_star> after_{};
};

}  // namespace lodestone::model_file
