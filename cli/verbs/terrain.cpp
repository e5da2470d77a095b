// SPDX-License-Identifier: MIT
#include <lodestone/terrain_files.h>

#include <chrono>
#include <limits>

#include "verbs.h"

namespace lodestone::cli {
namespace {

constexpr double quiet_nan = std::numeric_limits<double>::quiet_NaN();

class Terrain final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "terrain"; }
  [[nodiscard]] std::string summary() const override {
    return "Make a pyramid of terrain tiles of a raster of heights";
  }
  [[nodiscard]] std::string example() const override { return "lodestone terrain heights.tif -o tiles --max-error 5m"; }
  void declare(Arguments& arguments) override;
  [[nodiscard]] Status run(Session& session) override;

 private:
  [[nodiscard]] Result<RasterOptions> raster_options() const;
  [[nodiscard]] Result<TerrainOptions> terrain_options() const;
  void report(Session& session, const TerrainSummary& summary, double seconds) const;

  std::filesystem::path raster_;
  std::filesystem::path output_;
  std::string format_ = "quantized-mesh";
  std::string method_ = "greedy";
  std::optional<std::string> max_error_;
  std::optional<std::uint32_t> max_zoom_;
  std::uint32_t edges_ = 0;
  std::string borders_ = "nested";
  std::optional<std::uint32_t> shared_from_;
  double keep_ratio_ = 0.05;
  std::uint32_t cell_posts_ = 5;
  std::uint32_t cluster_posts_ = 50;
  std::string nodata_ = "skip";
  double fill_m_ = 0.0;
  double scale_ = 1.0;
  double offset_m_ = 0.0;
  std::optional<double> sea_level_m_;
  std::filesystem::path water_mask_;
  std::uint32_t metadata_zooms_ = 0;
  std::string attribution_;
  bool resume_ = false;
};

void Terrain::declare(Arguments& arguments) {
  arguments.file("RASTER", raster_, "Heights: GeoTIFF, HGT, netCDF, ASCII grid, VRT", Need::Required);
  arguments.file("-o,--output", output_, "Folder to write; empty, or with --resume one begun before", Need::Required);
  arguments.choice("--as", format_, {"quantized-mesh", "3dtiles"}, "What clients read");
  arguments.choice("--method", method_,
                   {"greedy", "edge-collapse", "points-random", "points-grid", "points-hierarchy", "points-wlop"},
                   "How tiles are simplified");
  arguments.text("--max-error", max_error_,
                 "Largest error in height at the finest zoom, doubled per zoom above; or one by zoom from 0 on: "
                 "80m,40m,20m (default: a sixteenth of the spacing of posts)");
  arguments.count("--target-edges", edges_, 0, none, "Edge collapse: edges of a tile; 0 = by --max-error");
  arguments.number("--keep", keep_ratio_, 1e-4, 1.0, "Random and WLOP points: share of the posts");
  arguments.count("--cell", cell_posts_, 1, tile_intervals, "Grid points: posts along the side of a cell");
  arguments.count("--cluster", cluster_posts_, 1, 65536, "Hierarchy points: most posts of a cluster");
  arguments.choice("--borders", borders_, {"nested", "shared"},
                   "shared: one line of vertices on all zooms, so that nothing opens between zooms");
  arguments.count("--shared-from", shared_from_, 0, max_terrain_zoom,
                  "Coarsest zoom with shared borders (default: six above the finest)");
  arguments.count("--max-zoom", max_zoom_, 0, max_terrain_zoom, "Finest zoom (default: as dense as the raster)");
  arguments.choice("--nodata", nodata_, {"skip", "fill", "interpolate"}, "What becomes of missing samples");
  arguments.number("--fill", fill_m_, -20000.0, 20000.0, "Height for --nodata fill, outside the raster as well");
  arguments.number("--scale", scale_, -1e6, 1e6, "Heights are samples times this");
  arguments.number("--offset", offset_m_, -1e6, 1e6, "plus this, for instance the height of the geoid");
  arguments.length_m("--sea-level", sea_level_m_, "Write a water mask: water is what lies at or below");
  arguments.file("--water-mask", water_mask_, "Write a water mask from a raster: 1 is water, 0 or missing is land",
                 Need::Optional);
  arguments.count("--metadata-zooms", metadata_zooms_, 0, max_terrain_zoom,
                  "Every so many zooms tiles list what is below them; 0 = layer.json lists all");
  arguments.word("--attribution", attribution_, "TEXT", "Shown by clients: whose data it is");
  arguments.flag("--resume", resume_, "Go on where a run was ended");
}

Result<RasterOptions> Terrain::raster_options() const {
  RasterOptions options{.fill_m = fill_m_, .scale = scale_, .offset_m = offset_m_};
  if (nodata_ == "fill") options.voids = Voids::Fill;
  if (nodata_ == "interpolate") options.voids = Voids::Interpolate;
  return options;
}

