// SPDX-License-Identifier: MIT
// Based on: Cignoni, Rocchini and Scopigno 1998, "Metro: measuring error on simplified surfaces" (two-sided, at
// vertices, middles of edges and centres of faces).
#include "outcrop/deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace lodestone::outcrop {
namespace {

constexpr std::size_t chunk_size = 4096;

std::vector<double> vertex_distances(const TriangleBvh& surface, const std::vector<glm::vec3>& positions,
                                     const Context& context) {
  std::vector<double> result(positions.size());
  parallel_chunks(result.size(), chunk_size, context, [&](std::size_t begin, std::size_t end) {
    std::uint32_t hint = none;
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleBvh::Nearest nearest = surface.nearest(glm::dvec3{positions[i]}, hint);
      hint = nearest.slot;
      result[i] = std::sqrt(nearest.squared_distance);
    }
  });
  return result;
}

bool is_solid(const Tiled& tiled, VertexId v) {
  return tiled.solid.empty() || tiled.solid[tiled.weld.point_of[v]] != 0;
}

// Has no width to be seen, or no area at all; what lies between its corners may be anywhere.
bool is_needle(const glm::dvec3& u, const glm::dvec3& v) {
  constexpr double width_of_length = 1e-6;
  const double squared_length = std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(u - v, u - v)});
  return glm::length(glm::cross(u, v)) <= width_of_length * squared_length;
}

// Large triangles lie farthest off between their corners: at the middles of edges and the centre. Returns per face the
// largest distance there, or at most `enough` of its tile.
std::vector<double> distances_between_corners(const Tiled& from, const TriangleBvh& to,
                                              const std::vector<TileDeviation>& enough, const Context& context) {
  std::vector<double> result(from.tile_of_face.size(), 0.0);
  parallel_chunks(result.size(), chunk_size, context, [&](std::size_t begin, std::size_t end) {
    std::uint32_t hint = none;
    for (std::size_t f = begin; f < end; ++f) {
      const auto at = [&](std::size_t k) { return glm::dvec3{from.positions[from.indices[3 * f + k]]}; };
      const glm::dvec3 p[3] = {at(0), at(1), at(2)};
      if (is_needle(p[1] - p[0], p[2] - p[0])) continue;
      for (const glm::dvec3& q :
           {(p[0] + p[1]) / 2.0, (p[1] + p[2]) / 2.0, (p[2] + p[0]) / 2.0, (p[0] + p[1] + p[2]) / 3.0}) {
        const TriangleBvh::Nearest nearest = to.nearest_beyond(q, enough[from.tile_of_face[f]].surface_m, hint);
        hint = nearest.slot;
        result[f] = std::max(result[f], std::sqrt(nearest.squared_distance));
      }
    }
  });
  return result;
}

void raise_surface(std::vector<TileDeviation>& per_tile, const Tiled& from, const TriangleBvh& to,
                   const Context& context) {
  const std::vector<double> at = vertex_distances(to, from.positions, context);
  for (std::size_t f = 0; f < from.tile_of_face.size(); ++f) {
    double& most = per_tile[from.tile_of_face[f]].surface_m;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = from.indices[3 * f + k];
      if (is_solid(from, v)) most = std::max(most, at[v]);
    }
  }
  const std::vector<double> between = distances_between_corners(from, to, per_tile, context);
  for (std::size_t f = 0; f < from.tile_of_face.size(); ++f) {
    double& most = per_tile[from.tile_of_face[f]].surface_m;
    most = std::max(most, between[f]);
  }
}

glm::vec3 place(const Tiled& tiled, std::uint32_t point) { return tiled.positions[tiled.weld.first_vertex[point]]; }

TriangleBvh chains_of(const Tiled& tiled) {
  std::vector<std::uint32_t> ends;
  for (const BorderEdge& edge : tiled.borders) ends.insert(ends.end(), {edge.a, edge.b});
  return segments_between(tiled.positions, tiled.weld, ends);
}

