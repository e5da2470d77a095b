// SPDX-License-Identifier: MIT
// Based on: Campos et al. 2020, section 5.2 (symmetric Hausdorff distance between a tile and its raster, earth-centred,
// by sampling).
#include <lodestone/metrics.h>
#include <lodestone/terrain_files.h>

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

constexpr std::uint32_t side = tile_intervals + 1;

// All posts, two triangles to a cell whose four have data.
Mesh mesh_of_posts(const TileId& id, const std::vector<float>& heights_m, const glm::dvec3& origin) {
  constexpr double radians = std::numbers::pi / 180.0;
  Mesh mesh;
  mesh.origin = origin;
  std::vector<VertexId> name(heights_m.size(), none);
  const auto vertex = [&](std::uint32_t post) {
    if (name[post] != none) return name[post];
    const double east = post_longitude_deg(id.zoom, std::int64_t{id.x} * tile_intervals + post % side) * radians;
    const double north = post_latitude_deg(id.zoom, std::int64_t{id.y} * tile_intervals + post / side) * radians;
    name[post] = mesh.vertex_count();
    mesh.vertices.positions.emplace_back(to_ecef_m(east, north, static_cast<double>(heights_m[post])) - origin);
    return name[post];
  };
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = y * side + x, b = a + 1, c = b + side, d = a + side;
      if (std::isnan(heights_m[a] + heights_m[b] + heights_m[c] + heights_m[d])) continue;
      for (const std::uint32_t post : {a, b, c, a, c, d}) mesh.indices.push_back(vertex(post));
    }
  }
  return mesh;
}

}  // namespace

Result<double> tile_hausdorff_m(const TerrainPyramid& pyramid, const TerrainTile& tile) {
  const auto heights_m = pyramid.posts(tile.id);
  if (!heights_m) return heights_m.error();
  const std::vector<glm::dvec3> places_m = ecef_positions_m(tile);
  Mesh tin;
  tin.origin = places_m.front();
  for (const glm::dvec3& place_m : places_m) tin.vertices.positions.emplace_back(place_m - tin.origin);
  tin.indices = tile.triangles;
  const Mesh posts = mesh_of_posts(tile.id, *heights_m, tin.origin);
  if (posts.indices.empty()) return 0.0;
  const auto distance = compare(posts, tin, {.samples = 1000}, {.max_workers = 1});
  if (!distance) return distance.error();
  return distance->hausdorff_m;
}

}  // namespace lodestone
