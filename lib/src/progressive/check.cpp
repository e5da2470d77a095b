// SPDX-License-Identifier: MIT
#include "progressive/check.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "progressive/record.h"
#include "progressive/values.h"

namespace lodestone::progressive {
namespace {

using Fault = const char*;  // what is wrong, null if nothing
constexpr Fault fine = nullptr;

Fault check_surroundings(const ModelData& data) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(data.origin[axis])) return "the origin is not finite";
  }
  for (const Material& material : data.materials) {
    if (material.texture != none && material.texture >= data.textures.size()) return "a material names no texture";
  }
  for (const Feature& feature : data.features) {
    if (feature.parent != none && feature.parent >= data.features.size()) return "a feature names no parent";
  }
  for (const FeatureId feature : data.face_features) {
    if (feature != none && feature >= data.features.size()) return "a face names no feature";
  }
  return fine;
}

Fault check_arrays(const ModelData& data) {
  const VertexArrays& v = data.vertices;
  const auto parallel = [&](const auto& array) { return array.empty() || array.size() == v.positions.size(); };
  if (v.positions.size() >= none) return "there are too many vertices";
  if (!parallel(v.normals) || !parallel(v.uvs) || !parallel(v.colors)) return "the vertex arrays differ in length";
  if (data.base_vertex_count > v.positions.size()) return "the base has more vertices than there are";
  if (data.face_begin.empty() || data.face_begin.front() != 0) return "the face ranges do not start at 0";
  if (data.base_face_counts.size() + 1 != data.face_begin.size()) return "the face ranges do not fit the materials";
  if (data.materials.size() != data.base_face_counts.size()) return "the face ranges do not fit the materials";
  if (data.face_begin.back() >= none / 3) return "there are too many faces";
  std::uint64_t base_faces = 0;
  for (std::size_t m = 0; m < data.base_face_counts.size(); ++m) {
    if (data.face_begin[m] > data.face_begin[m + 1]) return "the face ranges overlap";
    if (data.base_face_counts[m] > data.face_begin[m + 1] - data.face_begin[m]) return "a base exceeds its face range";
    base_faces += data.base_face_counts[m];
  }
  if (data.base_indices.size() != 3 * base_faces) return "the base indices do not fit the base faces";
  for (const VertexId index : data.base_indices) {
    if (index >= data.base_vertex_count) return "a base index names no base vertex";
  }
  if (!data.face_features.empty() && data.face_features.size() != data.face_begin.back()) {
    return "the features do not fit the faces";
  }
  if (data.shapes.size() >= none) return "there are too many records";
  if (data.corner_bytes != 3 && data.corner_bytes != 4) return "corners must take 3 or 4 bytes";
  if (data.fan_corners.size() % data.corner_bytes != 0) return "the corners end in the middle of one";
  return fine;
}

Fault check_errors(const ModelData& data) {
  if (data.errors.empty() || data.errors.front().level != 0) return "the errors do not start at level 0";
  for (std::size_t i = 0; i < data.errors.size(); ++i) {
    const ErrorStep& step = data.errors[i];
    if (!std::isfinite(step.error_m) || step.error_m < 0.0F) return "an error is negative or not finite";
    if (step.level > data.shapes.size()) return "an error step lies above the stack";
    if (i > 0 && (step.level <= data.errors[i - 1].level || step.error_m > data.errors[i - 1].error_m)) {
      return "the errors do not descend";
    }
  }
  for (const NamedLevel& named : data.named_levels) {
    if (named.level > data.shapes.size()) return "a named level lies above the stack";
  }
  return fine;
}

template <class Vector>
bool finite_array(const std::vector<Vector>& array) {
  return std::all_of(array.begin(), array.end(), [](const Vector& value) {
    for (int i = 0; i < Vector::length(); ++i) {
      if (!std::isfinite(value[i])) return false;
    }
    return true;
  });
}

Fault check_finite(const ModelData& data) {
  const VertexArrays& v = data.vertices;
  if (!finite_array(v.positions)) return "a position is not finite";
  if (!finite_array(v.normals)) return "a normal is not finite";
  return finite_array(v.uvs) ? fine : "a uv is not finite";
}

bool finite_value(const VertexPointers& vertices, VertexId slot) {
  bool finite = true;
  for_each_attribute(vertices, slot, [&finite](const auto& value, std::uint32_t) {
    if constexpr (!std::is_same_v<std::decay_t<decltype(value)>, glm::u8vec4>) {
      for (int i = 0; i < value.length(); ++i) finite = finite && std::isfinite(value[i]);
    }
  });
  return finite;
}

