// SPDX-License-Identifier: MIT
#include "reorder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "edit_words.h"
#include "topology.h"
#include "values.h"

namespace lodestone::model_file {
namespace {

// Where a record's parts lie in the arrays of the source, and where it may stand.
struct Place {
  std::size_t fan_corner = 0;  // of an edit: the first of its corners in `edit_from_`
  std::size_t edit_word = 0, value_word = 0;
  std::uint32_t fan_record = 0;
  VertexId first_vertex = 0;
  std::size_t first_face = 0;  // of a fan: its first face slot; of an edit: its first group in `group_slots_`
  VertexId splits = 0;         // the vertex it is sorted by
  std::uint32_t layer = 0;     // records of one layer do not depend on each other
};

// Spreads 10 bits to every third.
std::uint32_t spread(std::uint32_t x) noexcept {
  x = (x | x << 16) & 0x030000FFU;
  x = (x | x << 8) & 0x0300F00FU;
  x = (x | x << 4) & 0x030C30C3U;
  return (x | x << 2) & 0x09249249U;
}

class Reorderer {
 public:
  explicit Reorderer(const ModelData& data)
      : data_(data),
        next_face_(data.face_begin.begin(), data.face_begin.end()),
        face_layer_(data.face_begin.back(), 0),
        vertex_layer_(data.vertices.size(), 0),
        vertex_map_(data.vertices.size(), none),
        face_map_(data.face_begin.back(), none) {}

  ModelData run() {
    scan();
    close_errors();
    map_base();
    arrange();
    emit();
    return std::move(out_);
  }

 private:
  [[nodiscard]] RecordKind kind(std::uint32_t record) const { return kind_of(data_.shapes[record]); }

  // Walks the stack upwards once and finds for each record the first layer it can stand in.
  void scan() {
    vertices_.assign(3 * std::size_t{data_.face_begin.back()}, none);
    const VertexId* from = data_.base_indices.data();
    for (MaterialId m = 0; m < data_.base_face_counts.size(); ++m) {
      for (std::uint32_t f = 0; f < data_.base_face_counts[m]; ++f, from += 3) {
        std::copy_n(from, 3, &vertices_[3 * std::size_t{next_face_[m]++}]);
      }
    }
    Place at;
    at.first_vertex = data_.base_vertex_count;
    Level window_end = 0;
    const auto records = static_cast<std::uint32_t>(data_.shapes.size());
    places_.reserve(records);
    for (std::uint32_t r = 0; r < records; ++r) {
      if (r == window_end) window_end = open_window(r);
      at.layer = window_layer_;
      kind(r) == RecordKind::Edit ? scan_edit(at) : scan_fan(r, at);
      top_layer_ = std::max(top_layer_, places_.back().layer);
    }
  }

  // A window ends where the error has fallen far enough, or at a named level.
  Level open_window(Level start) {
    window_layer_ = top_layer_ + 1;
    while (step_ + 1 < data_.errors.size() && data_.errors[step_ + 1].level <= start) ++step_;
    const float error_m = data_.errors[step_].error_m;
    if (errors_.empty() || errors_.back().error_m != error_m) errors_.push_back({start, error_m});
    auto end = static_cast<Level>(data_.shapes.size());
    for (std::size_t s = step_; s < data_.errors.size(); ++s) {
      if (data_.errors[s].level > start && data_.errors[s].error_m < window_error_ratio * error_m) {
        end = std::min(end, data_.errors[s].level);
        break;
      }
    }
    for (const NamedLevel& named : data_.named_levels) {
      if (named.level > start) end = std::min(end, named.level);
    }
    return end;
  }

  // The finest level keeps its own error.
  void close_errors() {
    if (errors_.empty() || data_.errors.back().error_m < errors_.back().error_m) {
      errors_.push_back({errors_.empty() ? 0 : static_cast<Level>(data_.shapes.size()), data_.errors.back().error_m});
    }
  }

  // Makes a record that touches something of this layer stand above it.
  static void above(Place& place, std::uint32_t layer) noexcept { place.layer = std::max(place.layer, layer + 1); }

