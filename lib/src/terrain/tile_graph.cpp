// SPDX-License-Identifier: MIT
// A pyramid of tiles as the graph that all view-dependent detail is selected by.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <lodestone/terrain.h>

namespace lodestone {
namespace {

// Of a tile between two heights on the ellipsoid.
Sphere bounds_between(const TileId& id, double low_m, double high_m) {
  constexpr double radians = std::numbers::pi / 180.0;
  constexpr int cells = 8;
  const GeoBox box = bounds_of(id);
  const auto place_m = [&](double across, double along, double height_m) {
    return to_ecef_m(std::lerp(box.west_deg, box.east_deg, across) * radians,
                     std::lerp(box.south_deg, box.north_deg, along) * radians, height_m);
  };
  Sphere sphere;
  sphere.center = place_m(0.5, 0.5, 0.5 * (low_m + high_m));
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      for (const double height_m : {low_m, high_m}) {
        const glm::dvec3 at = place_m(static_cast<double>(i) / cells, static_cast<double>(j) / cells, height_m);
        sphere.radius_m = std::max(sphere.radius_m, glm::distance(at, sphere.center));
      }
    }
  }
  // How far the ground rises above the straight lines between the places looked at.
  const double cell_rad = (box.north_deg - box.south_deg) * radians / cells;
  constexpr double largest_radius_m = 6.4e6;
  sphere.radius_m += (largest_radius_m + high_m) * (1.0 - std::cos(cell_rad));
  return sphere;
}

}  // namespace

Result<TerrainGraph> terrain_graph(const TerrainPyramid& pyramid, std::span<const std::uint32_t> triangle_counts) {
  const std::vector<TileId> ids = pyramid.all_tiles();
  if (!triangle_counts.empty() && triangle_counts.size() != ids.size()) {
    return Error{ErrorCode::BadArgument, "there is one number of triangles per tile, or none", ""};
  }
  std::vector<NodeDraft> nodes;
  std::vector<GroupDraft> groups;
  std::vector<GroupId> group_of_parent(pyramid.tiles(0).size(), none), group_of_tile;
  for (std::uint32_t zoom = 0; zoom <= pyramid.max_zoom(); ++zoom) {
    const std::vector<TileInfo>& tiles = pyramid.tiles(zoom);
    group_of_tile.assign(tiles.size(), none);
    const double step_m = pyramid.height_step_m(zoom);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      const TileInfo& tile = tiles[i];
      const double slack_m = step_m + (static_cast<double>(tile.max_m) - tile.min_m) / 64.0;
      const double low_m = std::min(0.0, static_cast<double>(tile.min_m)) - slack_m;
      const double high_m = std::max(0.0, static_cast<double>(tile.max_m)) + slack_m;
      NodeDraft node{.bounds = bounds_between({zoom, tile.x, tile.y}, low_m, high_m), .group = group_of_parent[i]};
      if (!triangle_counts.empty()) node.triangle_count = triangle_counts[nodes.size()];
      nodes.push_back(node);
    }
    if (zoom == pyramid.max_zoom()) break;
    // Children are in the order of their rows, so their parents are looked for.
    const std::vector<TileInfo>& children = pyramid.tiles(zoom + 1);
    group_of_parent.assign(children.size(), none);
    const std::size_t first = nodes.size() - tiles.size();
    for (std::size_t k = 0; k < children.size(); ++k) {
      const auto parent = std::lower_bound(
          tiles.begin(), tiles.end(), children[k],
          [](const TileInfo& a, const TileInfo& b) { return a.y != b.y / 2 ? a.y < b.y / 2 : a.x < b.x / 2; });
      const auto i = static_cast<std::size_t>(parent - tiles.begin());
      if (group_of_tile[i] == none) {
        group_of_tile[i] = static_cast<GroupId>(groups.size());
        groups.push_back({nodes[first + i].bounds, pyramid.tolerance_m(zoom) + 0.5 * step_m});
        nodes[first + i].maker = group_of_tile[i];
      }
      group_of_parent[k] = group_of_tile[i];
    }
  }
  auto assembled = assemble_graph(groups, nodes);
  if (!assembled) return assembled.error();
  TerrainGraph made{std::move(assembled->graph), {}};
  for (const std::uint32_t draft : assembled->node_draft) made.tiles.push_back(ids[draft]);
  return made;
}

}  // namespace lodestone
