// SPDX-License-Identifier: MIT
// Based on: OGC 3D Tiles 1.1 (22-025r4) and 1.0 (18-053r2).
#include "tiles3d/tileset_json.h"

#include <nlohmann/json.hpp>

#include "output_file.h"
#include "tiles3d/place_on_globe.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;

// Centre and half axes. Floats in the payload and doubles here round differently, so a little is added.
Json box_json(const Box& box) {
  const glm::dvec3 c = box.center();
  const glm::dvec3 h = box.size() * 0.5 + 1e-6 * (1.0 + box.diagonal_m());
  return {c.x, c.y, c.z, h.x, 0.0, 0.0, 0.0, h.y, 0.0, 0.0, 0.0, h.z};
}

Transform plain_transform(const glm::dvec3& origin) {
  return {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, origin.x, origin.y, origin.z, 1.0};
}

}  // namespace

std::string tile_name(const OutcropPyramid& pyramid, std::uint32_t tile, TilesVersion version) {
  const std::uint32_t level = pyramid.tiles()[tile].level;
  std::uint32_t first = 0;
  for (std::uint32_t l = 0; l < level; ++l) first += pyramid.levels()[l].tiles;
  return "tiles/L" + std::to_string(level) + '_' + std::to_string(tile - first) +
         (version == TilesVersion::V11 ? ".glb" : ".b3dm");
}

Status write_tileset_json(const OutcropPyramid& pyramid, const std::filesystem::path& file, TilesVersion version,
                          const std::vector<Box>& contents, std::vector<Warning>& warnings) {
  // Children stand before their parents, so each is finished when its parent takes it.
  std::vector<Json> tiles(pyramid.tiles().size());
  std::vector<Box> boxes = contents;
  for (std::uint32_t i = 0; i < tiles.size(); ++i) {
    const OutcropTile& tile = pyramid.tiles()[i];
    for (const std::uint32_t child : tile.children) {
      boxes[i].add(boxes[child].min);
      boxes[i].add(boxes[child].max);
    }
    Json json{{"boundingVolume", {{"box", box_json(boxes[i])}}},
              {"geometricError", client_error_px * tile.error_m},
              {"content", {{"uri", tile_name(pyramid, i, version)}}}};
    for (const std::uint32_t child : tile.children) json["children"].push_back(std::move(tiles[child]));
    tiles[i] = std::move(json);
  }
  Json& root = tiles.back();
  root["refine"] = "REPLACE";
  Transform transform = plain_transform(pyramid.origin());
  if (!pyramid.crs().empty()) {
    const auto placed = place_on_globe(pyramid.origin(), pyramid.crs());
    if (placed) transform = *placed;
    if (!placed) warnings.push_back({placed.error().message + ", the origin is written as it is", file.string()});
  }
  root["transform"] = transform;
  // Below this error nothing at all would be drawn: it must not come before the outcrop is a few pixels large.
  const OutcropTile& top = pyramid.tiles().back();
  const double whole_m = std::max(boxes.back().diagonal_m(), 2.0 * top.error_m);
  Json asset{{"version", version == TilesVersion::V11 ? "1.1" : "1.0"}, {"generator", "Lodestone"}};
  if (!pyramid.crs().empty()) asset["extras"]["crs"] = pyramid.crs();
  asset["extras"]["origin"] = {pyramid.origin().x, pyramid.origin().y, pyramid.origin().z};
  // For check_tileset(): edges that may be open.
  for (const OutcropLevel& level : pyramid.levels()) asset["extras"]["openEdges"].push_back(level.open_edges);
  const Json tileset{
      {"asset", std::move(asset)}, {"geometricError", client_error_px * whole_m}, {"root", std::move(root)}};
  const std::string text = tileset.dump(1) + "\n";
  return write_whole_file(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace lodestone
