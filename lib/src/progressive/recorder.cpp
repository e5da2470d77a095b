// SPDX-License-Identifier: MIT
// Based on: Hoppe 1996, Progressive Meshes (records of an edge collapse); Li et al. 2019, section 2.4 (fixed slots, one
// stack for both directions).
// Differs: slots are sorted by removal time, so a record need not say which vertex and faces it adds; what an edge
// collapse implies (its target, the faces that go) is derived from the corners it re-points.
#include "progressive/recorder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "progressive/check.h"
#include "progressive/record.h"
#include "progressive/values.h"

namespace lodestone::progressive {

namespace {

constexpr double error_step_ratio = 1.0019;

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

// Runs of equal error, in ascending levels, from errors in coarsening order.
std::vector<ErrorStep> error_steps(const std::vector<float>& errors) {
  const auto finest = static_cast<Level>(errors.size());
  std::vector<ErrorStep> steps{{finest, 0.0F}};
  Level level = finest;
  for (const float error_m : errors) {
    --level;
    const float now = steps.back().error_m;
    if (!(error_m > now)) {
      steps.back().level = level;
      continue;
    }
    constexpr double most = std::numeric_limits<float>::max();
    steps.push_back({level, static_cast<float>(std::min(static_cast<double>(error_m) * error_step_ratio, most))});
  }
  std::reverse(steps.begin(), steps.end());
  return steps;
}

}  // namespace

// Replays the log once in its own order (coarsening) and writes the stack back to front.
class Recorder {
 public:
  Recorder(const Mesh& source, EditLog&& log, const Context& context)
      : source_(source),
        context_(context),
        log_(std::move(log)),
        indices_(source.indices),
        vertex_slot_(source.vertex_count(), none),
        first_corner_(source.triangle_count(), none),
        rotation_(source.triangle_count(), in_use) {
    if (!log_.moved_.empty()) values_ = source.vertices;
  }

  ModelData run(std::string method) {
    static_cast<Surroundings&>(data_) = source_;
    data_.method = std::move(method);
    assign_vertex_slots();
    for (std::uint32_t i = 0; i < log_.record_count(); ++i) {
      if (i + fetch_ahead < log_.record_count()) fetch(spans(i + fetch_ahead));
      encode(i);
    }
    std::reverse(data_.shapes.begin(), data_.shapes.end());
    std::reverse(fan_corners_.begin(), fan_corners_.end());
    std::reverse(data_.edits.begin(), data_.edits.end());
    std::reverse(data_.value_xor.begin(), data_.value_xor.end());
    assign_face_slots();
    translate_corners();
    write_vertices();
    std::vector<float> errors;
    errors.reserve(log_.record_count());
    for (const auto& record : log_.records_) errors.push_back(record.error_m);
    data_.errors = error_steps(errors);
    return std::move(data_);
  }

 private:
  // What one record holds, as ranges of the log's arrays.
  struct Spans {
    std::span<FaceId> faces;
    std::span<RemovedVertex> vertices;
    std::span<RepointedCorner> corners;
    std::uint32_t first_move = 0, moves_end = 0;
  };

  [[nodiscard]] Spans spans(std::uint32_t i) {
    const RecordEnds from = i == 0 ? RecordEnds{} : log_.records_[i - 1];
    const RecordEnds& to = log_.records_[i];
    return {{log_.faces_.begin() + from.faces, log_.faces_.begin() + to.faces},
            {log_.vertices_.begin() + from.vertices, log_.vertices_.begin() + to.vertices},
            {log_.corners_.begin() + from.corners, log_.corners_.begin() + to.corners},
            from.moves,
            to.moves};
  }