// Per edge the extent of the chain it belongs to: of what is connected and lies between the same two tiles.
std::vector<double> extents_of_chains(const Tiled& tiled) {
  struct End {
    std::uint32_t low = 0, high = 0, point = 0, edge = 0;
    auto operator<=>(const End&) const = default;  // NOLINT(modernize-use-nullptr): has none
    [[nodiscard]] bool meets(const End& other) const {
      return low == other.low && high == other.high && point == other.point;
    }
  };
  const auto count = static_cast<std::uint32_t>(tiled.borders.size());
  std::vector<End> ends;
  ends.reserve(2 * std::size_t{count});
  for (std::uint32_t i = 0; i < count; ++i) {
    const BorderEdge& edge = tiled.borders[i];
    const auto [low, high] = std::minmax(edge.left, edge.right);
    ends.push_back({low, high, edge.a, i});
    ends.push_back({low, high, edge.b, i});
  }
  std::sort(ends.begin(), ends.end());
  DisjointSets chains{count};
  for (std::size_t i = 1; i < ends.size(); ++i) {
    if (ends[i].meets(ends[i - 1])) chains.join(ends[i].edge, ends[i - 1].edge);
  }
  std::vector<Box> boxes(count);
  for (const End& end : ends) boxes[chains.find(end.edge)].add(glm::dvec3{place(tiled, end.point)});
  std::vector<double> extents;
  for (std::uint32_t i = 0; i < count; ++i) extents.push_back(boxes[chains.find(i)].diagonal_m());
  return extents;
}

// A tile's chain is held against the chain of the same tile: another's may lie nearer. Where a chain went altogether,
// as that around the only face of a photograph, the nearest may be anywhere; what gapes there is no wider than the
// chain.
void raise_borders(std::vector<TileDeviation>& per_tile, const Tiled& from, const Tiled& to, const Context& context) {
  if (from.borders.empty()) return;
  // Both ends and the middle: between two ends the other chain may turn away.
  constexpr std::size_t samples = 3;
  constexpr std::size_t chunk = 256;
  const TriangleBvh chains = chains_of(to);
  const std::vector<double> extents = extents_of_chains(from);
  std::vector<std::array<double, 2>> most(from.borders.size(), {0.0, 0.0});  // left, right
  parallel_chunks(most.size(), chunk, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BorderEdge& edge = from.borders[i];
      const glm::dvec3 a{place(from, edge.a)};
      const glm::dvec3 b{place(from, edge.b)};
      for (std::size_t side = 0; side < 2; ++side) {
        const std::uint32_t tile = side == 0 ? edge.left : edge.right;
        for (std::size_t k = 0; k < samples; ++k) {
          const glm::dvec3 p = a + (b - a) * (static_cast<double>(k) / (samples - 1));
          const auto nearest = chains.nearest_of(p, std::numeric_limits<double>::infinity(), [&](FaceId f) {
            return to.borders[f].left == tile || to.borders[f].right == tile;
          });
          const double away = nearest.face == none ? extents[i] : std::sqrt(nearest.squared_distance);
          most[i][side] = std::max(most[i][side], std::min(extents[i], away));
        }
      }
    }
  });
  for (std::size_t i = 0; i < most.size(); ++i) {
    double& left = per_tile[from.borders[i].left].border_m;
    double& right = per_tile[from.borders[i].right].border_m;
    left = std::max(left, most[i][0]);
    right = std::max(right, most[i][1]);
  }
}

}  // namespace

TriangleBvh segments_between(const std::vector<glm::vec3>& positions, const Weld& weld,
                             const std::vector<std::uint32_t>& ends) {
  std::vector<VertexId> indices;
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    const VertexId a = weld.first_vertex[ends[i]];
    const VertexId b = weld.first_vertex[ends[i + 1]];
    indices.insert(indices.end(), {a, b, b});
  }
  return {positions, indices};
}

std::vector<TileDeviation> Deviation::measure(const Tiled& source, const Tiled& level, std::uint32_t tiles,
                                              const Context& context) const {
  std::vector<TileDeviation> result(tiles);
  const TriangleBvh level_surface{level.positions, level.indices};
  raise_surface(result, source, level_surface, context);
  raise_surface(result, level, source_, context);
  raise_borders(result, source, level, context);
  raise_borders(result, level, source, context);
  return result;
}

}  // namespace lodestone::outcrop
