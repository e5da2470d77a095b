// SPDX-License-Identifier: MIT
/// \file
/// Terrain in and out: heights from raster files, pyramids as quantized-mesh or 3D Tiles.
///
///     auto source = lodestone::open_raster("srtm.tif", {});
///     auto pyramid = lodestone::TerrainPyramid::plan(**source, {.max_error_m = {5.0}});
///     auto summary = lodestone::write_terrain(*pyramid, "tiles", {});
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/result.h>
#include <lodestone/terrain.h>

namespace lodestone {

/// What becomes of samples that are marked as missing; decided before heights are scaled.
enum class Voids : std::uint8_t {
  Skip,         ///< left out: a hole with a clean rim
  Fill,         ///< RasterOptions::fill_m, outside the raster as well
  Interpolate,  ///< from the nearest samples in eight directions, where they are within reach; else left out
};

struct RasterOptions {
  Voids voids = Voids::Skip;
  double fill_m = 0.0;                   ///< metres, after scaling
  std::uint32_t interpolate_reach = 64;  ///< samples
  double scale = 1.0;                    ///< height = sample in metres * scale + offset_m
  double offset_m = 0.0;         ///< for instance the geoid's height, if clients want heights above the ellipsoid
  std::optional<double> nodata;  ///< instead of what the file says
};

/// Opens a grid of heights: GeoTIFF, HGT, netCDF, ASCII grid, VRT and more, in any coordinate system (reprojected on
/// reading; none: degrees, with a warning). Read by window: memory does not grow with the file. Posts are interpolated
/// linearly between sample centres; a raster that spans 360 degrees is closed around the globe. Samples are unpacked by
/// the file's own scale and offset and converted from feet where it says so; any other unit than metres is a warning.
/// Errors: NotFound, BadData, Unsupported.
[[nodiscard]] Result<std::unique_ptr<HeightSource>> open_raster(const std::filesystem::path& file,
                                                                const RasterOptions& options);

/// Tiles below one tile that exist, by zoom: x and y ranges, both ends included.
struct TileRange {
  std::uint32_t start_x = 0;
  std::uint32_t start_y = 0;
  std::uint32_t end_x = 0;
  std::uint32_t end_y = 0;
  friend bool operator==(const TileRange&, const TileRange&) = default;
};
/// The tiles of a zoom as few rectangles that hold no other tile.
[[nodiscard]] std::vector<TileRange> available_ranges(const std::vector<TileInfo>& tiles);

/// The bytes of a quantized-mesh 1.0 tile, not compressed; with normals, water mask if the tile has one, and metadata
/// if `available` (first element: the zoom below the tile) is not empty. Precondition: vertices in the order of their
/// first use, as TerrainPyramid::build() gives them.
[[nodiscard]] std::vector<std::uint8_t> encode_quantized_mesh(const TerrainTile& tile,
                                                              std::span<const std::vector<TileRange>> available = {});

/// A quantized-mesh tile as it is in the file.
struct QuantizedMesh {
  glm::dvec3 center_m{0.0};
  float min_height_m = 0.0F;
  float max_height_m = 0.0F;
  Sphere bounds;
  glm::dvec3 horizon_occlusion_point{0.0};
  std::vector<std::uint16_t> u, v, height;
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> west, south, east, north;
  std::vector<glm::vec3> normals;   ///< empty if there is no such extension
  std::vector<std::uint8_t> water;  ///< empty, 1 or 65,536 bytes
  std::vector<std::vector<TileRange>> available;

  [[nodiscard]] double height_m(std::uint32_t vertex) const noexcept {
    return min_height_m + (static_cast<double>(max_height_m) - min_height_m) * height[vertex] / quantized_max;
  }
};
/// Reads a tile, compressed by gzip or not. Errors: BadData with the place in the file.
[[nodiscard]] Result<QuantizedMesh> decode_quantized_mesh(std::span<const std::uint8_t> bytes);

enum class TerrainFormat : std::uint8_t {
  QuantizedMesh,  ///< z/x/y.terrain (gzip) and layer.json, for CesiumJS and others
  Tiles3d,        ///< z/x/y.glb and tileset.json (3D Tiles 1.1), for viewers without quantized-mesh
};

struct WriteTerrainOptions {
  TerrainFormat format = TerrainFormat::QuantizedMesh;
  /// Go on where a run with the same input and options was ended; what it wrote is kept.
  bool resume = false;
  /// Tiles of every so many zooms list the tiles below them instead of layer.json; 0 = layer.json lists all.
  std::uint32_t metadata_zooms = 0;
  /// Shown by clients: whose data it is.
  std::string attribution;
  /// Measures every tile by tile_hausdorff_m(); about 0.2 s each.
  bool measure_hausdorff = false;
};

/// Two-sided Hausdorff distance in space (earth-centred) between a tile and the surface through all its posts: from all
/// vertices and a thousand random points of each to the nearest point of the other. 0 for a tile without data. Errors
/// of the source only.
[[nodiscard]] Result<double> tile_hausdorff_m(const TerrainPyramid& pyramid, const TerrainTile& tile);

/// What was written, by zoom.
struct TerrainZoomSummary {
  std::uint32_t zoom = 0;
  std::uint64_t tiles = 0;
  double mean_vertices = 0.0;
  double mean_triangles = 0.0;
  double tolerance_m = 0.0;
  double max_error_m = 0.0;  ///< measured
  /// Mean over tiles of their largest errors in height: no post is farther from its tile, so it is above the mean of
  /// their one-sided Hausdorff distances.
  double mean_error_m = 0.0;
  /// Mean over tiles with data of tile_hausdorff_m(), and the largest; below 0: not measured.
  double mean_hausdorff_m = -1.0;
  double max_hausdorff_m = -1.0;
  double gap_bound_m = 0.0;  ///< no border of this zoom is farther than this from the same border one zoom above
};
struct TerrainSummary {
  std::vector<TerrainZoomSummary> zooms;
  std::uint64_t tiles = 0;
  std::uint64_t bytes = 0;
  std::uint64_t kept_tiles = 0;  ///< that were there already
  std::uint64_t cracks = 0;  ///< borders between neighbours of a zoom that are not the same; 0, or something is wrong
};

/// Writes all tiles and the file that lists them, on Context::max_workers threads, and `lodestone-terrain.txt`, by
/// which a run can be resumed. The bytes depend on the posts and the options only. Errors: BadArgument if the folder
/// holds something else, Unreadable if it cannot be written.
[[nodiscard]] Result<TerrainSummary> write_terrain(const TerrainPyramid& pyramid, const std::filesystem::path& folder,
                                                   const WriteTerrainOptions& options, const Context& context = {});

}  // namespace lodestone
