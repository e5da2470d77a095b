// SPDX-License-Identifier: MIT
// Based on: Hoppe 1996, Progressive Meshes (records of an edge collapse); Li et al. 2019, section 2.4 (fixed slots, one
// stack for both directions).
// Differs: slots are sorted by removal time, so a record need not say which vertex and faces it adds.
#include "progressive/recorder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "progressive/check.h"
#include "progressive/encoder.h"
#include "progressive/record.h"
#include "progressive/values.h"

namespace lodestone::progressive {

namespace {

constexpr double error_step_ratio = 1.0019;

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
        replayed_{source.indices, {}, std::vector<std::uint8_t>(source.triangle_count(), Replayed::in_use)},
        vertex_slot_(source.vertex_count(), none),
        first_corner_(source.triangle_count(), none) {
    if (!log_.moved_.empty()) replayed_.values = source.vertices;
  }

  ModelData run(std::string method) {
    static_cast<Surroundings&>(data_) = source_;
    data_.method = std::move(method);
    assign_vertex_slots();
    encode();
    if (context_.cancelled()) return {};
    assign_face_slots();
    assemble();
    write_vertices();
    std::vector<float> errors;
    errors.reserve(log_.record_count());
    for (const auto& record : log_.records_) errors.push_back(record.error_m);
    data_.errors = error_steps(errors);
    return std::move(data_);
  }

 private:
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
    for (std::uint32_t i = log_.record_count(); i-- > 0;) order_removed(log_.spans(i).vertices, place);
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

  // Pass after pass, but the lanes of one at once.
  void encode() {
    stretches_ = log_.stretches();
    encoded_.resize(stretches_.size());
    for (std::size_t begin = 0, end = 0; begin != stretches_.size(); begin = end) {
      std::uint32_t lane_count = 0;
      for (; end != stretches_.size() && stretches_[end].pass == stretches_[begin].pass; ++end) {
        lane_count = std::max(lane_count, stretches_[end].lane + 1);
      }
      parallel_for_each(lane_count, 1, context_, [&](std::size_t lane) {
        Encoder encoder{source_, log_, vertex_slot_, replayed_};
        for (std::size_t i = begin; i != end; ++i) {
          if (stretches_[i].lane == lane) encoder.encode(stretches_[i].records, encoded_[i]);
        }
      });
    }
  }

  void assign_face_slots() {
    const std::size_t materials = source_.materials.size();
    data_.face_begin.assign(materials + 1, 0);
    data_.base_face_counts.assign(materials, 0);
    for (FaceId f = 0; f < source_.triangle_count(); ++f) {
      const MaterialId m = source_.face_material(f);
      ++data_.face_begin[m + 1];
      if (replayed_.rotation[f] == Replayed::in_use) ++data_.base_face_counts[m];
    }
    for (std::size_t m = 0; m < materials; ++m) data_.face_begin[m + 1] += data_.face_begin[m];
    std::vector<FaceId> next(data_.face_begin.begin(), data_.face_begin.end() - 1);
    const auto give = [&](FaceId f) {
      const std::uint32_t rotation = replayed_.rotation[f] == Replayed::in_use ? 0 : replayed_.rotation[f];
      first_corner_[f] = 3 * next[source_.face_material(f)]++ + rotation;
    };
    for (FaceId f = 0; f < source_.triangle_count(); ++f) {
      if (replayed_.rotation[f] == Replayed::in_use) give(f);
    }
    for (std::uint32_t i = log_.record_count(); i-- > 0;) {
      for (const FaceId f : log_.spans(i).faces) give(f);
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
      if (replayed_.rotation[f] != Replayed::in_use) continue;
      std::uint64_t& at = place[source_.face_material(f)];
      for (std::size_t c = 0; c < 3; ++c) data_.base_indices[at++] = vertex_slot_[replayed_.indices[3 * f + c]];
    }
  }