// Replays records upwards on arrays of its own.
class Checker {
 public:
  explicit Checker(const ModelData& data)
      : data_(data),
        indices_(3 * static_cast<std::size_t>(data.face_begin.back())),
        used_(data.base_face_counts),
        words_(data.value_words()),
        corner_total_(data.fan_corners.size() / data.corner_bytes) {
    const VertexId* from = data.base_indices.data();
    for (std::size_t m = 0; m < used_.size(); ++m) {
      const std::size_t count = 3 * static_cast<std::size_t>(used_[m]);
      std::copy_n(from, count, indices_.begin() + 3 * static_cast<std::ptrdiff_t>(data.face_begin[m]));
      from += count;
      at_.triangles += used_[m];
    }
    at_.vertices = data.base_vertex_count;
    if (!data.value_xor.empty()) moved_ = data.vertices;
  }

  [[nodiscard]] Fault replay(Replay& out) {
    while (at_.level < data_.shapes.size()) {
      if (at_.level % checkpoint_spacing == 0) out.checkpoints.push_back(at_);
      const std::uint8_t shape = data_.shapes[at_.level];
      const Fault fault = kind_of(shape) == RecordKind::Edit ? edit(shape) : fan(shape);
      if (fault != fine) return fault;
      ++at_.level;
    }
    if (out.checkpoints.empty()) out.checkpoints.push_back(at_);
    if (at_.fan_corner != corner_total_ || at_.edit_word != data_.edits.size() ||
        at_.value_word != data_.value_xor.size() ||
        at_.fan_record != (multi_material() ? data_.fan_materials.size() : at_.fan_record)) {
      return "the payload is longer than its records";
    }
    if (at_.vertices != data_.vertices.size()) return "some vertices belong to no record";
    out.end = at_;
    for (const glm::vec3& p : (moved_.positions.empty() ? data_.vertices : moved_).positions) {
      out.bounds.add(glm::dvec3{p});
    }
    return fine;
  }

  [[nodiscard]] Level level() const { return at_.level; }

 private:
  [[nodiscard]] bool multi_material() const { return data_.base_face_counts.size() > 1; }

  // Whether a corner lies on a face in use.
  [[nodiscard]] bool in_use(CornerId corner) const {
    const FaceId face = corner / 3;
    if (face >= data_.face_begin.back()) return false;
    if (!multi_material()) return face < used_[0];
    const auto above = std::upper_bound(data_.face_begin.begin(), data_.face_begin.end(), face);
    const auto m = static_cast<std::size_t>(above - data_.face_begin.begin()) - 1;
    return face - data_.face_begin[m] < used_[m];
  }

  [[nodiscard]] bool room(std::size_t m, std::uint32_t faces) const {
    return m < used_.size() && faces <= data_.face_begin[m + 1] - data_.face_begin[m] - used_[m];
  }

  void add_face(std::size_t m, VertexId a, VertexId b, VertexId c) {
    VertexId* face = &indices_[3 * static_cast<std::size_t>(data_.face_begin[m] + used_[m]++)];
    face[0] = a;
    face[1] = b;
    face[2] = c;
    ++at_.triangles;
  }

  Fault move(VertexId slot) {
    if (data_.value_xor.size() - at_.value_word < words_) return "the values end too early";
    xor_value(pointers(moved_), slot, data_.value_xor.data() + at_.value_word);
    at_.value_word += words_;
    return finite_value(pointers(moved_), slot) ? fine : "a vertex moves to a place that is not finite";
  }

  // The corners of fans to come lie all over the indices. Inlined because a compiler may take a call that only fetches
  // for one without effect.
  [[gnu::always_inline]] void fetch_corners(std::uint32_t count) const {
    constexpr std::uint64_t ahead = 64;
    const std::uint64_t begin = at_.fan_corner + ahead;
    const std::uint64_t end = std::min(begin + count, corner_total_);
    for (std::uint64_t i = begin; i < end; ++i) {
      const CornerId corner = load_corner(data_, i);
      if (corner < indices_.size()) __builtin_prefetch(&indices_[corner], 1);
    }
  }

  Fault fan(std::uint8_t shape) {
    const std::uint32_t count = corners_of(shape);
    if (count == 0) return "a fan has no corners";
    if (corner_total_ - at_.fan_corner < count) return "the corners end too early";
    if (at_.vertices == data_.vertices.size()) return "there are too few vertices";
    std::size_t m = 0;
    if (multi_material()) {
      if (at_.fan_record >= data_.fan_materials.size()) return "the materials of fans end too early";
      m = data_.fan_materials[at_.fan_record];
    }
    const RecordKind kind = kind_of(shape);
    if (!room(m, fan_faces(kind))) return "there are too few faces of a material";
    const VertexId s = at_.vertices;
    fetch_corners(count);
    const CornerId first = load_corner(data_, at_.fan_corner);
    const CornerId last = load_corner(data_, at_.fan_corner + count - 1);
    if (!in_use(first) || !in_use(last)) return "a corner is not in use";
    const VertexId v = indices_[first];
    const VertexId a = indices_[next_corner(first)];
    const VertexId b = indices_[previous_corner(last)];
    for (std::uint32_t i = 0; i < count; ++i) {
      const CornerId corner = load_corner(data_, at_.fan_corner + i);
      if (!in_use(corner)) return "a corner is not in use";
      if (indices_[corner] != v) return "the corners of a fan do not meet in one vertex";
      indices_[corner] = s;
    }
    if (kind != RecordKind::FanRight) add_face(m, s, v, a);
    if (kind != RecordKind::FanLeft) add_face(m, s, b, v);
    at_.fan_corner += count;
    ++at_.fan_record;
    ++at_.vertices;
    return moves(shape) ? move(v) : fine;
  }

