// SPDX-License-Identifier: MIT
#include "clusters/walk.h"

#include <algorithm>

namespace lodestone::clusters {
namespace {

using Edge = std::uint64_t;  // from the vertex in the upper half to the other

Edge edge_from(VertexId a, VertexId b) { return Edge{a} << 32U | b; }

void walk(std::span<LiveFace> faces) {
  std::vector<std::pair<Edge, std::uint32_t>> edges;  // and the corner where they begin
  edges.reserve(3 * faces.size());
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const auto& v = faces[f].vertex;
    for (std::uint32_t k = 0; k < 3; ++k) edges.emplace_back(edge_from(v[k], v[k == 2 ? 0 : k + 1]), 3 * f + k);
  }
  std::sort(edges.begin(), edges.end());
  std::vector<LiveFace> order;
  order.reserve(faces.size());
  std::vector<std::uint8_t> taken(faces.size(), 0);
  std::vector<Edge> open;  // whose other side may be next
  const auto take = [&](std::uint32_t f, std::uint32_t k) {
    taken[f] = 1;
    const auto& v = faces[f].vertex;
    order.push_back({{v[k], v[(k + 1) % 3], v[(k + 2) % 3]}, faces[f].id});
    const auto& o = order.back().vertex;
    open.insert(open.end(), {edge_from(o[0], o[2]), edge_from(o[2], o[1])});
  };
  for (std::uint32_t next = 0; order.size() < faces.size();) {
    if (open.empty()) {
      while (taken[next] != 0) ++next;
      open.push_back(edge_from(faces[next].vertex[1], faces[next].vertex[0]));
      take(next, 0);
      continue;
    }
    const Edge edge = open.back();
    open.pop_back();
    auto at = std::lower_bound(edges.begin(), edges.end(), std::pair{edge, 0U});
    for (; at != edges.end() && at->first == edge; ++at) {
      if (taken[at->second / 3] != 0) continue;
      take(at->second / 3, at->second % 3);
      break;
    }
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
