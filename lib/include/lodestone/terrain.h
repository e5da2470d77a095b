// SPDX-License-Identifier: MIT
/// \file
/// A pyramid of triangulated (TIN) terrain tiles from gridded heights, for globes that show quantized-mesh or 3D Tiles.
///
///     auto pyramid = lodestone::TerrainPyramid::plan(source, {.max_error_m = {5.0}});
///     auto tile = pyramid->build({.zoom = 10, .x = 1473, .y = 682});
///
/// The globe is cut as TMS in EPSG:4326: zoom z has 2^(z+1) columns of tiles from 180 degrees west eastwards and 2^z
/// rows from the south pole northwards. A tile has 257 x 257 *posts* (samples), those on its borders shared with its
/// neighbours; a coarser zoom takes every second post.
///
/// What holds for every tile, whatever the method:
///   - it is a pure function of the posts and the options: any order, any number of workers, same bytes;
///   - neighbours have the same vertices on their common border, with heights equal to the bit, because each computes
///   the
///     border as a function of the border's own posts;
///   - `max_error_m` is not an estimate: every triangle, in the quantised place where a client will decode it, was
///     rasterised against every post. Greedy and EdgeCollapse by error: at most the tolerance plus half a height step.
///     Point sets and EdgeCollapse by count keep the tolerance on borders only.
///
/// Follows Campos, Quintana, Garcia, Schmitt, Spoelstra and Schaap 2020, "3D simplification methods and large scale
/// terrain tiling", with borders that need no schedule.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/lod_graph.h>
#include <lodestone/result.h>
#include <lodestone/types.h>

namespace lodestone {
namespace terrain {
struct SharedBorderOptions;
}

/// Posts along a tile's side, less one.
inline constexpr int tile_intervals = 256;
/// Finest zoom that is supported: posts 7 cm apart.
inline constexpr std::uint32_t max_terrain_zoom = 23;
/// Quantised places and heights run from 0 to this.
inline constexpr int quantized_max = 32767;

/// A tile of the globe; y counts from the south.
struct TileId {
  std::uint32_t zoom = 0;
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  friend bool operator==(const TileId&, const TileId&) = default;
};

/// A rectangle of the globe in degrees; east may exceed 180 where it crosses the antimeridian.
struct GeoBox {
  double west_deg = 0.0;
  double south_deg = 0.0;
  double east_deg = 0.0;
  double north_deg = 0.0;
};
[[nodiscard]] GeoBox bounds_of(const TileId& tile) noexcept;

/// Earth-centred, earth-fixed place (WGS 84) of a place above the ellipsoid.
[[nodiscard]] glm::dvec3 to_ecef_m(double longitude_rad, double latitude_rad, double height_m) noexcept;

/// A rectangle of posts of one zoom: column 0 at 180 degrees west (columns repeat around the globe), row 0 at the south
/// pole.
struct PostWindow {
  std::uint32_t zoom = 0;
  std::int64_t column = 0;
  std::int64_t row = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};
[[nodiscard]] double post_longitude_deg(std::uint32_t zoom, std::int64_t column) noexcept;
[[nodiscard]] double post_latitude_deg(std::uint32_t zoom, std::int64_t row) noexcept;

/// Where heights come from. A post's height is a function of its longitude and latitude only, so that post (i, j) of a
/// zoom equals post (2i, 2j) of the next.
class HeightSource {
 public:
  virtual ~HeightSource() = default;
  /// Fills in heights in metres, row by row from the south; NaN where there is no data and beyond the poles. Called
  /// from several threads at a time.
  [[nodiscard]] virtual Status read(const PostWindow& window, std::span<float> heights_m) const = 0;
  /// Everything outside is without data.
  [[nodiscard]] virtual GeoBox bounds() const = 0;
  /// The zoom whose posts are about as dense as the data.
  [[nodiscard]] virtual std::uint32_t native_zoom() const = 0;
};

enum class TerrainMethod {
  Greedy,        ///< Greedy insertion (Garland and Heckbert): fewest triangles for an error in height, fast.
  EdgeCollapse,  ///< Collapses a finer TIN (Lindstrom and Turk): fewer triangles still, slower.
  // Points that stand for all posts, whatever the error; sharp edges of the ground stay.
  PointsRandom,     ///< A share of the posts by chance.
  PointsGrid,       ///< One post by chance of each cell of a grid.
  PointsHierarchy,  ///< One post of each cluster; clusters are smaller where the ground bends (Pauly et al.).
  PointsWlop,       ///< Evenly spread, smooths (weighted locally optimal projection, Huang et al.).
};
[[nodiscard]] constexpr bool is_point_set(TerrainMethod method) noexcept {
  return method >= TerrainMethod::PointsRandom;
}

/// How points are chosen. Lists: by zoom, from zoom 0 on; the last value holds for finer zooms.
struct PointSetOptions {
  std::vector<double> keep_ratio{0.05};          ///< Random, Wlop: share of the posts
  std::vector<std::uint32_t> cell_posts{5};      ///< Grid: side of a cell
  std::vector<std::uint32_t> cluster_posts{50};  ///< Hierarchy: most posts of a cluster
  std::vector<double> surface_variation{0.001};  ///< Hierarchy: least spread as a share of all, at most; 0 to 1/3
  double radius_posts = 0.0;                     ///< Wlop: of the neighbourhood; 0 = twice the distance of points
  std::uint32_t iterations = 15;                 ///< Wlop
  /// Sharp edges are those whose triangles are turned by more against each other, in coordinates scaled to the unit
  /// cube, so many in a row at least. They are simplified to the tolerance of the zoom, as a distance in space.
  double feature_angle_rad = 1.0471975511965976;
  std::uint32_t feature_edges = 5;
};

/// How borders of unequal zooms meet.
enum class TerrainBorders {
  Nested,  ///< A zoom's border has the vertices of the zoom above and more: few vertices, a gap with a stated bound.
  Shared,  ///< One line of vertices on all zooms between two limits: no gap between these, more vertices.
};

struct TerrainOptions {
  TerrainMethod method = TerrainMethod::Greedy;
  /// Shared: the line is as fine as the finest of these zooms needs it, and all of them have one step of height, so
  /// that the tolerance holds as it does elsewhere. At most six zooms apart. Where data is missing along a border it is
  /// nested instead.
  TerrainBorders borders = TerrainBorders::Nested;
  std::uint32_t shared_from_zoom = none;  ///< none: as far up from shared_to_zoom as can be
  std::uint32_t shared_to_zoom = none;    ///< none: the finest zoom
  /// Greatest error in height by zoom, from zoom 0 on. One value: that of the finest zoom, doubled per zoom upwards.
  /// Empty: a sixteenth of the spacing of posts at the equator.
  std::vector<double> max_error_m;
  /// Finest zoom to build; `none` = the source's native zoom.
  std::uint32_t max_zoom = none;
  /// Fewest cells along a tile's side (power of two, at most 64) by zoom, so that a globe stays round; the last value
  /// holds for finer zooms. Empty: as many as keep the ellipsoid within the tolerance.
  std::vector<std::uint32_t> grid_divisions;

