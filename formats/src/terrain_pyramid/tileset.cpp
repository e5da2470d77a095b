// SPDX-License-Identifier: MIT
// Based on: OGC 3D Tiles 1.1 (22-025r4), explicit tiling.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "output_file.h"
#include "terrain_pyramid/outputs.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;

class TilesetWriter {
 public:
  explicit TilesetWriter(const TerrainPyramid& pyramid) : pyramid_{pyramid} {}

  [[nodiscard]] Json tileset() const {
    Json root{{"boundingVolume", region({0, 0, 0}, 360.0)},
              {"geometricError", 4.0 * pyramid_.tolerance_m(0)},
              {"refine", "REPLACE"}};
    for (std::uint32_t x = 0; x < 2; ++x) root["children"].push_back(tile({0, x, 0}));
    return {{"asset", {{"version", "1.1"}, {"generator", "Lodestone"}}},
            {"geometricError", 4.0 * pyramid_.tolerance_m(0)},
            {"root", std::move(root)}};
  }

 private:
  [[nodiscard]] const TileInfo* find(const TileId& id) const {
    const std::vector<TileInfo>& tiles = pyramid_.tiles(id.zoom);
    const auto place = std::lower_bound(tiles.begin(), tiles.end(), id, [](const TileInfo& a, const TileId& b) {
      return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    return place != tiles.end() && place->x == id.x && place->y == id.y ? &*place : nullptr;
  }

  // Heights of the whole pyramid for every tile: children are then inside their parents whatever was rounded.
  [[nodiscard]] Json region(const TileId& id, double width_deg) const {
    constexpr double radians = std::numbers::pi / 180.0;
    const GeoBox box = bounds_of(id);
    double low_m = 0.0, high_m = 0.0;
    for (const TileInfo& tile : pyramid_.tiles(0)) {
      low_m = std::min(low_m, static_cast<double>(tile.min_m));
      high_m = std::max(high_m, static_cast<double>(tile.max_m));
    }
    if (const TileInfo* info = find(id); info != nullptr && info->has_data && width_deg < 180.0) {
      low_m = std::min(0.0, static_cast<double>(info->min_m));
      high_m = std::max(0.0, static_cast<double>(info->max_m));
    }
    const double slack_m = (high_m - low_m) / 64.0 + pyramid_.height_step_m(id.zoom);
    const double east_deg = width_deg >= 360.0 ? 180.0 : box.east_deg;
    return {{"region",
             {box.west_deg * radians, box.south_deg * radians, east_deg * radians, box.north_deg * radians,
              low_m - slack_m - skirt_depth_m(pyramid_, id.zoom), high_m + slack_m}}};
  }

  [[nodiscard]] Json tile(const TileId& id) const {
    const bool leaf = id.zoom == pyramid_.max_zoom();
    Json json{{"boundingVolume", region(id, std::ldexp(180.0, -static_cast<int>(id.zoom)))},
              {"geometricError", leaf ? 0.0 : pyramid_.tolerance_m(id.zoom)},
              {"content",
               {{"uri", std::to_string(id.zoom) + '/' + std::to_string(id.x) + '/' + std::to_string(id.y) + ".glb"}}}};
    if (leaf) return json;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const TileId child{id.zoom + 1, 2 * id.x + k % 2, 2 * id.y + k / 2};
      if (find(child) != nullptr) json["children"].push_back(tile(child));
    }
    if (!json.contains("children")) json["geometricError"] = 0.0;
    return json;
  }

  const TerrainPyramid& pyramid_;
};

}  // namespace

Status write_tileset(const TerrainPyramid& pyramid, const std::filesystem::path& folder) {
  const std::string text = TilesetWriter{pyramid}.tileset().dump() + "\n";
  return write_whole_file(folder / "tileset.json", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace lodestone
