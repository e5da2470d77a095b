// SPDX-License-Identifier: MIT
// From files that index positions, texture coordinates and normals apart (OBJ, some PLY) to vertices that hold all
// three.
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/types.h>

namespace lodestone {

// A corner as the file names it; `none` where it names no uv or normal.
struct WedgeKey {
  std::uint32_t position = 0;
  std::uint32_t uv = none;
  std::uint32_t normal = none;
};

// Gives equal keys the same vertex, in order of first use. The wedges of a position form a chain; it is searched for at
// most 24 steps, so a hostile file costs no more than a few vertices that could have been shared.
class WedgeTable {
 public:
  [[nodiscard]] VertexId vertex(const WedgeKey& key) {
    if (key.position >= first_.size()) first_.resize(key.position + 1 + key.position / 2, none);
    int steps = 0;
    for (VertexId w = first_[key.position]; w != none && steps < 24; w = wedges_[w].next, ++steps) {
      if (wedges_[w].key.uv == key.uv && wedges_[w].key.normal == key.normal) return w;
    }
    const auto w = static_cast<VertexId>(wedges_.size());
    wedges_.push_back({key, first_[key.position]});
    first_[key.position] = w;
    return w;
  }
  [[nodiscard]] std::size_t size() const noexcept { return wedges_.size(); }
  [[nodiscard]] const WedgeKey& key(VertexId vertex) const noexcept { return wedges_[vertex].key; }
  // Frees what only vertex() needs.
  void close() { first_ = {}; }

 private:
  struct Wedge {
    WedgeKey key;
    VertexId next;
  };
  std::vector<VertexId> first_;
  std::vector<Wedge> wedges_;
};

}  // namespace lodestone
