// SPDX-License-Identifier: MIT
// Based on: Campos et al. 2020, sections 4 (tiles and zooms), 4.4.3 (parameters by zoom), 4.4.4 (globes).
// Differs: no schedule. One pass over the finest zoom finds which tiles have data and how high they are; from then on a
// tile needs nothing but its own posts.
#include <lodestone/terrain.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "base/hash.h"
#include "base/parallel.h"
#include "terrain/shared_borders.h"
#include "terrain/ticks.h"
#include "terrain/tile_builder.h"

namespace lodestone {
namespace {

constexpr int size = tile_intervals;
constexpr double equator_radius_m = 6378137.0;

double post_spacing_m(std::uint32_t zoom) {
  return std::ldexp(std::numbers::pi * equator_radius_m / size, -static_cast<int>(zoom));
}

double power_of_two_up(double value) { return std::exp2(std::ceil(std::log2(value))); }
double power_of_two_down(double value) { return std::exp2(std::floor(std::log2(value))); }

bool before(const TileInfo& a, const TileInfo& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

Error bad(std::string message) { return {ErrorCode::BadArgument, std::move(message), ""}; }

}  // namespace

class TerrainPlanner {
 public:
  TerrainPlanner(const HeightSource& source, const TerrainOptions& options, const Context& context)
      : source_{source}, options_{options}, context_{context} {}

  [[nodiscard]] Result<TerrainPyramid> plan() {
    if (Status status = check(); !status) return status.error();
    TerrainPyramid pyramid;
    pyramid.source_ = &source_;
    pyramid.options_ = options_;
    pyramid.zooms_.resize(max_zoom_ + 1);
    if (Status status = scan_finest(pyramid.zooms_.back().tiles); !status) return status.error();
    for (std::uint32_t z = max_zoom_; z > 0; --z) gather_parents(pyramid.zooms_[z].tiles, pyramid.zooms_[z - 1].tiles);
    add_roots(pyramid.zooms_.front().tiles);
    if (Status status = read_poles(pyramid); !status) return status.error();
    if (Status status = choose_shared(pyramid); !status) return status.error();
    for (std::uint32_t z = 0; z <= max_zoom_; ++z) choose_numbers(z, pyramid);
    share_steps(pyramid);
    pyramid.fingerprint_ = fingerprint(pyramid);
    return pyramid;
  }

 private:
  [[nodiscard]] Status check() {
    max_zoom_ = options_.max_zoom == none ? source_.native_zoom() : options_.max_zoom;
    if (max_zoom_ > max_terrain_zoom) return bad("zooms go up to " + std::to_string(max_terrain_zoom));
    for (const double error_m : options_.max_error_m) {
      if (!(error_m > 0.0) || !std::isfinite(error_m)) return bad("the largest error must be above 0");
    }
    for (const std::uint32_t divisions : options_.grid_divisions) {
      if (!std::has_single_bit(divisions) || divisions > 64) return bad("grid divisions are 1, 2, 4, ... 64");
    }
    if (options_.water != nullptr && !std::isnan(options_.sea_level_m))
      return bad("water is masked by sea_level_m or by the source `water`, not by both");
    return check_points();
  }

  [[nodiscard]] Status check_points() const {
    const PointSetOptions& points = options_.points;
    const auto all = [](const auto& values, auto in_range) {
      return !values.empty() && std::all_of(values.begin(), values.end(), in_range);
    };
    if (!all(points.keep_ratio, [](double ratio) { return ratio > 0.0 && ratio <= 1.0; })) {
      return bad("the share of posts to keep is above 0 and at most 1");
    }
    if (!all(points.cell_posts, [](std::uint32_t posts) { return posts > 0 && posts <= size; })) {
      return bad("cells are 1 to 256 posts wide");
    }
    if (!all(points.cluster_posts, [](std::uint32_t posts) { return posts > 0; }) ||
        !all(points.surface_variation, [](double variation) { return variation >= 0.0; })) {
      return bad("clusters have a post at least and vary by 0 or more");
    }
    if (!(points.radius_posts >= 0.0 && points.radius_posts <= size) || !(points.feature_angle_rad > 0.0)) {
      return bad("the radius is 0 to 256 posts, the angle of sharp edges above 0");
    }
    return Done{};
  }

