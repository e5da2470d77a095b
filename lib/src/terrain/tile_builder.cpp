// SPDX-License-Identifier: MIT
#include "terrain/tile_builder.h"

#include <algorithm>
#include <cmath>

#include "base/hash.h"
#include "terrain/chains.h"
#include "terrain/edge_collapse.h"
#include "terrain/globe.h"
#include "terrain/point_set.h"
#include "terrain/shared_borders.h"

namespace lodestone {

using namespace terrain;

namespace {

template <class T>
T at_zoom(const std::vector<T>& values, std::uint32_t zoom) {
  return values[std::min<std::size_t>(zoom, values.size() - 1)];
}

}  // namespace

PostWindow TileBuilder::window() const {
  const std::int64_t column = std::int64_t{id_.x} * size, row = std::int64_t{id_.y} * size;
  return {id_.zoom, column - 1, row - 1, TileLattice::stride, TileLattice::stride};
}

Status TileBuilder::read_posts() {
  const std::int64_t row = std::int64_t{id_.y} * size;
  Status status = pyramid_.source_->read(window(), lattice_.heights());
  if (!status) return status;
  // A pole is one point: its posts have one height.
  const auto level_row = [&](int y, float height_m) {
    for (int x = -1; x <= size + 1; ++x) {
      if (lattice_.valid(x, y) && !std::isnan(height_m)) lattice_.set(x, y, height_m);
    }
  };
  if (row == 0) level_row(0, pyramid_.polar_height_m_[0]);
  if (row + size == std::int64_t{size} << id_.zoom) level_row(size, pyramid_.polar_height_m_[1]);
  return status;
}

// Chains are made of the posts as they are, so that neighbours agree on them whatever else happens to a tile.
Status TileBuilder::plan_borders() {
  const bool shared = pyramid_.shares_borders(id_.zoom);
  const ChainOptions options{zoom_.tolerance_m, zoom_.step_m, static_cast<int>(zoom_.divisions)};
  for (const Side side : all_sides) {
    std::vector<Tin::Vertex> vertices;
    if (shared) {
      auto line = shared_border(*pyramid_.source_, id_, side, pyramid_.shared_border_options());
      if (!line) return line.error();
      if (*line) vertices = std::move(**line);
    }
    if (vertices.empty()) {
      vertices = border_vertices(lattice_, side, options);
      detail_m_ = std::max({detail_m_, border_detail_m(lattice_, side), shared ? zoom_.step_m : 0.0});
    }
    border_.insert(border_.end(), vertices.begin(), vertices.end());
  }
  return Done{};
}

// A tile without a single cell of data gets height 0 where nothing is known, because clients cannot do without it.
void TileBuilder::fill_placeholder() {
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (lattice_.cell(x, y)) return;
    }
  }
  placeholder_ = true;
  std::vector<Post> more;
  const int spacing = size / static_cast<int>(zoom_.divisions);
  for (const Side side : all_sides) {
    for (int t = 0; t <= size; ++t) {
      const auto has_data = [&](int at) {
        const Post p = post_of(side, std::clamp(at, 0, size));
        return lattice_.valid(p.x, p.y);
      };
      // Steps between what is known and what is not.
      const bool step = has_data(t) != has_data(t - 1) || has_data(t) != has_data(t + 1);
      if (step || t % spacing == 0) more.push_back(post_of(side, t));
    }
  }
  for (float& height_m : lattice_.heights()) {
    if (std::isnan(height_m)) height_m = 0.0F;
  }
  for (const Post p : more) border_.push_back(border_vertex(lattice_, p, zoom_.step_m));
}

std::vector<Post> TileBuilder::fixed_posts() const {
  std::vector<Post> posts;
  if (!lattice_.complete()) posts = rim_posts(lattice_);
  const int spacing = size / static_cast<int>(zoom_.divisions);
  for (int y = spacing; y < size; y += spacing) {
    for (int x = spacing; x < size; x += spacing) {
      if (lattice_.valid(x, y)) posts.push_back({x, y});
    }
  }
  return posts;
}

MeasuredTin TileBuilder::make_tin() const {
  const std::vector<Post> inside = fixed_posts();
  const GreedyOptions greedy{.tolerance_m = zoom_.tolerance_m, .step_m = zoom_.step_m, .inside = inside};
  // What is put in place of nothing is flat and needs no points of its own.
  const TerrainMethod method = placeholder_ ? TerrainMethod::Greedy : pyramid_.options_.method;
  if (method == TerrainMethod::Greedy) return greedy_insertion(lattice_, border_, greedy);
  return is_point_set(method) ? point_set(inside) : collapsed(greedy);
}

MeasuredTin TileBuilder::point_set(const std::vector<Post>& inside) const {
  const PointSetOptions& options = pyramid_.options_.points;
  PointSetTask task{.method = pyramid_.options_.method,
                    .feature_angle_rad = options.feature_angle_rad,
                    .feature_edges = options.feature_edges,
                    .tolerance_m = zoom_.tolerance_m,
                    .step_m = zoom_.step_m,
                    .inside = inside};
  task.samples = {.keep_ratio = at_zoom(options.keep_ratio, id_.zoom),
                  .cell_posts = static_cast<int>(at_zoom(options.cell_posts, id_.zoom)),
                  .cluster_posts = at_zoom(options.cluster_posts, id_.zoom),
                  .surface_variation = at_zoom(options.surface_variation, id_.zoom),
                  .iterations = static_cast<int>(options.iterations),
                  .spacing_m = post_spacing_m(id_),
                  .seed = hash_combine(hash_combine(id_.zoom, id_.x), id_.y)};
  task.samples.radius_posts =
      options.radius_posts > 0.0 ? options.radius_posts : 2.0 / std::sqrt(task.samples.keep_ratio);
  return point_set_tin(lattice_, border_, task);
}

