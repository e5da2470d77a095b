// SPDX-License-Identifier: MIT
// Based on: Hoppe 1996, Progressive Meshes (records of an edge collapse).
// Differs: what an edge collapse implies (its target, the faces that go) is derived from the corners it re-points.
#include "progressive/encoder.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "progressive/record.h"
#include "progressive/values.h"

namespace lodestone::progressive {

namespace {

constexpr std::size_t max_value_words = 9;
constexpr std::uint32_t fetch_ahead = 12;  // records

// Sorts stably by `key`. Records are small, and std::stable_sort allocates each time.
template <class T, class Key>
void sort_by(std::vector<T>& array, Key key) {
  constexpr std::size_t small = 32;
  if (array.size() > small) {
    std::stable_sort(array.begin(), array.end(), [&](const T& a, const T& b) { return key(a) < key(b); });
    return;
  }
  for (std::size_t i = 1; i < array.size(); ++i) {
    const T element = array[i];
    std::size_t at = i;
    for (; at > 0 && key(element) < key(array[at - 1]); --at) array[at] = array[at - 1];
    array[at] = element;
  }
}

}  // namespace

// Brings near what encode() reads at random: most of its time is waiting for these. Inlined because a compiler may
// take a call that only fetches for one without effect.
[[gnu::always_inline]] inline void Encoder::fetch(const Spans& record) const {
  for (std::uint32_t m = record.first_move; m < record.moves_end; ++m) {
    const VertexId v = log_.moved_[m];
    __builtin_prefetch(&vertex_slot_[v]);
    __builtin_prefetch(&replayed_.values.positions[v], 1);
    if (!replayed_.values.normals.empty()) __builtin_prefetch(&replayed_.values.normals[v], 1);
    if (!replayed_.values.uvs.empty()) __builtin_prefetch(&replayed_.values.uvs[v], 1);
  }
  for (const FaceId face : record.faces) {
    __builtin_prefetch(&replayed_.indices[3 * static_cast<std::size_t>(face)]);
    __builtin_prefetch(&replayed_.rotation[face], 1);
  }
  for (const auto& [corner, to] : record.corners) {
    __builtin_prefetch(&replayed_.indices[corner], 1);
    __builtin_prefetch(&replayed_.rotation[corner / 3]);
  }
}

void Encoder::encode(Range records, Encoded& out) {
  out_ = &out;
  out.shapes.reserve(records.size());
  for (std::uint32_t i = records.begin; i != records.end; ++i) {
    if (records.end - i > fetch_ahead) fetch(log_.spans(i + fetch_ahead));
    encode(log_.spans(i));
  }
}

void Encoder::encode(const Spans& record) {
  for (const FaceId face : record.faces) {
    assert(replayed_.rotation[face] == Replayed::in_use);
    replayed_.rotation[face] = 0;
  }
  gather_corners(record);
  gather_moves(record);
  if (RecordKind kind{}; fan(record, kind)) {
    encode_fan(record, kind);
  } else {
    encode_edit(record);
  }
  for (const auto& [corner, to] : corners_) replayed_.indices[corner] = to;
  for (const std::uint32_t m : moves_) set_value(pointers(replayed_.values), log_.moved_[m], move_words(m));
}

// Into corners_: what really changes on faces that stay, by corner, the last word on each corner.
void Encoder::gather_corners(const Spans& record) {
  corners_.clear();
  for (const auto& repointed : record.corners) {
    if (replayed_.rotation[repointed.corner / 3] == Replayed::in_use) corners_.push_back(repointed);
  }
  sort_by(corners_, [](const auto& repointed) { return repointed.corner; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const bool last = i + 1 == corners_.size() || corners_[i + 1].corner != corners_[i].corner;
    if (last && replayed_.indices[corners_[i].corner] != corners_[i].to) corners_[kept++] = corners_[i];
  }
  corners_.resize(kept);
}

// Into moves_: positions in the log's moves of vertices that stay and change, by slot, the last word on each.
void Encoder::gather_moves(const Spans& record) {
  const auto slot = [&](std::uint32_t m) { return vertex_slot_[log_.moved_[m]]; };
  moves_.clear();
  for (std::uint32_t m = record.first_move; m < record.moves_end; ++m) {
    // Slots of the vertices removed here are one run.
    const bool stays = record.vertices.empty() || slot(m) < vertex_slot_[record.vertices.front().vertex] ||
                       slot(m) > vertex_slot_[record.vertices.back().vertex];
    if (stays) moves_.push_back(m);
  }
  sort_by(moves_, slot);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    const bool last = i + 1 == moves_.size() || slot(moves_[i + 1]) != slot(moves_[i]);
    if (last && changes_value(moves_[i])) moves_[kept++] = moves_[i];
  }
  moves_.resize(kept);
}

const std::uint32_t* Encoder::move_words(std::uint32_t m) const {
  return &log_.values_[static_cast<std::size_t>(m) * log_.value_words_];
}
bool Encoder::changes_value(std::uint32_t m) const {
  std::uint32_t old[max_value_words];
  get_value(pointers(replayed_.values), log_.moved_[m], old);
  return !std::equal(old, old + log_.value_words_, move_words(m));
}

// Whether the record is a fan; then its faces are ordered left, right and rotated, and corners_ is in ring order.
bool Encoder::fan(const Spans& record, RecordKind& kind) {
  if (record.vertices.size() != 1 || record.faces.empty() || record.faces.size() > 2) return false;
  if (corners_.empty() || corners_.size() > RecordShape::corner_mask) return false;
  const auto [s, v] = record.vertices[0];
  if (s == v || moves_.size() > 1 || (moves_.size() == 1 && log_.moved_[moves_[0]] != v)) return false;
  const MaterialId material = source_.face_material(record.faces[0]);
  if (material > std::numeric_limits<std::uint16_t>::max()) return false;
  for (const auto& [corner, to] : corners_) {
    if (replayed_.indices[corner] != s || to != v) return false;
  }
  FaceId left = none;
  FaceId right = none;
  VertexId a = none;
  VertexId b = none;
  for (const FaceId face : record.faces) {
    if (source_.face_material(face) != material || !rotate_to_front(face, s)) return false;
    const VertexId x = replayed_.indices[3 * face + (replayed_.rotation[face] + 1) % 3];
    const VertexId y = replayed_.indices[3 * face + (replayed_.rotation[face] + 2) % 3];
    if (x == s || y == s || (x == v) == (y == v)) return false;
    FaceId& side = x == v ? left : right;
    if (side != none) return false;
    side = face;
    (x == v ? a : b) = x == v ? y : x;
  }
  kind = right == none ? RecordKind::FanLeft : left == none ? RecordKind::FanRight : RecordKind::FanBoth;
  if (kind == RecordKind::FanBoth) {
    record.faces[0] = left;
    record.faces[1] = right;
  }
  return order_ring(a, b);
}

bool Encoder::rotate_to_front(FaceId face, VertexId s) {
  for (std::uint8_t i = 0; i < 3; ++i) {
    replayed_.rotation[face] = i;
    if (replayed_.indices[3 * face + i] == s) return true;
  }
  return false;
}

// Sorts corners_ so that the first is followed by `a`, the last preceded by `b` (either may be none), and the others
// follow each other around the ring as far as the surface is manifold there.
bool Encoder::order_ring(VertexId a, VertexId b) {
  const auto after = [&](const auto& c) { return replayed_.indices[next_corner(c.corner)]; };
  const auto before = [&](const auto& c) { return replayed_.indices[previous_corner(c.corner)]; };
  auto first = corners_.begin();
  auto last = corners_.end();
  if (a != none && b != none && corners_.size() > 1) {  // the far end, so that the chain from `a` cannot take it
    const auto end = std::find_if(first, last, [&](const auto& c) { return before(c) == b; });
    if (end == last) return false;
    std::iter_swap(end, last - 1);
    --last;
  }
  if (a != none) {
    for (VertexId next = a; first != last; ++first) {
      const auto found = std::find_if(first, last, [&](const auto& c) { return after(c) == next; });
      if (found == last) break;
      std::iter_swap(first, found);
      next = before(*first);
    }
  } else {
    for (VertexId next = b; first != last; --last) {
      const auto found = std::find_if(first, last, [&](const auto& c) { return before(c) == next; });
      if (found == last) break;
      std::iter_swap(last - 1, found);
      next = after(*(last - 1));
    }
  }
  return (a == none || after(corners_.front()) == a) && (b == none || before(corners_.back()) == b);
}

void Encoder::encode_fan(const Spans& record, RecordKind kind) {
  auto shape = static_cast<unsigned>(corners_.size()) | static_cast<unsigned>(kind) << RecordShape::kind_shift;
  if (!moves_.empty()) shape |= RecordShape::moves_flag;
  out_->shapes.push_back(static_cast<std::uint8_t>(shape));
  for (std::size_t i = corners_.size(); i-- > 0;) out_->fan_corners.push_back(corners_[i].corner);
  if (source_.materials.size() > 1) {
    out_->fan_materials.push_back(static_cast<std::uint16_t>(source_.face_material(record.faces[0])));
  }
  push_values();
}

void Encoder::encode_edit(const Spans& record) {
  const auto material = [&](FaceId face) { return source_.face_material(face); };
  std::stable_sort(record.faces.begin(), record.faces.end(),
                   [&](FaceId a, FaceId b) { return material(a) < material(b); });
  out_->shapes.push_back(edit_shape);
  std::vector<std::uint32_t>& block = scratch_;
  block.assign(edit_head_words, 0);
  for (const auto& removed : record.vertices) block.push_back(vertex_slot_[removed.merges_into]);
  std::uint32_t groups = 0;
  for (std::size_t i = 0; i < record.faces.size(); ++groups) {
    const MaterialId m = material(record.faces[i]);
    block.insert(block.end(), {m, 0});
    const std::size_t count = block.size() - 1;
    for (; i < record.faces.size() && material(record.faces[i]) == m; ++i, ++block[count]) {
      replayed_.rotation[record.faces[i]] = 0;  // a fan may have been tried
      for (std::size_t c = 0; c < 3; ++c) block.push_back(vertex_slot_[replayed_.indices[3 * record.faces[i] + c]]);
    }
  }
  for (const auto& [corner, to] : corners_) {
    block.insert(block.end(), {corner, vertex_slot_[replayed_.indices[corner]] ^ vertex_slot_[to]});
  }
  for (const std::uint32_t m : moves_) block.push_back(vertex_slot_[log_.moved_[m]]);
  const auto length = static_cast<std::uint32_t>(block.size() + 1);
  block.push_back(length);
  const auto count = [](const auto& array) { return static_cast<std::uint32_t>(array.size()); };
  const std::uint32_t head[edit_head_words] = {length, count(record.vertices), count(record.faces),
                                               groups, count(corners_),        count(moves_)};
  std::copy(std::begin(head), std::end(head), block.begin());
  out_->edits.insert(out_->edits.end(), block.rbegin(), block.rend());
  push_values();
}

void Encoder::push_values() {
  const std::uint32_t words = log_.value_words_;
  for (std::size_t i = moves_.size(); i-- > 0;) {
    std::uint32_t old[max_value_words];
    get_value(pointers(replayed_.values), log_.moved_[moves_[i]], old);
    const std::uint32_t* now = move_words(moves_[i]);
    for (std::uint32_t w = words; w-- > 0;) out_->value_xor.push_back(old[w] ^ now[w]);
  }
}

}  // namespace lodestone::progressive
