// SPDX-License-Identifier: MIT
#include "clusters/walk.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/hash.h"

namespace lodestone::clusters {
namespace {

constexpr std::uint32_t no_corner = std::numeric_limits<std::uint32_t>::max();

// The corners of faces by the edge that begins there.
class CornerTable {
 public:
  explicit CornerTable(std::span<const LiveFace> faces)
      : faces_(faces), table_(std::bit_ceil(6 * faces.size()), no_corner) {
    for (std::uint32_t corner = 0; corner < 3 * faces.size(); ++corner) {
      std::size_t at = place_of(vertex(corner), vertex(after(corner)));
      while (table_[at] != no_corner) at = (at + 1) & (table_.size() - 1);
      table_[at] = corner;
    }
  }

  // The first corner where an edge from a to b begins, of a face not taken yet.
  [[nodiscard]] std::uint32_t find(VertexId a, VertexId b, const std::vector<std::uint8_t>& taken) const {
    for (std::size_t at = place_of(a, b); table_[at] != no_corner; at = (at + 1) & (table_.size() - 1)) {
      const std::uint32_t corner = table_[at];
      if (taken[corner / 3] == 0 && vertex(corner) == a && vertex(after(corner)) == b) return corner;
    }
    return no_corner;
  }

 private:
  static std::uint32_t after(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
  [[nodiscard]] VertexId vertex(std::uint32_t corner) const { return faces_[corner / 3].vertex[corner % 3]; }
  [[nodiscard]] std::size_t place_of(VertexId a, VertexId b) const {
    return mix64(std::uint64_t{a} << 32U | b) & (table_.size() - 1);
  }

  std::span<const LiveFace> faces_;
  std::vector<std::uint32_t> table_;
};

void walk(std::span<LiveFace> faces) {
  const CornerTable corners{faces};
  std::vector<LiveFace> order;
  order.reserve(faces.size());
  std::vector<std::uint8_t> taken(faces.size(), 0);
  std::vector<std::array<VertexId, 2>> open;  // edges whose other side may be next
  const auto take = [&](std::uint32_t f, std::uint32_t k) {
    taken[f] = 1;
    const auto& v = faces[f].vertex;
    order.push_back({{v[k], v[(k + 1) % 3], v[(k + 2) % 3]}, faces[f].id});
    const auto& o = order.back().vertex;
    open.push_back({o[0], o[2]});
    open.push_back({o[2], o[1]});
  };
  for (std::uint32_t next = 0; order.size() < faces.size();) {
    if (open.empty()) {
      while (taken[next] != 0) ++next;
      open.push_back({faces[next].vertex[1], faces[next].vertex[0]});
      take(next, 0);
      continue;
    }
    const auto [a, b] = open.back();
    open.pop_back();
    const std::uint32_t corner = corners.find(a, b, taken);
    if (corner != no_corner) take(corner / 3, corner % 3);
  }
  std::copy(order.begin(), order.end(), faces.begin());
}

}  // namespace

void put_in_order(std::span<LiveFace> faces, const Mesh& source) {
  const auto material = [&](const LiveFace& f) { return source.face_material(f.id); };
  std::stable_sort(faces.begin(), faces.end(),
                   [&](const LiveFace& a, const LiveFace& b) { return material(a) < material(b); });
  for (auto first = faces.begin(); first != faces.end();) {
    const auto last =
        std::find_if(first, faces.end(), [&](const LiveFace& f) { return material(f) != material(*first); });
    walk({first, last});
    first = last;
  }
}

}  // namespace lodestone::clusters