  [[nodiscard]] CornerId slot_corner(CornerId corner) const {
    const CornerId first = first_corner_[corner / 3];
    const std::uint32_t rotation = first % 3;
    return first - rotation + (corner % 3 + 3 - rotation) % 3;
  }

  // Turned round, one after the other, corners in slots.
  void assemble() {
    constexpr std::uint64_t three_byte_corners = 1ULL << 24U;
    data_.corner_bytes = source_.indices.size() <= three_byte_corners ? 3 : 4;
    std::vector<Ends> ends(encoded_.size() + 1);
    for (std::size_t i = encoded_.size(); i-- > 0;) ends[i] = ends[i + 1] + encoded_[i];
    data_.shapes.resize(ends[0].shapes);
    data_.fan_corners.resize(data_.corner_bytes * ends[0].fan_corners);
    data_.fan_materials.resize(ends[0].fan_materials);
    data_.edits.resize(ends[0].edits);
    data_.value_xor.resize(ends[0].value_xor);
    parallel_for_each(encoded_.size(), 1, context_, [&](std::size_t i) { place(encoded_[i], ends[i + 1]); });
  }

  // Where in the arrays of the model the records of a stretch begin.
  struct Ends {
    std::size_t shapes = 0, fan_corners = 0, fan_materials = 0, edits = 0, value_xor = 0;

    [[nodiscard]] Ends operator+(const Encoded& e) const noexcept {
      return {shapes + e.shapes.size(), fan_corners + e.fan_corners.size(), fan_materials + e.fan_materials.size(),
              edits + e.edits.size(), value_xor + e.value_xor.size()};
    }
  };

  void place(const Encoded& from, const Ends& at) {
    const auto turn = [](const auto& array, auto& to, std::size_t begin) {
      std::reverse_copy(array.begin(), array.end(), to.begin() + static_cast<std::ptrdiff_t>(begin));
    };
    turn(from.shapes, data_.shapes, at.shapes);
    turn(from.fan_materials, data_.fan_materials, at.fan_materials);
    turn(from.edits, data_.edits, at.edits);
    turn(from.value_xor, data_.value_xor, at.value_xor);
    translate_fans(from.fan_corners, data_.fan_corners.data() + data_.corner_bytes * at.fan_corners);
    translate_edits(at.edits, at.edits + from.edits.size());
  }

  void translate_fans(const std::vector<CornerId>& corners, std::uint8_t* out) const {
    constexpr std::size_t ahead = 48;
    for (std::size_t i = corners.size(); i-- > 0;) {
      if (i >= ahead) __builtin_prefetch(&first_corner_[corners[i - ahead] / 3]);
      const CornerId slot = slot_corner(corners[i]);
      std::memcpy(out, &slot, data_.corner_bytes);
      out += data_.corner_bytes;
    }
  }

  void translate_edits(std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; at += data_.edits[at]) {
      const EditBlock block{&data_.edits[at]};
      const auto first = static_cast<std::size_t>(block.corners() - data_.edits.data());
      for (std::size_t i = 0; i < block.corner_count(); ++i) {
        data_.edits[first + 2 * i] = slot_corner(data_.edits[first + 2 * i]);
      }
    }
  }

  void write_vertices() {
    const VertexArrays& from = log_.moved_.empty() ? source_.vertices : replayed_.values;
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

  static constexpr std::size_t chunk = 16'384;   // of what is done on all threads
  static constexpr VertexId pending = none - 1;  // slot of a vertex whose target is looked up

  const Mesh& source_;
  const Context& context_;
  EditLog log_;
  ModelData data_;
  Replayed replayed_;
  std::vector<EditLog::Stretch> stretches_;
  std::vector<Encoded> encoded_;          // one per stretch
  std::vector<VertexId> vertex_slot_;     // of each source vertex
  std::vector<VertexId> vertex_of_slot_;  // its inverse
  std::vector<CornerId> first_corner_;    // of each source face: 3 times its slot, plus its rotation
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
