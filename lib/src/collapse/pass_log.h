// SPDX-License-Identifier: MIT
// The collapses of one pass in one region, until the engine hands them to the sink in their final order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/types.h>

#include "base/edit_run.h"
#include "base/radix_sort.h"

namespace lodestone::collapse {

// One record, as a sink sees it; the spans live until the call returns. `values` holds the new words of each moved
// vertex, as progressive::EditLog::move_vertex() wants them.
struct Edit {
  float error_m = 0.0F;
  std::span<const FaceId> faces;
  std::span<const RemovedVertex> vertices;
  std::span<const RepointedCorner> corners;
  std::span<const VertexId> moved;
  std::span<const std::uint32_t> values;
};

class PassLog {
 public:
  // Records come out by ascending key; those of one key in the order in which they were made.
  void end(std::uint32_t key, float error_m) {
    ends_.push_back({error_m, size32(faces), size32(vertices), size32(corners), size32(moved)});
    keys_.push_back(key);
    value_words_ = moved.empty() ? 0 : size32(values) / size32(moved);
  }
  // Forgets all records but keeps the memory for those of the next pass.
  void clear() noexcept {
    faces.clear();
    vertices.clear();
    corners.clear();
    moved.clear();
    values.clear();
    ends_.clear();
    keys_.clear();
  }
  [[nodiscard]] std::size_t size() const noexcept { return ends_.size(); }
  [[nodiscard]] std::uint32_t key(std::size_t i) const noexcept { return keys_[i]; }
  [[nodiscard]] float error_m(std::size_t i) const noexcept { return ends_[i].error_m; }
  [[nodiscard]] std::uint32_t face_count(std::size_t begin, std::size_t end) const noexcept {
    return before(end).faces - before(begin).faces;
  }
  [[nodiscard]] Edit edit(std::size_t i) const noexcept {
    const EditRun one = run(i, i + 1);
    return {ends_[i].error_m, one.faces, one.vertices, one.corners, one.moved, one.values};
  }
  // Records [begin, end) at once.
  [[nodiscard]] EditRun run(std::size_t begin, std::size_t end) const noexcept {
    const RecordEnds from = before(begin);
    const RecordEnds to = before(end);
    return {part(faces, from.faces, to.faces),
            part(vertices, from.vertices, to.vertices),
            part(corners, from.corners, to.corners),
            part(moved, from.moves, to.moves),
            part(values, from.moves * value_words_, to.moves * value_words_),
            {ends_.data() + begin, ends_.data() + end},
            from,
            pass,
            lane};
  }
  // Makes this the records of `from` in the given order.
  void assign(const PassLog& from, const std::vector<Keyed>& order);

  std::uint32_t pass = 0;  // see EditRun
  std::uint32_t lane = 0;

  // Filled by the maker of a record before end().
  std::vector<FaceId> faces;
  std::vector<RemovedVertex> vertices;
  std::vector<RepointedCorner> corners;
  std::vector<VertexId> moved;
  std::vector<std::uint32_t> values;

 private:
  template <class T>
  static std::uint32_t size32(const std::vector<T>& list) noexcept {
    return static_cast<std::uint32_t>(list.size());
  }
  template <class T>
  static std::span<const T> part(const std::vector<T>& list, std::uint32_t from, std::uint32_t to) noexcept {
    return {list.data() + from, list.data() + to};
  }
  [[nodiscard]] RecordEnds before(std::size_t i) const noexcept { return i == 0 ? RecordEnds{} : ends_[i - 1]; }

  std::uint32_t value_words_ = 0;
  std::vector<RecordEnds> ends_;
  std::vector<std::uint32_t> keys_;
};

inline void PassLog::assign(const PassLog& from, const std::vector<Keyed>& order) {
  clear();
  value_words_ = from.value_words_;
  faces.reserve(from.faces.size());
  vertices.reserve(from.vertices.size());
  corners.reserve(from.corners.size());
  moved.reserve(from.moved.size());
  values.reserve(from.values.size());
  ends_.reserve(order.size());
  keys_.reserve(order.size());
  for (const auto& [key, i] : order) {
    const Edit edit = from.edit(i);
    for (const FaceId f : edit.faces) faces.push_back(f);
    for (const RemovedVertex& v : edit.vertices) vertices.push_back(v);
    for (const RepointedCorner& c : edit.corners) corners.push_back(c);
    for (const VertexId v : edit.moved) moved.push_back(v);
    for (const std::uint32_t word : edit.values) values.push_back(word);
    ends_.push_back({edit.error_m, size32(faces), size32(vertices), size32(corners), size32(moved)});
    keys_.push_back(key);
  }
}

}  // namespace lodestone::collapse
