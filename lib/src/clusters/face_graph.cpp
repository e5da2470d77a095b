// SPDX-License-Identifier: MIT
#include "clusters/face_graph.h"

#include <algorithm>
#include <numeric>

#include "base/disjoint_sets.h"
#include "base/hash.h"
#include "base/radix_sort.h"

namespace lodestone::clusters {
namespace {

constexpr std::int32_t edge_weight = 8;
constexpr std::int32_t near_weight = 1;

std::uint32_t spread3(std::uint32_t x) {
  x = (x | (x << 16U)) & 0x030000FFU;
  x = (x | (x << 8U)) & 0x0300F00FU;
  x = (x | (x << 4U)) & 0x030C30C3U;
  return (x | (x << 2U)) & 0x09249249U;
}

}  // namespace

std::vector<EdgeOfFace> sorted_edges(std::span<const std::array<std::uint32_t, 3>> faces, std::uint32_t point_count) {
  std::vector<std::uint32_t> at(std::size_t{point_count} + 1, 0);
  const auto for_each_edge = [&](auto&& visit) {
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      const auto& p = faces[f];
      if (is_collapsed(p)) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t q = p[k == 2 ? 0 : k + 1];
        visit(EdgeOfFace{std::min(p[k], q), std::max(p[k], q), f});
      }
    }
  };
  for_each_edge([&](const EdgeOfFace& e) { ++at[e.low + 1]; });
  std::partial_sum(at.begin(), at.end(), at.begin());
  std::vector<EdgeOfFace> edges(at.back());
  std::vector<std::uint32_t> next(at.begin(), at.end() - 1);
  for_each_edge([&](const EdgeOfFace& e) { edges[next[e.low]++] = e; });
  for (std::uint32_t p = 0; p < point_count; ++p) {
    std::sort(edges.begin() + at[p], edges.begin() + at[p + 1], [](const EdgeOfFace& a, const EdgeOfFace& b) {
      return a.high != b.high ? a.high < b.high : a.face < b.face;
    });
  }
  return edges;
}

LocalPoints local_points(std::span<const LiveFace> faces, std::span<const std::uint32_t> point_of) {
  const auto point_at = [&](std::uint32_t corner) { return point_of[faces[corner / 3].vertex[corner % 3]]; };
  const UniqueIds ids = unique_ids(
      static_cast<std::uint32_t>(3 * faces.size()), [&](std::uint32_t c) { return mix64(point_at(c)); },
      [&](std::uint32_t a, std::uint32_t b) { return point_at(a) == point_at(b); });
  LocalPoints result;
  result.faces.resize(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    result.faces[f] = {ids.id_of[3 * f], ids.id_of[3 * f + 1], ids.id_of[3 * f + 2]};
  }
  result.points.reserve(ids.first.size());
  for (const std::uint32_t corner : ids.first) result.points.push_back(point_at(corner));
  return result;
}

std::vector<std::uint32_t> morton_order(std::span<const glm::vec3> places) {
  glm::vec3 low{std::numeric_limits<float>::max()};
  glm::vec3 high{std::numeric_limits<float>::lowest()};
  for (const glm::vec3& p : places) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 size = glm::dvec3{high} - glm::dvec3{low};
  const double scale = 1023.0 / std::max({size.x, size.y, size.z, 1e-30});
  std::vector<Keyed> keyed(places.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const glm::dvec3 at = (glm::dvec3{places[i]} - glm::dvec3{low}) * scale;
    keyed[i] = {spread3(static_cast<std::uint32_t>(at.x)) | spread3(static_cast<std::uint32_t>(at.y)) << 1U |
                    spread3(static_cast<std::uint32_t>(at.z)) << 2U,
                i};
  }
  radix_sort(keyed);
  std::vector<std::uint32_t> order(places.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = keyed[i].value;
  return order;
}

partition::WeightedGraph face_graph(std::span<const LiveFace> faces, const Ground& ground) {
  const auto count = static_cast<std::uint32_t>(faces.size());
  const LocalPoints local = local_points(faces, ground.point_of);
  const std::vector<EdgeOfFace> edges = sorted_edges(local.faces, static_cast<std::uint32_t>(local.points.size()));
  std::vector<partition::WeightedEdge> links;
  links.reserve(edges.size());
  DisjointSets sets{count};
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].low != edges[i - 1].low || edges[i].high != edges[i - 1].high) continue;
    links.push_back({edges[i - 1].face, edges[i].face, edge_weight});
    sets.join(edges[i - 1].face, edges[i].face);
  }
  bool connected = true;
  for (std::uint32_t f = 1; f < count && connected; ++f) connected = sets.find(f) == 0;
  if (!connected) {
    std::vector<glm::vec3> middles(count);
    for (std::uint32_t f = 0; f < count; ++f) {
      const auto& p = ground.values.positions;
      const auto& v = faces[f].vertex;
      middles[f] = (p[v[0]] + p[v[1]] + p[v[2]]) / 3.0F;
    }
    const std::vector<std::uint32_t> order = morton_order(middles);
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (sets.find(order[i - 1]) != sets.find(order[i])) links.push_back({order[i - 1], order[i], near_weight});
    }
  }
  return partition::make_graph(count, links);
}

}  // namespace lodestone::clusters