// Begins with a TIN that is finer than asked: what it has too many of, collapsing removes from the best places.
MeasuredTin TileBuilder::collapsed(GreedyOptions greedy) const {
  const TerrainOptions& options = pyramid_.options_;
  constexpr double finer_by_error = 0.9, finer_by_count = 0.125;
  greedy.tolerance_m *= zoom_.target_edges == 0 ? finer_by_error : finer_by_count;
  const MeasuredTin fine = greedy_insertion(lattice_, border_, greedy);
  const double limit_m = zoom_.tolerance_m + 0.5 * zoom_.step_m;
  MeasuredTin made;
  made.tin = collapse_edges(fine.tin, lattice_,
                            {.limit_m = limit_m,
                             .target_edges = zoom_.target_edges,
                             .step_m = zoom_.step_m,
                             .volume_weight = options.volume_weight,
                             .shape_weight = options.shape_weight,
                             .fixed = greedy.inside});
  made.error = measure(made.tin, lattice_, limit_m);
  return made;
}

// The smallest power of two that spans the tile, no finer than what a client's 32-bit floats tell apart. Heights are
// multiples of the zoom's step, which is no smaller.
void TileBuilder::put_vertices(const Tin& tin, TerrainTile& tile) const {
  double low_m = tin.vertices.front().height_m, high_m = low_m;
  for (const Tin::Vertex& vertex : tin.vertices) {
    low_m = std::min(low_m, vertex.height_m);
    high_m = std::max(high_m, vertex.height_m);
  }
  constexpr double float_range = 1 << 23;
  const double least_m = std::max((high_m - low_m) / quantized_max, (std::fabs(low_m) + high_m - low_m) / float_range);
  tile.min_height_m = low_m;
  tile.step_m = least_m > 0.0 ? std::min(zoom_.step_m, std::exp2(std::ceil(std::log2(least_m)))) : zoom_.step_m;
  const Normals normals{id_};
  for (const Tin::Vertex& vertex : tin.vertices) {
    tile.u.push_back(static_cast<std::uint16_t>(vertex.u));
    tile.v.push_back(static_cast<std::uint16_t>(vertex.v));
    tile.height.push_back(static_cast<std::uint16_t>((vertex.height_m - low_m) / tile.step_m));
    tile.normals.push_back(normals.at(lattice_, vertex.u, vertex.v));
  }
  tile.triangles = tin.triangles;
}

void TileBuilder::put_borders(TerrainTile& tile) const {
  for (std::uint32_t i = 0; i < tile.vertex_count(); ++i) {
    if (tile.u[i] == 0) tile.west.push_back(i);
    if (tile.v[i] == 0) tile.south.push_back(i);
    if (tile.u[i] == quantized_max) tile.east.push_back(i);
    if (tile.v[i] == quantized_max) tile.north.push_back(i);
  }
  const auto by = [](const std::vector<std::uint16_t>& key) {
    return [&key](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; };
  };
  std::sort(tile.west.begin(), tile.west.end(), by(tile.v));
  std::sort(tile.east.begin(), tile.east.end(), by(tile.v));
  std::sort(tile.south.begin(), tile.south.end(), by(tile.u));
  std::sort(tile.north.begin(), tile.north.end(), by(tile.u));
}

Status TileBuilder::put_water(TerrainTile& tile) const {
  const TerrainOptions& options = pyramid_.options_;
  if (!options.masks_water()) return Done{};
  TileLattice given;
  if (options.water != nullptr) {
    if (Status status = options.water->read(window(), given.heights()); !status) return status;
  }
  const auto sum = [](const TileLattice& of, int x, int y) {
    return static_cast<double>(of.at(x, y)) + of.at(x + 1, y) + of.at(x, y + 1) + of.at(x + 1, y + 1);
  };
  // Land where there is no data: comparisons with NaN are false.
  const auto is_water = [&](int x, int y) {
    if (options.water == nullptr) return sum(lattice_, x, y) <= 4.0 * options.sea_level_m;
    return !placeholder_ && lattice_.cell(x, y) && sum(given, x, y) >= 2.0;
  };
  constexpr std::uint8_t land = 0, water = 255;
  std::vector<std::uint8_t> mask;
  mask.reserve(std::size_t{size} * size);
  for (int y = size - 1; y >= 0; --y) {
    for (int x = 0; x < size; ++x) mask.push_back(is_water(x, y) ? water : land);
  }
  const auto waters = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), water));
  if (waters == 0 || waters == mask.size()) mask.resize(1);
  tile.water = std::move(mask);
  return Done{};
}

Result<std::vector<float>> TileBuilder::posts() {
  if (Status status = read_posts(); !status) return status.error();
  std::vector<float> heights_m;
  heights_m.reserve(std::size_t{size + 1} * (size + 1));
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) heights_m.push_back(lattice_.at(x, y));
  }
  return heights_m;
}

Result<TerrainTile> TileBuilder::build() {
  Status status = read_posts();
  if (!status) return status.error();
  if (Status planned = plan_borders(); !planned) return planned.error();
  fill_placeholder();
  const MeasuredTin made = make_tin();
  TerrainTile tile;
  tile.id = id_;
  tile.max_error_m = made.error.max_m;
  tile.snap_m = zoom_.step_m;
  tile.border_detail_m = detail_m_;
  tile.placeholder = placeholder_;
  put_vertices(made.tin, tile);
  put_borders(tile);
  if (Status masked = put_water(tile); !masked) return masked.error();
  return tile;
}

}  // namespace lodestone
