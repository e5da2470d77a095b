// SPDX-License-Identifier: MIT
#include <lodestone/terrain_files.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "verbs.h"

namespace lodestone::cli {
namespace {

constexpr double quiet_nan = std::numeric_limits<double>::quiet_NaN();

// Values by zoom from 0 on: "5" for all, "1,2,4" (the last holds for finer ones), "64/2" and "1x2": the value at zoom
// 0, halved or doubled per zoom within the range.
class ByZoom {
 public:
  ByZoom(std::string option, double least, double most, Result<double> (*parse)(const std::string&) = parse_number)
      : option_{std::move(option)}, least_{least}, most_{most}, parse_{parse} {}

  [[nodiscard]] std::optional<std::string>& text() noexcept { return text_; }

  // Leaves `values` as they are where the option was not given.
  template <class T>
  [[nodiscard]] Status read(std::vector<T>& values) const {
    if (!text_) return Done{};
    const auto given = numbers();
    if (!given) return given.error();
    values.clear();
    for (const double number : *given) {
      values.push_back(std::is_integral_v<T> ? static_cast<T>(std::floor(number + 0.5)) : static_cast<T>(number));
    }
    return Done{};
  }

 private:
  [[nodiscard]] Result<std::vector<double>> numbers() const {
    const std::string& text = *text_;
    const std::string ending = text.size() > 2 ? text.substr(text.size() - 2) : "";
    if (ending == "/2" || ending == "x2") {
      const auto root = one(text.substr(0, text.size() - 2));
      if (!root) return root.error();
      std::vector<double> values;
      for (std::uint32_t zoom = 0; zoom <= max_terrain_zoom; ++zoom) {
        const int power = static_cast<int>(zoom) * (ending == "/2" ? -1 : 1);
        values.push_back(std::clamp(std::ldexp(*root, power), least_, most_));
      }
      return values;
    }
    std::vector<double> values;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      const auto value = one(text.substr(begin, end - begin));
      if (!value) return value.error();
      values.push_back(*value);
      begin = end + 1;
    }
    return values;
  }
  [[nodiscard]] Result<double> one(const std::string& word) const {
    const auto value = parse_(word);
    if (value && *value >= least_ && *value <= most_) return *value;
    char range[64];
    std::snprintf(range, sizeof range, "%g to %g", least_, most_);
    return Error{ErrorCode::BadArgument,
                 option_ + " takes " + range +
                     ", one by zoom from 0 on (1,2,4), or that of zoom 0 halved (64/2) or doubled (1x2)",
                 *text_};
  }

  std::string option_;
  double least_;
  double most_;
  Result<double> (*parse_)(const std::string&);
  std::optional<std::string> text_;
};

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
  ByZoom max_error_m_{"--max-error", 1e-6, 1e6, parse_length_m};
  ByZoom grid_{"--grid", 1.0, 64.0};
  std::optional<std::uint32_t> max_zoom_;
  ByZoom edges_{"--target-edges", 0.0, 1e9};
  std::string borders_ = "nested";
  std::optional<std::uint32_t> shared_from_;
  ByZoom keep_ratio_{"--keep", 1e-4, 1.0};
  ByZoom cell_posts_{"--cell", 1.0, tile_intervals};
  ByZoom cluster_posts_{"--cluster", 1.0, 65536.0};
  ByZoom variation_{"--variation", 0.0, 1.0 / 3.0};
  std::string nodata_ = "skip";
  double fill_m_ = 0.0;
  double scale_ = 1.0;
  double offset_m_ = 0.0;
  std::optional<double> sea_level_m_;
  std::filesystem::path water_mask_;
  std::uint32_t metadata_zooms_ = 0;
  std::string attribution_;
  bool hausdorff_ = false;
  bool resume_ = false;
};

void Terrain::declare(Arguments& arguments) {
  arguments.file("RASTER", raster_, "Heights: GeoTIFF, HGT, netCDF, ASCII grid, VRT", Need::Required);
  arguments.file("-o,--output", output_, "Folder to write; empty, or with --resume one begun before", Need::Required);
  arguments.choice("--as", format_, {"quantized-mesh", "3dtiles"}, "What clients read");
  arguments.choice("--method", method_,
                   {"greedy", "edge-collapse", "points-random", "points-grid", "points-hierarchy", "points-wlop"},
                   "How tiles are simplified");
  arguments.text(
      "--max-error", max_error_m_.text(),
      "Largest error in height at the finest zoom, doubled per zoom above; or by zoom, as all options below: "
      "80m,40m,20m or 80m/2 (default: a sixteenth of the spacing of posts)");
  arguments.text("--grid", grid_.text(),
                 "Fewest cells along a tile's side, a power of two (default: as many as keep the globe round)");
  arguments.text("--target-edges", edges_.text(), "Edge collapse: edges of a tile; 0 = by --max-error (default)");
  arguments.text("--keep", keep_ratio_.text(), "Random and WLOP points: share of the posts (default 0.05)");
  arguments.text("--cell", cell_posts_.text(), "Grid points: posts along the side of a cell (default 5)");
  arguments.text("--cluster", cluster_posts_.text(), "Hierarchy points: most posts of a cluster (default 50)");
  arguments.text("--variation", variation_.text(),
                 "Hierarchy points: least spread of a cluster as a share of all, at most (default 0.001)");
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
  arguments.flag("--hausdorff", hausdorff_, "Measure how far tiles are from their posts in space; about 0.2 s a tile");
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
  for (const Status& status :
       {max_error_m_.read(options.max_error_m), grid_.read(options.grid_divisions), edges_.read(options.target_edges),
        keep_ratio_.read(options.points.keep_ratio), cell_posts_.read(options.points.cell_posts),
        cluster_posts_.read(options.points.cluster_posts), variation_.read(options.points.surface_variation)}) {
    if (!status) return status.error();
  }
  options.sea_level_m = sea_level_m_.value_or(quiet_nan);
  if (sea_level_m_ && !water_mask_.empty()) {
    return Error{ErrorCode::BadArgument, "water is masked by --sea-level or by --water-mask, not by both",
                 water_mask_.string()};
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
    // Null where it was not measured.
    row.set("mean_hausdorff_m", zoom.mean_hausdorff_m < 0.0 ? quiet_nan : zoom.mean_hausdorff_m);
    row.set("max_hausdorff_m", zoom.max_hausdorff_m < 0.0 ? quiet_nan : zoom.max_hausdorff_m);
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
      .attribution = attribution_,
      .measure_hausdorff = hausdorff_};
  const auto summary = write_terrain(*pyramid, output_, writing, session.context());
  if (!summary) return or_resume(summary.error(), output_);
  report(session, *summary, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_terrain() { return std::make_unique<Terrain>(); }

}  // namespace lodestone::cli