  // Base vertices first in source order, then record by record in refining order, each after what it merges into.
  void assign_vertex_slots() {
    std::vector<std::uint8_t> removed(source_.vertex_count(), 0);
    for (const auto& [vertex, target] : log_.vertices_) {
      assert(removed[vertex] == 0);
      removed[vertex] = 1;
    }
    vertex_of_slot_.reserve(source_.vertex_count());
    for (VertexId v = 0; v < source_.vertex_count(); ++v) {
      if (removed[v] == 0) give_slot(v);
    }
    data_.base_vertex_count = static_cast<std::uint32_t>(vertex_of_slot_.size());
    std::vector<std::uint32_t> place(source_.vertex_count(), none);  // of a vertex in its record
    for (std::uint32_t i = log_.record_count(); i-- > 0;) order_removed(spans(i).vertices, place);
  }

  void give_slot(VertexId vertex) {
    vertex_slot_[vertex] = static_cast<VertexId>(vertex_of_slot_.size());
    vertex_of_slot_.push_back(vertex);
  }

  // Gives slots to the vertices of one record and sorts its span by them. A cycle of targets is cut: its last one
  // merges into itself.
  void order_removed(std::span<RemovedVertex> removed, std::vector<std::uint32_t>& place) {
    if (removed.size() == 1) {
      if (removed[0].merges_into == none) removed[0].merges_into = removed[0].vertex;
      give_slot(removed[0].vertex);
      return;
    }
    for (std::uint32_t i = 0; i < removed.size(); ++i) {
      place[removed[i].vertex] = i;
      if (removed[i].merges_into == none) removed[i].merges_into = removed[i].vertex;
    }
    std::vector<std::uint32_t>& chain = scratch_;
    for (std::uint32_t start = 0; start < removed.size(); ++start) {
      chain.clear();
      std::uint32_t i = start;
      while (i != none && vertex_slot_[removed[i].vertex] == none) {
        vertex_slot_[removed[i].vertex] = pending;
        chain.push_back(i);
        const VertexId target = removed[i].merges_into;
        i = target == removed[i].vertex ? none : place[target];
      }
      if (i != none && vertex_slot_[removed[i].vertex] == pending) {
        removed[chain.back()].merges_into = removed[chain.back()].vertex;
      }
      for (; !chain.empty(); chain.pop_back()) give_slot(removed[chain.back()].vertex);
    }
    std::sort(removed.begin(), removed.end(),
              [&](const auto& a, const auto& b) { return vertex_slot_[a.vertex] < vertex_slot_[b.vertex]; });
    for (const auto& r : removed) place[r.vertex] = none;
  }

  // Brings near what encode() reads at random: most of its time is waiting for these. Inlined because a compiler may
  // take a call that only fetches for one without effect.
  [[gnu::always_inline]] void fetch(const Spans& record) const {
    for (std::uint32_t m = record.first_move; m < record.moves_end; ++m) {
      const VertexId v = log_.moved_[m];
      __builtin_prefetch(&vertex_slot_[v]);
      __builtin_prefetch(&values_.positions[v], 1);
      if (!values_.normals.empty()) __builtin_prefetch(&values_.normals[v], 1);
      if (!values_.uvs.empty()) __builtin_prefetch(&values_.uvs[v], 1);
    }
    for (const FaceId face : record.faces) {
      __builtin_prefetch(&indices_[3 * static_cast<std::size_t>(face)]);
      __builtin_prefetch(&rotation_[face], 1);
    }
    for (const auto& [corner, to] : record.corners) {
      __builtin_prefetch(&indices_[corner], 1);
      __builtin_prefetch(&rotation_[corner / 3]);
    }
  }

  void encode(std::uint32_t i) {
    const Spans record = spans(i);
    for (const FaceId face : record.faces) {
      assert(rotation_[face] == in_use);
      rotation_[face] = 0;
    }
    gather_corners(record);
    gather_moves(record);
    if (RecordKind kind{}; fan(record, kind)) {
      encode_fan(record, kind);
    } else {
      encode_edit(record);
    }
    for (const auto& [corner, to] : corners_) indices_[corner] = to;
    for (const std::uint32_t m : moves_) set_value(pointers(values_), log_.moved_[m], move_words(m));
  }