  // Tiles of the finest zoom that the source's bounds touch, each looked at once.
  [[nodiscard]] Status scan_finest(std::vector<TileInfo>& found) {
    const GeoBox box = source_.bounds();
    const double tile_deg = std::ldexp(180.0, -static_cast<int>(max_zoom_));
    const auto columns = static_cast<std::int64_t>(std::ldexp(2.0, static_cast<int>(max_zoom_)));
    const auto west = static_cast<std::int64_t>(std::floor((box.west_deg + 180.0) / tile_deg));
    const auto east = static_cast<std::int64_t>(std::ceil((box.east_deg + 180.0) / tile_deg));
    const auto south =
        std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((box.south_deg + 90.0) / tile_deg)));
    const auto north = std::min(columns / 2, static_cast<std::int64_t>(std::ceil((box.north_deg + 90.0) / tile_deg)));
    const std::int64_t width = std::min(east - west, columns);
    if (width <= 0 || north <= south) return Error{ErrorCode::BadData, "the source covers nothing", ""};
    constexpr std::int64_t most_tiles = 1 << 26;
    if (width > most_tiles / (north - south)) {
      return Error{ErrorCode::TooLarge, "more than 67 million tiles at zoom " + std::to_string(max_zoom_), ""};
    }
    const auto count = static_cast<std::size_t>(width * (north - south));
    std::vector<TileInfo> tiles(count);
    post_hashes_.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t x = west + static_cast<std::int64_t>(i) % width,
                         y = south + static_cast<std::int64_t>(i) / width;
      tiles[i].x = static_cast<std::uint32_t>((x % columns + columns) % columns);
      tiles[i].y = static_cast<std::uint32_t>(y);
    }
    std::vector<Status> statuses(count, Done{});
    std::atomic<std::size_t> done{0};
    parallel_for_each(count, 1, context_, [&](std::size_t i) {
      statuses[i] = scan(tiles[i], post_hashes_[i]);
      ticks_.tick(context_, "plan", static_cast<double>(++done) / static_cast<double>(count));
    });
    if (context_.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", ""};
    for (const Status& status : statuses) {
      if (!status) return status.error();
    }
    std::erase_if(tiles, [](const TileInfo& tile) { return !tile.has_data; });
    if (tiles.empty())
      return Error{ErrorCode::BadData, "there is no data in it: every sample is marked as missing", ""};
    std::sort(tiles.begin(), tiles.end(), before);
    found = std::move(tiles);
    return Done{};
  }