  /// EdgeCollapse: stop at so many edges a tile, as the paper does, by zoom (the last value holds for finer ones).
  /// Empty: stop by max_error_m.
  std::vector<std::uint32_t> target_edges;
  /// EdgeCollapse: weights of Lindstrom and Turk's cost, in coordinates scaled to the unit cube; defaults from the
  /// paper.
  double volume_weight = 0.5;
  double shape_weight = 1e-10;

  PointSetOptions points;

  /// Posts at or below this height are water (a mask is made), NaN: no mask.
  double sea_level_m = std::numeric_limits<double>::quiet_NaN();
  /// Instead of a sea level: reads 1 where there is water, 0 or NaN where there is none, and may read what lies
  /// between. Cells of a half and more are water; where there are no heights is land. Must outlive the pyramid.
  const HeightSource* water = nullptr;
  [[nodiscard]] bool masks_water() const noexcept { return water != nullptr || !std::isnan(sea_level_m); }
};

/// One tile: a TIN in quantised coordinates. u runs east, v north, both 0..32767 over the tile; the height of a vertex
/// is min_height_m + height * step_m, step_m a power of two.
struct TerrainTile {
  TileId id;
  double min_height_m = 0.0;
  double step_m = 1.0;
  std::vector<std::uint16_t> u;
  std::vector<std::uint16_t> v;
  std::vector<std::uint16_t> height;
  std::vector<glm::vec3> normals;        ///< ECEF, unit length, from the posts: equal across borders
  std::vector<std::uint32_t> triangles;  ///< 3 per triangle, counter-clockwise from above
  /// Vertices on the four borders that a triangle uses, west and east from the south, south and north from the west.
  std::vector<std::uint32_t> west, south, east, north;
  /// Empty, or one byte (all land 0, all water 255), or 256 x 256 of them from the north-west.
  std::vector<std::uint8_t> water;

  double max_error_m = 0.0;  ///< largest difference in height to a post, as decoded
  double snap_m = 0.0;       ///< heights of this zoom are multiples of it
  /// Along its borders, how far posts of this zoom stand off the zoom above; 0 where all are shared with it.
  double border_detail_m = 0.0;
  bool placeholder = false;  ///< without data of its own; there only to lead to finer tiles

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return static_cast<std::uint32_t>(u.size()); }
  [[nodiscard]] std::uint32_t triangle_count() const noexcept {
    return static_cast<std::uint32_t>(triangles.size() / 3);
  }
  [[nodiscard]] double height_m(std::uint32_t vertex) const noexcept {
    return min_height_m + step_m * static_cast<double>(height[vertex]);
  }
};
/// Earth-centred places of a tile's vertices, as a client decodes them.
[[nodiscard]] std::vector<glm::dvec3> ecef_positions_m(const TerrainTile& tile);

