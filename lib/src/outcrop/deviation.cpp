// SPDX-License-Identifier: MIT
// Based on: Cignoni, Rocchini and Scopigno 1998, "Metro: measuring error on simplified surfaces" (two-sided, at the
// vertices).
#include "outcrop/deviation.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace lodestone::outcrop {
namespace {

template <class Point>
std::vector<double> distances(const TriangleBvh& surface, std::size_t count, const Context& context, Point point) {
  constexpr std::size_t chunk = 4096;
  std::vector<double> result(count);
  parallel_chunks(count, chunk, context, [&](std::size_t begin, std::size_t end) {
    std::uint32_t hint = none;
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleBvh::Nearest nearest = surface.nearest(glm::dvec3{point(i)}, hint);
      hint = nearest.slot;
      result[i] = std::sqrt(nearest.squared_distance);
    }
  });
  return result;
}

void raise_surface(std::vector<TileDeviation>& per_tile, const Tiled& from, const TriangleBvh& to,
                   const Context& context) {
  const std::vector<double> distance =
      distances(to, from.positions.size(), context, [&](std::size_t i) { return from.positions[i]; });
  for (std::size_t f = 0; f < from.tile_of_face.size(); ++f) {
    double& most = per_tile[from.tile_of_face[f]].surface_m;
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, distance[from.indices[3 * f + k]]);
  }
}

glm::vec3 place(const Tiled& tiled, std::uint32_t point) { return tiled.positions[tiled.weld.first_vertex[point]]; }

// Segments as triangles without area.
TriangleBvh chains_of(const Tiled& tiled) {
  std::vector<glm::vec3> positions;
  std::vector<VertexId> indices;
  for (const BorderEdge& edge : tiled.borders) {
    const VertexId a = static_cast<VertexId>(positions.size());
    positions.push_back(place(tiled, edge.a));
    positions.push_back(place(tiled, edge.b));
    indices.insert(indices.end(), {a, a + 1, a + 1});
  }
  return {positions, indices};
}

void raise_borders(std::vector<TileDeviation>& per_tile, const Tiled& from, const Tiled& to, const Context& context) {
  if (from.borders.empty() || to.borders.empty()) return;
  const std::vector<double> distance = distances(chains_of(to), 2 * from.borders.size(), context, [&](std::size_t i) {
    const BorderEdge& edge = from.borders[i / 2];
    return place(from, i % 2 == 0 ? edge.a : edge.b);
  });
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const BorderEdge& edge = from.borders[i / 2];
    for (const std::uint32_t tile : {edge.left, edge.right}) {
      per_tile[tile].border_m = std::max(per_tile[tile].border_m, distance[i]);
    }
  }
}

}  // namespace

std::vector<TileDeviation> Deviation::measure(const Tiled& source, const Tiled& level, std::uint32_t tiles,
                                              const Context& context) const {
  std::vector<TileDeviation> result(tiles);
  raise_surface(result, source, TriangleBvh{level.positions, level.indices}, context);
  raise_surface(result, level, source_, context);
  raise_borders(result, source, level, context);
  raise_borders(result, level, source, context);
  return result;
}

}  // namespace lodestone::outcrop