  [[nodiscard]] Status scan(TileInfo& tile, std::uint64_t& hash) const {
    constexpr std::size_t side = size + 1;
    std::vector<float> heights(side * side);
    const PostWindow window{max_zoom_, std::int64_t{tile.x} * size, std::int64_t{tile.y} * size, side, side};
    if (Status status = source_.read(window, heights); !status) return status;
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const float h = heights[i];
      hash = hash_combine(hash, std::isnan(h) ? none : coordinate_bits(h));
      if (h < low) low = h;
      if (h > high) high = h;
      if (i % side == size || i / side == size) continue;
      tile.has_data = tile.has_data || !std::isnan(h + heights[i + 1] + heights[i + side] + heights[i + side + 1]);
    }
    if (low <= high) tile.min_m = low, tile.max_m = high;
    if (options_.water == nullptr || !tile.has_data) return Done{};
    // Coarser tiles look at every second of these posts, so this is all that masks depend on.
    if (Status status = options_.water->read(window, heights); !status) return status;
    for (const float water : heights) hash = hash_combine(hash, std::isnan(water) ? none : coordinate_bits(water));
    return Done{};
  }

  static void merge(TileInfo& into, const TileInfo& tile) {
    into.min_m = std::min(into.min_m, tile.min_m);
    into.max_m = std::max(into.max_m, tile.max_m);
  }

  static void gather_parents(const std::vector<TileInfo>& tiles, std::vector<TileInfo>& parents) {
    for (TileInfo tile : tiles) {
      tile.x /= 2;
      tile.y /= 2;
      parents.push_back(tile);
    }
    std::sort(parents.begin(), parents.end(), before);
    std::size_t last = 0;
    for (std::size_t i = 1; i < parents.size(); ++i) {
      if (before(parents[last], parents[i])) {
        parents[++last] = parents[i];
      } else {
        merge(parents[last], parents[i]);
      }
    }
    parents.resize(last + 1);
  }

  static void add_roots(std::vector<TileInfo>& tiles) {
    for (std::uint32_t x = 0; x < 2; ++x) {
      const TileInfo root{.x = x};
      const auto place = std::lower_bound(tiles.begin(), tiles.end(), root, before);
      if (place == tiles.end() || place->x != x) tiles.insert(place, root);
    }
  }

  // The mean of the posts of zoom 0 that have data.
  [[nodiscard]] Status read_poles(TerrainPyramid& pyramid) const {
    for (int pole = 0; pole < 2; ++pole) {
      std::vector<float> row(2 * size);
      if (Status status = source_.read({0, 0, pole * size, 2 * size, 1}, row); !status) return status;
      double sum_m = 0.0;
      int count = 0;
      for (const float height_m : row) {
        if (std::isnan(height_m)) continue;
        sum_m += height_m;
        ++count;
      }
      pyramid.polar_height_m_[pole] =
          count == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(sum_m / count);
    }
    return Done{};
  }

  [[nodiscard]] double tolerance_m(std::uint32_t zoom) const {
    const std::vector<double>& errors_m = options_.max_error_m;
    if (errors_m.empty()) return post_spacing_m(zoom) / 16.0;
    if (errors_m.size() == 1) return std::ldexp(errors_m.front(), static_cast<int>(max_zoom_ - zoom));
    if (zoom < errors_m.size()) return errors_m[zoom];
    return std::ldexp(errors_m.back(), static_cast<int>(errors_m.size()) - 1 - static_cast<int>(zoom));
  }

  // As many as keep the ellipsoid within the tolerance between vertices; a zoom has at least half as many as the one
  // above, so that chains stay nested.
  [[nodiscard]] std::uint32_t divisions(std::uint32_t zoom, double tolerance_m) const {
    const std::vector<std::uint32_t>& given = options_.grid_divisions;
    if (!given.empty()) return given[std::min<std::size_t>(zoom, given.size() - 1)];
    const double chord_rad = std::sqrt(8.0 * tolerance_m / equator_radius_m);
    const double cells = std::ldexp(std::numbers::pi, -static_cast<int>(zoom)) / chord_rad;
    return static_cast<std::uint32_t>(std::clamp(power_of_two_up(cells), 1.0, 64.0));
  }

  void choose_numbers(std::uint32_t zoom, TerrainPyramid& pyramid) const {
    TerrainPyramid::Zoom& numbers = pyramid.zooms_[zoom];
    numbers.tolerance_m = tolerance_m(zoom);
    numbers.divisions = divisions(zoom, numbers.tolerance_m);
    double range_m = 0.0, farthest_m = 0.0;
    for (const TileInfo& tile : numbers.tiles) {
      const double low_m = std::min(0.0F, tile.min_m), high_m = std::max(0.0F, tile.max_m);
      range_m = std::max(range_m, static_cast<double>(tile.max_m) - tile.min_m);
      farthest_m = std::max(farthest_m, high_m - low_m);
    }
    // Above the finest zoom there may be tiles without data, which go down to 0.
    if (zoom < max_zoom_) range_m = farthest_m;
    // Vertices overshoot by up to 1/256 of a step between posts, and by rounding.
    constexpr double overshoot = 1.0 + 1.0 / 64.0, float_range = 1 << 22;
    const double least_m = std::max({range_m * overshoot / (quantized_max - 1), farthest_m / float_range, 0x1p-10});
    // What a shared border may be off by, the finest zoom that has it decides.
    const double finest_m = pyramid.shares_borders(zoom) ? tolerance_m(pyramid.shared_to_zoom_) : numbers.tolerance_m;
    numbers.step_m = std::max(power_of_two_up(least_m), power_of_two_down(finest_m / 32.0));
    const std::vector<std::uint32_t>& targets = options_.target_edges;
    numbers.target_edges = targets.empty() ? 0 : targets[std::min<std::size_t>(zoom, targets.size() - 1)];
  }

  [[nodiscard]] Status choose_shared(TerrainPyramid& pyramid) const {
    if (options_.borders == TerrainBorders::Nested) return Done{};
    const std::uint32_t to = options_.shared_to_zoom == none ? max_zoom_ : options_.shared_to_zoom;
    const std::uint32_t from =
        options_.shared_from_zoom == none ? to - std::min(to, terrain::most_shared_zooms) : options_.shared_from_zoom;
    if (from > to || to > max_zoom_ || to - from > terrain::most_shared_zooms) {
      return bad("borders are shared between two zooms of the pyramid that are at most " +
                 std::to_string(terrain::most_shared_zooms) + " apart");
    }
    pyramid.shared_from_zoom_ = from;
    pyramid.shared_to_zoom_ = to;
    return Done{};
  }

  // Zooms that share borders have one step of height.
  void share_steps(TerrainPyramid& pyramid) const {
    double step_m = 0.0;
    for (std::uint32_t z = 0; z <= max_zoom_; ++z) {
      if (pyramid.shares_borders(z)) step_m = std::max(step_m, pyramid.zooms_[z].step_m);
    }
    for (std::uint32_t z = 0; z <= max_zoom_; ++z) {
      if (pyramid.shares_borders(z)) pyramid.zooms_[z].step_m = step_m;
    }
  }

  [[nodiscard]] std::uint64_t fingerprint(const TerrainPyramid& pyramid) const {
    constexpr std::uint64_t version = 6;  // of the tiles that this code makes
    std::uint64_t hash = version;
    const auto add = [&](double number) { hash = hash_combine(hash, std::bit_cast<std::uint64_t>(number)); };
    for (const std::uint64_t posts : post_hashes_) hash = hash_combine(hash, posts);
    for (const TerrainPyramid::Zoom& zoom : pyramid.zooms_) {
      for (const TileInfo& tile : zoom.tiles) hash = hash_combine(hash, std::uint64_t{tile.x} << 32U | tile.y);
      add(zoom.tolerance_m);
      add(zoom.divisions);
      add(zoom.target_edges);
    }
    add(static_cast<double>(options_.method));
    const PointSetOptions& points = options_.points;
    const auto add_all = [&](const auto& values) {
      add(static_cast<double>(values.size()));
      for (const auto value : values) add(value);
    };
    add_all(points.keep_ratio);
    add_all(points.cell_posts);
    add_all(points.cluster_posts);
    add_all(points.surface_variation);
    for (const double number : {points.radius_posts, points.feature_angle_rad}) add(number);
    for (const std::uint32_t number : {points.iterations, points.feature_edges}) add(number);
    add(options_.volume_weight);
    add(pyramid.shared_from_zoom_);
    add(pyramid.shared_to_zoom_);
    add(options_.shape_weight);
    add(std::isnan(options_.sea_level_m) ? std::numeric_limits<double>::infinity() : options_.sea_level_m);
    add(options_.water == nullptr ? 0.0 : 1.0);
    return hash;
  }

  const HeightSource& source_;
  const TerrainOptions& options_;
  const Context& context_;
  std::vector<std::uint64_t> post_hashes_;  // per tile of the finest zoom
  terrain::ProgressTicks ticks_;
  std::uint32_t max_zoom_ = 0;
};