/// What is known of a tile before it is built.
struct TileInfo {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  float min_m = 0.0F;  ///< of the posts of the finest zoom inside
  float max_m = 0.0F;
  bool has_data = false;  ///< false: a root, or a tile without data that the tree needs
};

/// The plan of a pyramid: which tiles there are and what they have in common. Building a tile reads its 259 x 259 posts
/// and needs nothing else. Immutable; used from any number of threads. The source must outlive it.
class TerrainPyramid {
 public:
  /// Reads the finest zoom once. Errors: BadArgument for options out of range, BadData for a source without any data,
  /// whatever the source returns, Cancelled. O(posts) time, O(tiles) memory.
  [[nodiscard]] static Result<TerrainPyramid> plan(const HeightSource& source, const TerrainOptions& options,
                                                   const Context& context = {});

  [[nodiscard]] std::uint32_t max_zoom() const noexcept { return static_cast<std::uint32_t>(zooms_.size()) - 1; }
  /// By row, then column. Both tiles of zoom 0 are always there, and the parent of every tile.
  [[nodiscard]] const std::vector<TileInfo>& tiles(std::uint32_t zoom) const { return zooms_[zoom].tiles; }
  [[nodiscard]] std::uint64_t tile_count() const noexcept;
  [[nodiscard]] std::vector<TileId> all_tiles() const;  ///< zoom by zoom from 0
  [[nodiscard]] double tolerance_m(std::uint32_t zoom) const { return zooms_[zoom].tolerance_m; }
  [[nodiscard]] double height_step_m(std::uint32_t zoom) const { return zooms_[zoom].step_m; }
  /// Whether borders of this zoom are those of the zoom above, where there is data along them.
  [[nodiscard]] bool shares_borders_above(std::uint32_t zoom) const noexcept {
    return shares_borders(zoom) && zoom > shared_from_zoom_;
  }
  [[nodiscard]] const TerrainOptions& options() const noexcept { return options_; }
  /// Of all posts of the finest zoom and the options: tiles are the same where it is.
  [[nodiscard]] std::uint64_t fingerprint() const noexcept { return fingerprint_; }

  /// Precondition: the tile is one of tiles(). Errors of the source only.
  [[nodiscard]] Result<TerrainTile> build(const TileId& tile) const;
  /// Heights in metres of a tile's 257 x 257 posts, row by row from the south-west, as the tile is built from them; NaN
  /// where there is no data. Errors of the source only.
  [[nodiscard]] Result<std::vector<float>> posts(const TileId& tile) const;

  /// Builds tiles on several threads and hands each to `take` as it is done, on the thread that built it, in no
  /// particular order. Stops at the first error of the source or of `take`.
  [[nodiscard]] Status build(std::span<const TileId> tiles, const std::function<Status(const TerrainTile&)>& take,
                             const Context& context = {}) const;

 private:
  struct Zoom {
    std::vector<TileInfo> tiles;
    double tolerance_m = 0.0;
    double step_m = 1.0;
    std::uint32_t divisions = 1;
    std::uint32_t target_edges = 0;
  };
  TerrainPyramid() = default;
  [[nodiscard]] terrain::SharedBorderOptions shared_border_options() const;
  [[nodiscard]] bool shares_borders(std::uint32_t zoom) const noexcept {
    return shared_from_zoom_ != none && zoom >= shared_from_zoom_ && zoom <= shared_to_zoom_;
  }

  const HeightSource* source_ = nullptr;
  TerrainOptions options_;
  std::vector<Zoom> zooms_;
  std::uint64_t fingerprint_ = 0;
  std::uint32_t shared_from_zoom_ = none, shared_to_zoom_ = none;  // none: borders are nested
  float polar_height_m_[2] = {};                                   // south, north; NaN: no data there

  friend class TerrainPlanner;
  friend class TileBuilder;
};

/// A pyramid for select_cut(): a node is a tile, a group the up to four children of one. Places are earth-centred.
struct TerrainGraph {
  LodGraph graph;
  std::vector<TileId> tiles;  ///< per node
};
/// Errors of groups are the tolerances of zooms and half a step of height: against the posts of the zoom, so what lies
/// between these is not in them. `triangle_counts`: in the order of all_tiles(), or empty. O(tiles log tiles).
/// BadArgument for another number of counts.
[[nodiscard]] Result<TerrainGraph> terrain_graph(const TerrainPyramid& pyramid,
                                                 std::span<const std::uint32_t> triangle_counts = {});

}  // namespace lodestone