  void scan_fan(std::uint32_t record, Place& at) {
    const std::uint8_t shape = data_.shapes[record];
    const std::uint32_t count = shape & RecordShape::corner_mask;
    std::array<CornerId, RecordShape::corner_mask> corners{};
    for (std::uint32_t i = 0; i < count; ++i) corners[i] = load_corner(data_, at.fan_corner + i);
    Place place = at;
    const VertexId split = vertices_[corners[0]];
    const VertexId a = vertices_[next_corner(corners[0])];
    const VertexId b = vertices_[previous_corner(corners[count - 1])];
    for (std::uint32_t i = 0; i < count; ++i) above(place, face_layer_[corners[i] / 3]);
    const bool moves = (shape & RecordShape::moves_flag) != 0;
    if (moves) above(place, vertex_layer_[split]);
    if (moves) vertex_layer_[split] = place.layer;
    vertex_layer_[at.first_vertex] = place.layer;
    for (std::uint32_t i = 0; i < count; ++i) {
      face_layer_[corners[i] / 3] = place.layer;
      vertices_[corners[i]] = at.first_vertex;
    }
    const MaterialId m = data_.fan_materials.empty() ? 0 : data_.fan_materials[at.fan_record];
    place.first_face = next_face_[m];
    place.splits = split;
    if (kind(record) != RecordKind::FanRight) add_face(m, {at.first_vertex, split, a}, place.layer);
    if (kind(record) != RecordKind::FanLeft) add_face(m, {at.first_vertex, b, split}, place.layer);
    places_.push_back(place);
    at.fan_corner += count;
    ++at.fan_record;
    ++at.first_vertex;
    if (moves) at.value_word += data_.value_words();
  }

  void add_face(MaterialId m, std::array<VertexId, 3> corners, std::uint32_t layer) {
    const FaceId face = next_face_[m]++;
    face_layer_[face] = layer;
    std::copy(corners.begin(), corners.end(), &vertices_[3 * std::size_t{face}]);
  }

  void scan_edit(Place& at) {
    const EditWords edit{&data_.edits[at.edit_word]};
    Place place = at;
    const auto above_vertex = [&](VertexId v) {
      if (v < at.first_vertex) above(place, vertex_layer_[v]);
    };
    for (const VertexId v : edit.merges()) above_vertex(v);
    for (const VertexId v : edit.moved()) above_vertex(v);
    const auto pairs = edit.corners();
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
      above(place, face_layer_[pairs[i] / 3]);
      above_vertex(vertices_[pairs[i]] ^ pairs[i + 1]);
    }
    edit.for_each_group([&](MaterialId, std::span<const std::uint32_t> faces) {
      for (const VertexId v : faces) above_vertex(v);
    });
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
      face_layer_[pairs[i] / 3] = place.layer;
      edit_from_.push_back(vertices_[pairs[i]]);
      vertices_[pairs[i]] ^= pairs[i + 1];
    }
    place.first_face = group_slots_.size();
    edit.for_each_group([&](MaterialId m, std::span<const std::uint32_t> faces) {
      group_slots_.push_back(next_face_[m]);
      for (std::size_t i = 0; i < faces.size(); i += 3)
        add_face(m, {faces[i], faces[i + 1], faces[i + 2]}, place.layer);
    });
    for (const VertexId v : edit.moved()) vertex_layer_[v] = place.layer;
    for (std::size_t i = 0; i < edit.merges().size(); ++i) vertex_layer_[at.first_vertex + i] = place.layer;
    place.splits = !edit.merges().empty() ? edit.merges()[0] : !edit.moved().empty() ? edit.moved()[0] : 0;
    place.splits = place.splits < at.first_vertex ? place.splits : 0;
    place.fan_corner = edit_from_.size() - pairs.size() / 2;
    places_.push_back(place);
    at.edit_word += edit.length();
    at.first_vertex += static_cast<std::uint32_t>(edit.merges().size());
    at.value_word += edit.moved().size() * data_.value_words();
  }