  Fault edit(std::uint8_t shape) {
    if (shape != edit_shape) return "the shape of an edit has unknown bits";
    const std::uint64_t left = data_.edits.size() - at_.edit_word;
    if (left < edit_length(0, 0, 0, 0, 0)) return "the edits end too early";
    const EditBlock block{data_.edits.data() + at_.edit_word};
    const std::uint64_t length = edit_length(block.vertex_count(), block.face_count(), block.group_count(),
                                             block.corner_count(), block.move_count());
    if (length > left) return "the edits end too early";
    if (block.length() != length || block.words[length - 1] != length) return "the length of an edit is wrong";
    if (data_.vertices.size() - at_.vertices < block.vertex_count()) return "there are too few vertices";
    const std::uint32_t vertices = at_.vertices + block.vertex_count();
    for (std::uint32_t i = 0; i < block.vertex_count(); ++i) {
      if (block.merges()[i] > at_.vertices + i) return "a vertex merges into a later one";
    }
    if (const Fault fault = edit_corners(block, vertices); fault != fine) return fault;
    if (const Fault fault = edit_faces(block, vertices); fault != fine) return fault;
    for (std::uint32_t i = 0; i < block.move_count(); ++i) {
      if (block.moved()[i] >= at_.vertices) return "a vertex moves that one of the levels does not use";
      if (const Fault fault = move(block.moved()[i]); fault != fine) return fault;
    }
    at_.vertices = vertices;
    at_.edit_word += length;
    return fine;
  }

  Fault edit_corners(const EditBlock& block, std::uint32_t vertices) {
    const std::uint32_t* pair = block.corners();
    for (std::uint32_t i = 0; i < block.corner_count(); ++i, pair += 2) {
      if (!in_use(pair[0])) return "a corner is not in use";
      indices_[pair[0]] ^= pair[1];
    }
    for (pair = block.corners(); pair != block.moved(); pair += 2) {
      if (indices_[pair[0]] >= vertices) return "a corner is re-pointed to no vertex";
    }
    return fine;
  }

  Fault edit_faces(const EditBlock& block, std::uint32_t vertices) {
    const std::uint32_t* word = block.groups();
    const std::uint32_t* end = block.corners();
    std::uint32_t groups = 0;
    std::uint32_t faces = 0;
    for (std::uint32_t after = 0; word != end; ++groups) {
      if (end - word < 2) return "the faces of an edit do not fit its counts";
      const std::uint32_t m = word[0];
      const std::uint32_t count = word[1];
      word += 2;
      if (count == 0 || static_cast<std::uint64_t>(end - word) < 3ULL * count || m < after) {
        return "the faces of an edit do not fit its counts";
      }
      if (!room(m, count)) return "there are too few faces of a material";
      for (std::uint32_t i = 0; i < count; ++i, word += 3) {
        if (word[0] >= vertices || word[1] >= vertices || word[2] >= vertices) return "a face names no vertex";
        add_face(m, word[0], word[1], word[2]);
      }
      faces += count;
      after = m + 1;
    }
    return groups == block.group_count() && faces == block.face_count() ? fine
                                                                        : "the faces of an edit do not fit its counts";
  }

  const ModelData& data_;
  std::vector<VertexId> indices_;
  std::vector<std::uint32_t> used_;  // faces in use per material
  VertexArrays moved_;               // empty if nothing moves
  StackPosition at_;
  std::uint32_t words_;
  std::uint64_t corner_total_;
};

}  // namespace

Result<Replay> check(const ModelData& data) {
  const auto bad = [](Fault fault, std::string where) { return Error{ErrorCode::BadData, fault, std::move(where)}; };
  for (const auto& part : {check_surroundings, check_arrays, check_errors, check_finite}) {
    if (const Fault fault = part(data); fault != fine) return bad(fault, "progressive model");
  }
  Checker checker{data};
  Replay replay;
  if (const Fault fault = checker.replay(replay); fault != fine) {
    return bad(fault, "record " + std::to_string(checker.level()));
  }
  return replay;
}

}  // namespace lodestone::progressive