Result<TerrainOptions> Terrain::terrain_options() const {
  TerrainOptions options;
  if (max_zoom_) options.max_zoom = *max_zoom_;
  constexpr std::pair<const char*, TerrainMethod> methods[] = {{"greedy", TerrainMethod::Greedy},
                                                               {"edge-collapse", TerrainMethod::EdgeCollapse},
                                                               {"points-random", TerrainMethod::PointsRandom},
                                                               {"points-grid", TerrainMethod::PointsGrid},
                                                               {"points-hierarchy", TerrainMethod::PointsHierarchy},
                                                               {"points-wlop", TerrainMethod::PointsWlop}};
  for (const auto& [name, method] : methods) {
    if (method_ == name) options.method = method;
  }
  if (borders_ == "shared") options.borders = TerrainBorders::Shared;
  if (shared_from_) options.shared_from_zoom = *shared_from_;
  options.points.keep_ratio = {keep_ratio_};
  options.points.cell_posts = {cell_posts_};
  options.points.cluster_posts = {cluster_posts_};
  if (edges_ > 0) options.target_edges = {edges_};
  options.sea_level_m = sea_level_m_.value_or(quiet_nan);
  if (!max_error_) return options;
  for (std::size_t begin = 0; begin <= max_error_->size();) {
    const std::size_t end = std::min(max_error_->find(',', begin), max_error_->size());
    const auto length = parse_length_m(max_error_->substr(begin, end - begin));
    if (!length)
      return Error{ErrorCode::BadArgument, "--max-error takes lengths such as 5m or 80m,40m,20m", *max_error_};
    options.max_error_m.push_back(*length);
    begin = end + 1;
  }
  return options;
}

void Terrain::report(Session& session, const TerrainSummary& summary, double seconds) const {
  Report& report = session.report();
  report.set("method", method_);
  report.set("tiles", summary.tiles);
  report.set("kept_tiles", summary.kept_tiles);
  report.set("bytes", summary.bytes);
  report.set("cracks", summary.cracks);
  const auto built = static_cast<double>(summary.tiles - summary.kept_tiles);
  report.set("samples_per_second", built * tile_intervals * tile_intervals / seconds);
  std::string lines = "zoom    tiles  vertices  triangles  tolerance m  largest error m\n";
  for (const TerrainZoomSummary& zoom : summary.zooms) {
    Report row;
    row.set("zoom", zoom.zoom);
    row.set("tiles", zoom.tiles);
    row.set("mean_vertices", zoom.mean_vertices);
    row.set("mean_triangles", zoom.mean_triangles);
    row.set("tolerance_m", zoom.tolerance_m);
    row.set("max_error_m", zoom.max_error_m);
    row.set("mean_max_error_m", zoom.mean_error_m);
    row.set("mean_hausdorff_m", zoom.mean_error_m);  // from posts to triangles: no farther than the error in height
    row.set("gap_bound_m", zoom.gap_bound_m);
    report.add("zooms", row);
    char line[120];
    std::snprintf(line, sizeof line, "%4u %8llu %9.1f %10.1f %12.3f %16.3f\n", zoom.zoom,
                  static_cast<unsigned long long>(zoom.tiles), zoom.mean_vertices, zoom.mean_triangles,
                  zoom.tolerance_m, zoom.max_error_m);
    lines += line;
  }
  report.show(lines);
}

Status Terrain::run(Session& session) {
  const auto raster = raster_options();
  if (!raster) return raster.error();
  auto options = terrain_options();
  if (!options) return options.error();
  auto source = open_raster(raster_, *raster);
  session.keep(source);
  if (!source) return source.error();
  std::unique_ptr<HeightSource> water;
  if (!water_mask_.empty()) {
    auto mask = open_raster(water_mask_, {.voids = Voids::Fill});
    session.keep(mask);
    if (!mask) return mask.error();
    water = std::move(*mask);
    options->water = water.get();
  }
  const auto start = std::chrono::steady_clock::now();
  const auto pyramid = TerrainPyramid::plan(**source, *options, session.context());
  if (!pyramid) {
    Error error = pyramid.error();
    if (error.where.empty()) error.where = raster_.string();
    return error;
  }
  const WriteTerrainOptions writing{
      .format = format_ == "3dtiles" ? TerrainFormat::Tiles3d : TerrainFormat::QuantizedMesh,
      .resume = resume_,
      .metadata_zooms = metadata_zooms_,
      .attribution = attribution_};
  const auto summary = write_terrain(*pyramid, output_, writing, session.context());
  if (!summary) return or_resume(summary.error(), output_);
  report(session, *summary, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_terrain() { return std::make_unique<Terrain>(); }

}  // namespace lodestone::cli