  // The base along a space-filling curve; its faces by their vertices.
  void map_base() {
    Box box;
    for (std::uint32_t v = 0; v < data_.base_vertex_count; ++v) box.add(glm::dvec3{data_.vertices.positions[v]});
    const glm::dvec3 size = glm::max(box.size(), glm::dvec3{1e-300});
    std::vector<std::pair<std::uint32_t, VertexId>> curve;
    for (std::uint32_t v = 0; v < data_.base_vertex_count; ++v) {
      const glm::dvec3 p = (glm::dvec3{data_.vertices.positions[v]} - box.min) / size * 1023.0;
      curve.emplace_back(spread(static_cast<std::uint32_t>(p.x)) | spread(static_cast<std::uint32_t>(p.y)) << 1 |
                             spread(static_cast<std::uint32_t>(p.z)) << 2,
                         v);
    }
    std::sort(curve.begin(), curve.end());
    for (const auto& [code, v] : curve) vertex_map_[v] = vertex_count_++;
    std::copy(data_.face_begin.begin(), data_.face_begin.end(), next_face_.begin());
    std::vector<std::pair<VertexId, FaceId>> faces;
    for (MaterialId m = 0, first = 0; m < data_.base_face_counts.size(); first += data_.base_face_counts[m++]) {
      faces.clear();
      for (std::uint32_t f = 0; f < data_.base_face_counts[m]; ++f) {
        const VertexId* corner = &data_.base_indices[3 * std::size_t{first + f}];
        faces.emplace_back(std::min({vertex_map_[corner[0]], vertex_map_[corner[1]], vertex_map_[corner[2]]}),
                           first + f);
      }
      std::sort(faces.begin(), faces.end());
      for (const auto& [key, f] : faces) {
        base_order_.push_back(f);
        face_map_[data_.face_begin[m] + f - first] = next_face_[m]++;
      }
    }
  }