Result<TerrainPyramid> TerrainPyramid::plan(const HeightSource& source, const TerrainOptions& options,
                                            const Context& context) {
  return TerrainPlanner{source, options, context}.plan();
}

terrain::SharedBorderOptions TerrainPyramid::shared_border_options() const {
  const Zoom& finest = zooms_[shared_to_zoom_];
  return {.from_zoom = shared_from_zoom_,
          .to_zoom = shared_to_zoom_,
          .chain = {finest.tolerance_m, finest.step_m, static_cast<int>(finest.divisions)},
          .polar_height_m = {polar_height_m_[0], polar_height_m_[1]}};
}

std::uint64_t TerrainPyramid::tile_count() const noexcept {
  std::uint64_t count = 0;
  for (const Zoom& zoom : zooms_) count += zoom.tiles.size();
  return count;
}

std::vector<TileId> TerrainPyramid::all_tiles() const {
  std::vector<TileId> ids;
  ids.reserve(tile_count());
  for (std::uint32_t z = 0; z <= max_zoom(); ++z) {
    for (const TileInfo& tile : zooms_[z].tiles) ids.push_back({z, tile.x, tile.y});
  }
  return ids;
}

Result<TerrainTile> TerrainPyramid::build(const TileId& tile) const { return TileBuilder{*this, tile}.build(); }

Result<std::vector<float>> TerrainPyramid::posts(const TileId& tile) const { return TileBuilder{*this, tile}.posts(); }

Status TerrainPyramid::build(std::span<const TileId> tiles, const std::function<Status(const TerrainTile&)>& take,
                             const Context& context) const {
  std::vector<std::optional<Error>> errors(tiles.size());
  std::atomic<bool> failed{false};
  std::atomic<std::size_t> done{0};
  terrain::ProgressTicks ticks;
  parallel_for_each(tiles.size(), 1, context, [&](std::size_t i) {
    if (failed) return;
    const auto tile = build(tiles[i]);
    if (!tile) {
      errors[i] = tile.error();
    } else if (Status taken = take(*tile); !taken) {
      errors[i] = taken.error();
    }
    if (errors[i]) failed = true;
    ticks.tick(context, "tiles", static_cast<double>(++done) / static_cast<double>(tiles.size()));
  });
  for (const auto& error : errors) {
    if (error) return *error;
  }
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", ""};
  return Done{};
}

}  // namespace lodestone
