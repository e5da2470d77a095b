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

// So many zooms are in one file: tileset.json begins with zoom 0, 4/x/y.json with a tile of zoom 4, and so on. A file
// lists 170 tiles and the files below them at most, whatever the pyramid's size.
constexpr std::uint32_t zooms_a_file = 4;

class TilesetWriter {
 public:
  TilesetWriter(const TerrainPyramid& pyramid, const std::filesystem::path& folder)
      : pyramid_{pyramid}, folder_{folder} {}

  [[nodiscard]] Status write() const {
    if (Status status = write(tileset(), "tileset.json"); !status) return status;
    for (std::uint32_t zoom = zooms_a_file; zoom <= pyramid_.max_zoom(); zoom += zooms_a_file) {
      for (const TileInfo& info : pyramid_.tiles(zoom)) {
        const TileId id{zoom, info.x, info.y};
        const Json root = tile(id, id);
        if (Status status = write(whole(root["geometricError"], root), name_of(id) + ".json"); !status) return status;
      }
    }
    return Done{};
  }

 private:
  [[nodiscard]] Status write(const Json& json, const std::string& name) const {
    const std::string text = json.dump() + "\n";
    return write_whole_file(folder_ / name, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  [[nodiscard]] static std::string name_of(const TileId& id) {
    return std::to_string(id.zoom) + '/' + std::to_string(id.x) + '/' + std::to_string(id.y);
  }
  [[nodiscard]] static Json whole(const Json& error, Json root) {
    root["refine"] = "REPLACE";
    return {{"asset", {{"version", "1.1"}, {"generator", "Lodestone"}}},
            {"geometricError", error},
            {"root", std::move(root)}};
  }

  [[nodiscard]] Json tileset() const {
    const double error_m = 4.0 * pyramid_.tolerance_m(0);
    Json root{{"boundingVolume", region({0, 0, 0}, 360.0)}, {"geometricError", error_m}};
    for (std::uint32_t x = 0; x < 2; ++x) root["children"].push_back(tile({0, x, 0}, {}));
    return whole(error_m, std::move(root));
  }

  [[nodiscard]] const TileInfo* find(const TileId& id) const {
    const std::vector<TileInfo>& tiles = pyramid_.tiles(id.zoom);
    const auto place = std::lower_bound(tiles.begin(), tiles.end(), id, [](const TileInfo& a, const TileId& b) {
      return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    return place != tiles.end() && place->x == id.x && place->y == id.y ? &*place : nullptr;
  }

  // The tile's own heights, the whole pyramid's above the two roots, with a margin that grows upwards: children are
  // then inside their parents whatever was rounded.
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

  // As the file says it that begins with `first`: tileset.json, or that of a tile of a finer zoom two folders down.
  [[nodiscard]] Json tile(const TileId& id, const TileId& first) const {
    const std::string up = first.zoom == 0 ? "" : "../../";
    const bool elsewhere = id.zoom % zooms_a_file == 0 && id.zoom > 0 && !(id == first);
    std::vector<TileId> children;
    for (std::uint32_t k = 0; k < 4 && id.zoom < pyramid_.max_zoom(); ++k) {
      const TileId child{id.zoom + 1, 2 * id.x + k % 2, 2 * id.y + k / 2};
      if (find(child) != nullptr) children.push_back(child);
    }
    Json json{{"boundingVolume", region(id, std::ldexp(180.0, -static_cast<int>(id.zoom)))},
              {"geometricError", children.empty() ? 0.0 : pyramid_.tolerance_m(id.zoom)},
              {"content", {{"uri", up + name_of(id) + (elsewhere ? ".json" : ".glb")}}}};
    if (elsewhere) return json;
    for (const TileId& child : children) json["children"].push_back(tile(child, first));
    return json;
  }

  const TerrainPyramid& pyramid_;
  const std::filesystem::path& folder_;
};

}  // namespace

Status write_tileset(const TerrainPyramid& pyramid, const std::filesystem::path& folder) {
  return TilesetWriter{pyramid, folder}.write();
}

}  // namespace lodestone