  // Layer after layer, each in the order of the vertices it splits; gives the new slots.
  void arrange() {
    order_.resize(places_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return places_[a].layer < places_[b].layer; });
    for (auto first = order_.begin(); first != order_.end();) {
      const auto last =
          std::find_if(first, order_.end(), [&](std::uint32_t r) { return places_[r].layer != places_[*first].layer; });
      std::stable_sort(first, last,
                       [&](auto a, auto b) { return vertex_map_[places_[a].splits] < vertex_map_[places_[b].splits]; });
      for (; first != last; ++first) map_record(*first);
    }
  }

  void map_record(std::uint32_t r) {
    const Place& place = places_[r];
    if (kind(r) == RecordKind::Edit) {
      const EditWords edit{&data_.edits[place.edit_word]};
      for (std::size_t i = 0; i < edit.merges().size(); ++i) vertex_map_[place.first_vertex + i] = vertex_count_++;
      std::size_t group = place.first_face;
      edit.for_each_group([&](MaterialId m, std::span<const std::uint32_t> faces) {
        const FaceId first = group_slots_[group++];
        for (std::size_t f = 0; f < faces.size() / 3; ++f) face_map_[first + f] = next_face_[m]++;
      });
      return;
    }
    vertex_map_[place.first_vertex] = vertex_count_++;
    const MaterialId m = data_.fan_materials.empty() ? 0 : data_.fan_materials[place.fan_record];
    face_map_[place.first_face] = next_face_[m]++;
    if (kind(r) == RecordKind::FanBoth) face_map_[place.first_face + 1] = next_face_[m]++;
  }

  [[nodiscard]] CornerId map_corner(CornerId corner) const { return 3 * face_map_[corner / 3] + corner % 3; }

  void emit() {
    static_cast<Surroundings&>(out_) = data_;
    out_.base_vertex_count = data_.base_vertex_count;
    out_.face_begin = data_.face_begin;
    out_.base_face_counts = data_.base_face_counts;
    out_.corner_bytes = data_.corner_bytes;
    out_.errors = errors_;
    out_.named_levels = data_.named_levels;
    out_.method = data_.method;
    emit_vertices();
    for (const std::uint32_t f : base_order_) {
      for (std::size_t c = 0; c < 3; ++c) out_.base_indices.push_back(vertex_map_[data_.base_indices[3 * f + c]]);
    }
    out_.face_features.resize(data_.face_features.size());
    for (std::size_t f = 0; f < data_.face_features.size(); ++f)
      out_.face_features[face_map_[f]] = data_.face_features[f];
    for (const std::uint32_t r : order_) emit_record(r);
  }

  void emit_vertices() {
    const auto permute = [&](const auto& from, auto& to) {
      to.resize(from.size());
      for (std::size_t v = 0; v < from.size(); ++v) to[vertex_map_[v]] = from[v];
    };
    permute(data_.vertices.positions, out_.vertices.positions);
    permute(data_.vertices.normals, out_.vertices.normals);
    permute(data_.vertices.uvs, out_.vertices.uvs);
    permute(data_.vertices.colors, out_.vertices.colors);
  }

  void emit_record(std::uint32_t r) {
    const Place& place = places_[r];
    const std::uint8_t shape = data_.shapes[r];
    out_.shapes.push_back(shape);
    if (kind(r) == RecordKind::Edit) return emit_edit(place);
    const std::uint32_t count = shape & RecordShape::corner_mask;
    std::array<CornerId, RecordShape::corner_mask> corners;
    for (std::uint32_t i = 0; i < count; ++i) corners[i] = map_corner(load_corner(data_, place.fan_corner + i));
    store_corners(out_, std::span{corners}.first(count));
    if (!data_.fan_materials.empty()) out_.fan_materials.push_back(data_.fan_materials[place.fan_record]);
    if ((shape & RecordShape::moves_flag) != 0) emit_values(place, 1);
  }

  void emit_values(const Place& place, std::size_t moves) {
    const auto from = data_.value_xor.begin() + static_cast<std::ptrdiff_t>(place.value_word);
    out_.value_xor.insert(out_.value_xor.end(), from, from + static_cast<std::ptrdiff_t>(moves * data_.value_words()));
  }

  void emit_edit(const Place& place) {
    const auto from = data_.edits.begin() + static_cast<std::ptrdiff_t>(place.edit_word);
    const std::size_t at = out_.edits.size();
    out_.edits.insert(out_.edits.end(), from, from + *from);
    const EditWords edit{&out_.edits[at]};
    for (std::uint32_t& v : edit.merges()) v = vertex_map_[v];
    edit.for_each_group([&](MaterialId, std::span<std::uint32_t> faces) {
      for (std::uint32_t& v : faces) v = vertex_map_[v];
    });
    const auto pairs = edit.corners();
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
      const VertexId before = edit_from_[place.fan_corner + i / 2];
      pairs[i + 1] = vertex_map_[before] ^ vertex_map_[before ^ pairs[i + 1]];
      pairs[i] = map_corner(pairs[i]);
    }
    for (std::uint32_t& v : edit.moved()) v = vertex_map_[v];
    emit_values(place, edit.moved().size());
  }

  const ModelData& data_;
  ModelData out_;
  std::vector<VertexId> vertices_;  // per corner
  std::vector<FaceId> next_face_;
  std::vector<std::uint32_t> face_layer_, vertex_layer_;  // of the last record that touched it
  std::uint32_t window_layer_ = 0, top_layer_ = 0;
  std::size_t step_ = 0;
  std::vector<ErrorStep> errors_;
  std::vector<Place> places_;
  std::vector<FaceId> group_slots_;  // first face slot of each group of each edit
  std::vector<VertexId> edit_from_;  // what each re-pointed corner of an edit held before
  std::vector<std::uint32_t> order_, base_order_;
  std::vector<VertexId> vertex_map_;
  std::vector<FaceId> face_map_;
  std::uint32_t vertex_count_ = 0;
};

}  // namespace

ModelData reorder(const ModelData& data) { return Reorderer{data}.run(); }

}  // namespace lodestone::model_file
