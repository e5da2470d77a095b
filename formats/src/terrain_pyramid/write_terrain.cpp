// SPDX-License-Identifier: MIT
#include <lodestone/terrain_files.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "output_file.h"
#include "quantized_mesh/gzip.h"
#include "terrain_pyramid/journal.h"
#include "terrain_pyramid/outputs.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Json to_json(const std::vector<TileRange>& ranges) {
  Json list = Json::array();
  for (const TileRange& range : ranges) {
    list.push_back(
        {{"startX", range.start_x}, {"startY", range.start_y}, {"endX", range.end_x}, {"endY", range.end_y}});
  }
  return list;
}

class TerrainWriter {
 public:
  TerrainWriter(const TerrainPyramid& pyramid, const fs::path& folder, const WriteTerrainOptions& options,
                const Context& context)
      : pyramid_{pyramid}, folder_{folder}, options_{options}, context_{context} {}

  [[nodiscard]] Result<TerrainSummary> write() {
    // Both formats in one folder would share a manifest.
    const std::uint64_t fingerprint = pyramid_.fingerprint() + 4 * options_.metadata_zooms +
                                      (options_.measure_hausdorff ? 2 : 0) +
                                      (options_.format == TerrainFormat::Tiles3d ? 1 : 0);
    if (Status status = journal_.open(folder_, fingerprint, options_.resume); !status) return status.error();
    if (options_.resume) remove_leftovers();
    const std::vector<TileId> missing = missing_tiles();
    const std::uint64_t kept = pyramid_.tile_count() - missing.size();
    for (std::uint32_t z = 0; z <= pyramid_.max_zoom(); ++z) ranges_.push_back(available_ranges(pyramid_.tiles(z)));
    const auto take = [this](const TerrainTile& tile) { return write_tile(tile); };
    if (Status status = pyramid_.build(missing, take, context_); !status) return status.error();
    const bool tileset = options_.format == TerrainFormat::Tiles3d;
    if (Status status = tileset ? write_tileset(pyramid_, folder_) : write_layer(); !status) return status.error();
    if (Status status = journal_.finish(); !status) return status.error();
    TerrainSummary summary = summarise();
    summary.kept_tiles = kept;
    return summary;
  }

 private:
  [[nodiscard]] fs::path file_of(const TileId& id) const {
    const char* ending = options_.format == TerrainFormat::Tiles3d ? ".glb" : ".terrain";
    return folder_ / std::to_string(id.zoom) / std::to_string(id.x) / (std::to_string(id.y) + ending);
  }

  // What a killed run was about to rename.
  void remove_leftovers() const {
    std::error_code fault;
    std::vector<fs::path> leftovers;
    for (auto entry = fs::recursive_directory_iterator{folder_, fault}; entry != fs::recursive_directory_iterator{};
         entry.increment(fault)) {
      if (entry->path().extension().string().rfind(".part", 0) == 0) leftovers.push_back(entry->path());
    }
    for (const fs::path& file : leftovers) fs::remove(file, fault);
  }

  [[nodiscard]] std::vector<TileId> missing_tiles() {
    std::vector<TileId> missing;
    for (const TileId& id : pyramid_.all_tiles()) {
      const auto record = journal_.records().find(TileJournal::key_of(id));
      std::error_code fault;
      if (record != journal_.records().end() && fs::file_size(file_of(id), fault) == record->second.bytes) continue;
      journal_.forget(id);
      missing.push_back(id);
    }
    return missing;
  }

  // Tiles below a tile, zoom by zoom, for its metadata.
  [[nodiscard]] std::vector<std::vector<TileRange>> below(const TileId& id) const {
    std::vector<std::vector<TileRange>> zooms;
    const std::uint32_t last = std::min(pyramid_.max_zoom(), id.zoom + options_.metadata_zooms);
    for (std::uint32_t z = id.zoom + 1; z <= last; ++z) {
      const std::uint32_t first_x = id.x << (z - id.zoom), first_y = id.y << (z - id.zoom),
                          more = (1U << (z - id.zoom)) - 1;
      auto& inside = zooms.emplace_back();
      for (const TileRange& range : ranges_[z]) {
        const TileRange part{std::max(range.start_x, first_x), std::max(range.start_y, first_y),
                             std::min(range.end_x, first_x + more), std::min(range.end_y, first_y + more)};
        if (part.start_x <= part.end_x && part.start_y <= part.end_y) inside.push_back(part);
      }
    }
    return zooms;
  }

  [[nodiscard]] Status write_tile(const TerrainTile& tile) {
    const fs::path file = file_of(tile.id);
    std::error_code fault;
    fs::create_directories(file.parent_path(), fault);
    if (fault)
      return Error{ErrorCode::Unreadable, "the folder cannot be made: " + fault.message(), file.parent_path().string()};
    std::uint64_t size = 0;
    if (options_.format == TerrainFormat::Tiles3d) {
      const double skirt_m = skirt_depth_m(pyramid_, tile.id.zoom);
      if (Status status = write_tile_glb(tile, skirt_m, file, {.cancel = context_.cancel}); !status) return status;
      size = fs::file_size(file, fault);
    } else {
      const bool lists = options_.metadata_zooms > 0 && tile.id.zoom % options_.metadata_zooms == 0;
      const auto bytes = to_gzip(lists ? encode_quantized_mesh(tile, below(tile.id)) : encode_quantized_mesh(tile));
      if (Status status = write_whole_file(file, bytes); !status) return status;
      size = bytes.size();
    }
    TileRecord record = record_of(tile, size);
    if (options_.measure_hausdorff && !tile.placeholder) {
      const auto distance_m = tile_hausdorff_m(pyramid_, tile);
      if (!distance_m) return distance_m.error();
      record.hausdorff_m = *distance_m;
    }
    return journal_.add(record);
  }

