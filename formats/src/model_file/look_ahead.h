// SPDX-License-Identifier: MIT
// Reading waits for memory: a split touches the list of a vertex, the faces in it, the vertices of those and their
// lists, each found by way of the one before. Which vertices the next records split stands in columns of its own, so
// what they will touch can be fetched some records ahead, one link of that chain at a time.
#pragma once

#include <array>
#include <cstdint>

#include "stack_codec.h"
#include "topology.h"

namespace lodestone::model_file {

class LookAhead {
  // In records.
  static constexpr std::uint32_t list_to_faces = 6;
  static constexpr std::uint32_t faces_to_ring = 6;
  static constexpr std::uint32_t ring_to_use = 6;

 public:
  // How many steps come before the first record of a block; then one comes before each.
  static constexpr std::uint32_t lead = list_to_faces + faces_to_ring + ring_to_use;

  // `last_split`: where the record before the block left it.
  LookAhead(const ReadColumns& columns, VertexId last_split) noexcept
      : kind_(columns[Kind]), split_(columns[Split]), last_(last_split) {
    splits_.fill(none);
  }

  // `fetch_value(vertex)` fetches a vertex's value. Nothing that was found here is trusted later: a list may have
  // changed meanwhile, which only costs time.
  template <class FetchValue>
  void step(const Topology& topology, FetchValue&& fetch_value) noexcept {
    const VertexId far = found(0) = next_split();
    if (far < topology.capacity()) topology.fetch_list(far);
    const VertexId middle = found(list_to_faces);
    if (topology.has_short_list(middle)) {
      for (const CornerId corner : topology.star(middle)) topology.fetch_face(corner);
    }
    const VertexId near = found(list_to_faces + faces_to_ring);
    if (topology.has_short_list(near)) {
      fetch_value(near);
      for (const CornerId corner : topology.star(near)) {
        const VertexId around = topology.vertex(next_corner(corner));
        topology.fetch_list(around);
        fetch_value(around);
      }
    }
    ++steps_;
  }

 private:
  static constexpr std::uint32_t window = 32;
  static_assert(window > lead && (window & (window - 1)) == 0);

  // What next_split() gave so many steps ago.
  [[nodiscard]] VertexId& found(std::uint32_t ago) noexcept { return splits_[(steps_ - ago) % window]; }

  // `none` for a record that names no vertex to split, and past the end.
  [[nodiscard]] VertexId next_split() noexcept {
    if (kind_.left() == 0) return none;
    const std::uint32_t word = kind_.get();
    if ((word & 3U) == static_cast<std::uint32_t>(RecordKind::Edit) ||
        ((word >> 3) & 3U) == static_cast<std::uint32_t>(NameMode::Number)) {
      return none;
    }
    const std::uint32_t step = split_.get();
    last_ = (word & 32U) != 0 ? last_ - step : last_ + step;
    return last_;
  }

  ColumnReader kind_, split_;
  VertexId last_;
  std::uint32_t steps_ = 0;
  std::array<VertexId, window> splits_{};
};

}  // namespace lodestone::model_file