  // Into corners_: what really changes on faces that stay, by corner, the last word on each corner.
  void gather_corners(const Spans& record) {
    corners_.clear();
    for (const auto& repointed : record.corners) {
      if (rotation_[repointed.corner / 3] == in_use) corners_.push_back(repointed);
    }
    sort_by(corners_, [](const auto& repointed) { return repointed.corner; });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const bool last = i + 1 == corners_.size() || corners_[i + 1].corner != corners_[i].corner;
      if (last && indices_[corners_[i].corner] != corners_[i].to) corners_[kept++] = corners_[i];
    }
    corners_.resize(kept);
  }

  // Into moves_: positions in the log's moves of vertices that stay and change, by slot, the last word on each.
  void gather_moves(const Spans& record) {
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

  [[nodiscard]] const std::uint32_t* move_words(std::uint32_t m) const {
    return &log_.values_[static_cast<std::size_t>(m) * log_.value_words_];
  }
  [[nodiscard]] bool changes_value(std::uint32_t m) {
    std::uint32_t old[max_value_words];
    get_value(pointers(values_), log_.moved_[m], old);
    return !std::equal(old, old + log_.value_words_, move_words(m));
  }

  // Whether the record is a fan; then its faces are ordered left, right and rotated, and corners_ is in ring order.
  bool fan(const Spans& record, RecordKind& kind) {
    if (record.vertices.size() != 1 || record.faces.empty() || record.faces.size() > 2) return false;
    if (corners_.empty() || corners_.size() > RecordShape::corner_mask) return false;
    const auto [s, v] = record.vertices[0];
    if (s == v || moves_.size() > 1 || (moves_.size() == 1 && log_.moved_[moves_[0]] != v)) return false;
    const MaterialId material = source_.face_material(record.faces[0]);
    if (material > std::numeric_limits<std::uint16_t>::max()) return false;
    for (const auto& [corner, to] : corners_) {
      if (indices_[corner] != s || to != v) return false;
    }
    FaceId left = none;
    FaceId right = none;
    VertexId a = none;
    VertexId b = none;
    for (const FaceId face : record.faces) {
      if (source_.face_material(face) != material || !rotate_to_front(face, s)) return false;
      const VertexId x = indices_[3 * face + (rotation_[face] + 1) % 3];
      const VertexId y = indices_[3 * face + (rotation_[face] + 2) % 3];
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

  bool rotate_to_front(FaceId face, VertexId s) {
    for (std::uint8_t i = 0; i < 3; ++i) {
      rotation_[face] = i;
      if (indices_[3 * face + i] == s) return true;
    }
    return false;
  }

  // Sorts corners_ so that the first is followed by `a`, the last preceded by `b` (either may be none), and the others
  // follow each other around the ring as far as the surface is manifold there.
  bool order_ring(VertexId a, VertexId b) {
    const auto after = [&](const auto& c) { return indices_[next_corner(c.corner)]; };
    const auto before = [&](const auto& c) { return indices_[previous_corner(c.corner)]; };
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

  void encode_fan(const Spans& record, RecordKind kind) {
    auto shape = static_cast<unsigned>(corners_.size()) | static_cast<unsigned>(kind) << RecordShape::kind_shift;
    if (!moves_.empty()) shape |= RecordShape::moves_flag;
    data_.shapes.push_back(static_cast<std::uint8_t>(shape));
    for (std::size_t i = corners_.size(); i-- > 0;) fan_corners_.push_back(corners_[i].corner);
    if (source_.materials.size() > 1) {
      data_.fan_materials.push_back(static_cast<std::uint16_t>(source_.face_material(record.faces[0])));
    }
    push_values();
  }

  void encode_edit(const Spans& record) {
    const auto material = [&](FaceId face) { return source_.face_material(face); };
    std::stable_sort(record.faces.begin(), record.faces.end(),
                     [&](FaceId a, FaceId b) { return material(a) < material(b); });
    data_.shapes.push_back(edit_shape);
    std::vector<std::uint32_t>& block = scratch_;
    block.assign(edit_head_words, 0);
    for (const auto& removed : record.vertices) block.push_back(vertex_slot_[removed.merges_into]);
    std::uint32_t groups = 0;
    for (std::size_t i = 0; i < record.faces.size(); ++groups) {
      const MaterialId m = material(record.faces[i]);
      block.insert(block.end(), {m, 0});
      const std::size_t count = block.size() - 1;
      for (; i < record.faces.size() && material(record.faces[i]) == m; ++i, ++block[count]) {
        rotation_[record.faces[i]] = 0;  // a fan may have been tried
        for (std::size_t c = 0; c < 3; ++c) block.push_back(vertex_slot_[indices_[3 * record.faces[i] + c]]);
      }
    }
    for (const auto& [corner, to] : corners_) {
      block.insert(block.end(), {corner, vertex_slot_[indices_[corner]] ^ vertex_slot_[to]});
    }
    for (const std::uint32_t m : moves_) block.push_back(vertex_slot_[log_.moved_[m]]);
    const auto length = static_cast<std::uint32_t>(block.size() + 1);
    block.push_back(length);
    const auto count = [](const auto& array) { return static_cast<std::uint32_t>(array.size()); };
    const std::uint32_t head[edit_head_words] = {length, count(record.vertices), count(record.faces),
                                                 groups, count(corners_),        count(moves_)};
    std::copy(std::begin(head), std::end(head), block.begin());
    data_.edits.insert(data_.edits.end(), block.rbegin(), block.rend());
    push_values();
  }

  void push_values() {
    const std::uint32_t words = log_.value_words_;
    for (std::size_t i = moves_.size(); i-- > 0;) {
      std::uint32_t old[max_value_words];
      get_value(pointers(values_), log_.moved_[moves_[i]], old);
      const std::uint32_t* now = move_words(moves_[i]);
      for (std::uint32_t w = words; w-- > 0;) data_.value_xor.push_back(old[w] ^ now[w]);
    }
  }

  void assign_face_slots() {
    const std::size_t materials = source_.materials.size();
    data_.face_begin.assign(materials + 1, 0);
    data_.base_face_counts.assign(materials, 0);
    for (FaceId f = 0; f < source_.triangle_count(); ++f) {
      const MaterialId m = source_.face_material(f);
      ++data_.face_begin[m + 1];
      if (rotation_[f] == in_use) ++data_.base_face_counts[m];
    }
    for (std::size_t m = 0; m < materials; ++m) data_.face_begin[m + 1] += data_.face_begin[m];
    std::vector<FaceId> next(data_.face_begin.begin(), data_.face_begin.end() - 1);
    const auto give = [&](FaceId f) {
      const std::uint32_t rotation = rotation_[f] == in_use ? 0 : rotation_[f];
      first_corner_[f] = 3 * next[source_.face_material(f)]++ + rotation;
    };
    for (FaceId f = 0; f < source_.triangle_count(); ++f) {
      if (rotation_[f] == in_use) give(f);
    }
    for (std::uint32_t i = log_.record_count(); i-- > 0;) {
      for (const FaceId f : spans(i).faces) give(f);
    }
    write_base_indices();
    if (!source_.face_features.empty()) {
      data_.face_features.resize(source_.triangle_count());
      for (FaceId f = 0; f < source_.triangle_count(); ++f) {
        data_.face_features[first_corner_[f] / 3] = source_.face_features[f];
      }
    }
  }

  void write_base_indices() {
    std::vector<std::uint64_t> place(data_.base_face_counts.size(), 0);
    std::uint64_t total = 0;
    for (std::size_t m = 0; m < place.size(); ++m) {
      place[m] = total;
      total += 3ULL * data_.base_face_counts[m];
    }
    data_.base_indices.resize(total);
    for (FaceId f = 0; f < source_.triangle_count(); ++f) {
      if (rotation_[f] != in_use) continue;
      std::uint64_t& at = place[source_.face_material(f)];
      for (std::size_t c = 0; c < 3; ++c) data_.base_indices[at++] = vertex_slot_[indices_[3 * f + c]];
    }
  }

  [[nodiscard]] CornerId slot_corner(CornerId corner) const {
    const CornerId first = first_corner_[corner / 3];
    const std::uint32_t rotation = first % 3;
    return first - rotation + (corner % 3 + 3 - rotation) % 3;
  }

  void translate_corners() {
    constexpr std::uint64_t three_byte_corners = 1ULL << 24U;
    data_.corner_bytes = source_.indices.size() <= three_byte_corners ? 3 : 4;
    data_.fan_corners.resize(data_.corner_bytes * fan_corners_.size());
    parallel_chunks(fan_corners_.size(), chunk, context_, [&](std::size_t begin, std::size_t end) {
      std::uint8_t* out = &data_.fan_corners[data_.corner_bytes * begin];
      constexpr std::size_t corners_ahead = 4 * fetch_ahead;
      for (std::size_t i = begin; i != end; ++i) {
        if (i + corners_ahead < end) __builtin_prefetch(&first_corner_[fan_corners_[i + corners_ahead] / 3]);
        const CornerId slot = slot_corner(fan_corners_[i]);
        std::memcpy(out, &slot, data_.corner_bytes);
        out += data_.corner_bytes;
      }
    });
    std::reverse(data_.fan_materials.begin(), data_.fan_materials.end());
    for (std::size_t at = 0; at < data_.edits.size(); at += data_.edits[at]) {
      const EditBlock block{&data_.edits[at]};
      const auto first = static_cast<std::size_t>(block.corners() - data_.edits.data());
      for (std::size_t i = 0; i < block.corner_count(); ++i) {
        data_.edits[first + 2 * i] = slot_corner(data_.edits[first + 2 * i]);
      }
    }
  }

  void write_vertices() {
    const VertexArrays& from = log_.moved_.empty() ? source_.vertices : values_;
    const auto permute = [&](const auto& in, auto& out) {
      if (in.empty()) return;
      out.resize(in.size());
      parallel_for_each(in.size(), chunk, context_, [&](std::size_t slot) { out[slot] = in[vertex_of_slot_[slot]]; });
    };
    permute(from.positions, data_.vertices.positions);
    permute(from.normals, data_.vertices.normals);
    permute(from.uvs, data_.vertices.uvs);
    permute(from.colors, data_.vertices.colors);
  }

  static constexpr std::size_t max_value_words = 9;
  static constexpr std::size_t chunk = 16'384;      // of what is done on all threads
  static constexpr std::uint8_t in_use = 3;         // rotation of a face that no record removed yet
  static constexpr std::uint32_t fetch_ahead = 12;  // records
  static constexpr VertexId pending = none - 1;     // slot of a vertex whose target is looked up

  const Mesh& source_;
  const Context& context_;
  EditLog log_;
  ModelData data_;
  std::vector<VertexId> indices_;         // of the level reached, in the source's numbering
  VertexArrays values_;                   // likewise; empty if nothing moves
  std::vector<VertexId> vertex_slot_;     // of each source vertex
  std::vector<VertexId> vertex_of_slot_;  // its inverse
  std::vector<CornerId> first_corner_;    // of each source face: 3 times its slot, plus its rotation
  std::vector<std::uint8_t> rotation_;    // corner of the source face that is corner 0 of its slot, or in_use
  std::vector<CornerId> fan_corners_;     // source corners, last record first until reversed
  std::vector<RepointedCorner> corners_;
  std::vector<std::uint32_t> moves_;
  std::vector<std::uint32_t> scratch_;
};

ModelData record(const Mesh& source, EditLog&& log, std::string method, const Context& context) {
  assert(!source.materials.empty() || source.triangle_count() == 0);
  return Recorder{source, std::move(log), context}.run(std::move(method));
}

Result<std::shared_ptr<const ProgressiveModel>> record_model(const Mesh& source, EditLog&& log, std::string method,
                                                             const Context& context) {
  if (!log.finite(source.vertices)) {
    return Error{ErrorCode::BadData, "a vertex moves to a place that is not finite", "progressive model"};
  }
  ModelData data = record(source, std::move(log), std::move(method), context);
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "building was cancelled", ""};
  return trusted_model(std::move(data), bounds(source));
}

}  // namespace lodestone::progressive
