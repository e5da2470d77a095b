// SPDX-License-Identifier: MIT
// The collapses of one pass in one region, until the engine hands them to the sink in their final order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/types.h>

namespace lodestone::collapse {

struct RemovedVertex {
  VertexId vertex = none;
  VertexId merges_into = none;
};

struct RepointedCorner {
  CornerId corner = none;
  VertexId to = none;
};

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
    heads_.push_back({key, error_m, size32(faces), size32(vertices), size32(corners), size32(moved), size32(values)});
  }
  [[nodiscard]] std::size_t size() const noexcept { return heads_.size(); }
  [[nodiscard]] std::uint32_t key(std::size_t i) const noexcept { return heads_[i].key; }
  [[nodiscard]] Edit edit(std::size_t i) const noexcept {
    const Head zero;
    const Head& from = i == 0 ? zero : heads_[i - 1];
    const Head& to = heads_[i];
    return {to.error_m,
            part(faces, from.faces, to.faces),
            part(vertices, from.vertices, to.vertices),
            part(corners, from.corners, to.corners),
            part(moved, from.moved, to.moved),
            part(values, from.values, to.values)};
  }

  // Filled by the maker of a record before end().
  std::vector<FaceId> faces;
  std::vector<RemovedVertex> vertices;
  std::vector<RepointedCorner> corners;
  std::vector<VertexId> moved;
  std::vector<std::uint32_t> values;

 private:
  struct Head {
    std::uint32_t key = 0;
    float error_m = 0.0F;
    std::uint32_t faces = 0, vertices = 0, corners = 0, moved = 0, values = 0;  // ends
  };
  template <class T>
  static std::uint32_t size32(const std::vector<T>& list) noexcept {
    return static_cast<std::uint32_t>(list.size());
  }
  template <class T>
  static std::span<const T> part(const std::vector<T>& list, std::uint32_t from, std::uint32_t to) noexcept {
    return {list.data() + from, list.data() + to};
  }
  std::vector<Head> heads_;
};

}  // namespace lodestone::collapse