  [[nodiscard]] Status write_layer() const {
    double west_deg = 180.0, south_deg = 90.0, east_deg = -180.0, north_deg = -90.0;
    for (const TileInfo& tile : pyramid_.tiles(pyramid_.max_zoom())) {
      const GeoBox box = bounds_of({pyramid_.max_zoom(), tile.x, tile.y});
      west_deg = std::min(west_deg, box.west_deg);
      south_deg = std::min(south_deg, box.south_deg);
      east_deg = std::max(east_deg, box.east_deg);
      north_deg = std::max(north_deg, box.north_deg);
    }
    Json extensions{"octvertexnormals"};
    if (pyramid_.options().masks_water()) extensions.push_back("watermask");
    Json layer{{"tilejson", "2.1.0"},
               {"name", "terrain"},
               {"version", "1.0.0"},
               {"format", "quantized-mesh-1.0"},
               {"attribution", options_.attribution},
               {"scheme", "tms"},
               {"projection", "EPSG:4326"},
               {"tiles", {"{z}/{x}/{y}.terrain?v={version}"}},
               {"bounds", {west_deg, south_deg, east_deg, north_deg}},
               {"minzoom", 0},
               {"maxzoom", pyramid_.max_zoom()}};
    if (options_.metadata_zooms > 0) {
      extensions.push_back("metadata");
      layer["metadataAvailability"] = options_.metadata_zooms;
      layer["available"] = Json::array({to_json(ranges_[0])});
    } else {
      for (const auto& ranges : ranges_) layer["available"].push_back(to_json(ranges));
    }
    layer["extensions"] = std::move(extensions);
    const std::string text = layer.dump(1) + "\n";
    return write_whole_file(folder_ / "layer.json", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  [[nodiscard]] std::uint64_t cracks() const {
    const TileJournal::Records& records = journal_.records();
    std::uint64_t count = 0;
    const auto compare = [&](std::uint64_t mine, const TileId& other, std::size_t side) {
      const auto found = records.find(TileJournal::key_of(other));
      if (mine == 0 || found == records.end() || found->second.borders[side] == 0) return;
      if (mine != found->second.borders[side]) ++count;
    };
    for (const auto& [key, record] : records) {
      const TileId& id = record.id;
      compare(record.borders[2], {id.zoom, (id.x + 1) % (2U << id.zoom), id.y}, 0);
      compare(record.borders[3], {id.zoom, id.x, id.y + 1}, 1);
    }
    return count;
  }

  [[nodiscard]] TerrainSummary summarise() const {
    TerrainSummary summary;
    summary.zooms.resize(pyramid_.max_zoom() + 1);
    std::vector<double> detail_m(summary.zooms.size()), distance_m(summary.zooms.size());
    std::vector<std::uint32_t> measured(summary.zooms.size());
    for (const auto& [key, record] : journal_.records()) {
      TerrainZoomSummary& zoom = summary.zooms[record.id.zoom];
      ++zoom.tiles;
      zoom.mean_vertices += record.vertices;
      zoom.mean_triangles += record.triangles;
      zoom.mean_error_m += record.max_error_m;
      zoom.max_error_m = std::max(zoom.max_error_m, record.max_error_m);
      detail_m[record.id.zoom] = std::max(detail_m[record.id.zoom], record.border_detail_m);
      if (record.hausdorff_m >= 0.0) {
        ++measured[record.id.zoom];
        distance_m[record.id.zoom] += record.hausdorff_m;
        zoom.max_hausdorff_m = std::max(zoom.max_hausdorff_m, record.hausdorff_m);
      }
      summary.bytes += record.bytes;
      ++summary.tiles;
    }
    for (std::uint32_t z = 0; z < summary.zooms.size(); ++z) {
      TerrainZoomSummary& zoom = summary.zooms[z];
      zoom.zoom = z;
      zoom.tolerance_m = pyramid_.tolerance_m(z);
      const auto tiles = static_cast<double>(zoom.tiles);
      for (double* mean : {&zoom.mean_vertices, &zoom.mean_triangles, &zoom.mean_error_m}) *mean /= tiles;
      if (measured[z] > 0) zoom.mean_hausdorff_m = distance_m[z] / measured[z];
      const bool shared = pyramid_.shares_borders_above(z) && detail_m[z] == 0.0 && detail_m[z - 1] == 0.0;
      if (z > 0 && !shared) {
        zoom.gap_bound_m = pyramid_.tolerance_m(z) + pyramid_.tolerance_m(z - 1) + detail_m[z] +
                           0.5 * (pyramid_.height_step_m(z) + pyramid_.height_step_m(z - 1));
      }
    }
    summary.cracks = cracks();
    return summary;
  }

  const TerrainPyramid& pyramid_;
  const fs::path& folder_;
  const WriteTerrainOptions& options_;
  const Context& context_;
  TileJournal journal_;
  std::vector<std::vector<TileRange>> ranges_;  // by zoom
};

}  // namespace

Result<TerrainSummary> write_terrain(const TerrainPyramid& pyramid, const fs::path& folder,
                                     const WriteTerrainOptions& options, const Context& context) {
  return TerrainWriter{pyramid, folder, options, context}.write();
}

}  // namespace lodestone
