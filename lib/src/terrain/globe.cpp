// SPDX-License-Identifier: MIT
// Places on the WGS 84 ellipsoid.
#include "terrain/globe.h"

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

constexpr double major_axis_m = 6378137.0;
constexpr double flattening = 1.0 / 298.257223563;
constexpr double eccentricity_2 = flattening * (2.0 - flattening);
constexpr double radians = std::numbers::pi / 180.0;

}  // namespace

// Products are exact and division is by a power of two, so that a post has the same place on every zoom.
double post_longitude_deg(std::uint32_t zoom, std::int64_t column) noexcept {
  return -180.0 + std::ldexp(180.0 * static_cast<double>(column), -static_cast<int>(zoom) - 8);
}

double post_latitude_deg(std::uint32_t zoom, std::int64_t row) noexcept {
  return -90.0 + std::ldexp(180.0 * static_cast<double>(row), -static_cast<int>(zoom) - 8);
}

GeoBox bounds_of(const TileId& tile) noexcept {
  const std::int64_t column = std::int64_t{tile.x} * tile_intervals, row = std::int64_t{tile.y} * tile_intervals;
  return {post_longitude_deg(tile.zoom, column), post_latitude_deg(tile.zoom, row),
          post_longitude_deg(tile.zoom, column + tile_intervals), post_latitude_deg(tile.zoom, row + tile_intervals)};
}

glm::dvec3 to_ecef_m(double longitude_rad, double latitude_rad, double height_m) noexcept {
  const double sine = std::sin(latitude_rad), cosine = std::cos(latitude_rad);
  const double across_m = major_axis_m / std::sqrt(1.0 - eccentricity_2 * sine * sine);
  return {(across_m + height_m) * cosine * std::cos(longitude_rad),
          (across_m + height_m) * cosine * std::sin(longitude_rad),
          (across_m * (1.0 - eccentricity_2) + height_m) * sine};
}

std::vector<glm::dvec3> ecef_positions_m(const TerrainTile& tile) {
  const GeoBox box = bounds_of(tile.id);
  std::vector<glm::dvec3> places;
  places.reserve(tile.u.size());
  for (std::uint32_t i = 0; i < tile.vertex_count(); ++i) {
    const double longitude_deg = std::lerp(box.west_deg, box.east_deg, static_cast<double>(tile.u[i]) / quantized_max);
    const double latitude_deg = std::lerp(box.south_deg, box.north_deg, static_cast<double>(tile.v[i]) / quantized_max);
    places.push_back(to_ecef_m(longitude_deg * radians, latitude_deg * radians, tile.height_m(i)));
  }
  return places;
}

namespace terrain {

glm::dvec2 post_spacing_m(const TileId& tile) noexcept {
  const GeoBox box = bounds_of(tile);
  const double latitude = 0.5 * (box.south_deg + box.north_deg) * radians;
  const double spacing_m = (box.north_deg - box.south_deg) * radians / tile_intervals * major_axis_m;
  return {spacing_m * std::cos(latitude), spacing_m};
}

Normals::Normals(const TileId& tile) : tile_{tile} {
  const std::int64_t around = std::int64_t{2 * tile_intervals} << tile.zoom;
  for (int i = 0; i <= size; ++i) {
    // The same column has the same number on both sides of the antimeridian.
    const std::int64_t column = (std::int64_t{tile.x} * tile_intervals + i) % around;
    const double longitude = post_longitude_deg(tile.zoom, column) * radians;
    east_[static_cast<std::size_t>(i)] = {std::cos(longitude), std::sin(longitude)};
    const double latitude = post_latitude_deg(tile.zoom, std::int64_t{tile.y} * tile_intervals + i) * radians;
    north_[static_cast<std::size_t>(i)] = {std::cos(latitude), std::sin(latitude)};
  }
}

glm::dvec3 Normals::at_post(const TileLattice& lattice, int x, int y) const {
  const auto [cos_lon, sin_lon] = east_[static_cast<std::size_t>(x)];
  const auto [cos_lat, sin_lat] = north_[static_cast<std::size_t>(y)];
  const std::int64_t row = std::int64_t{tile_.y} * tile_intervals + y;
  if (row == 0) return {0.0, 0.0, -1.0};
  if (row == std::int64_t{tile_intervals} << tile_.zoom) return {0.0, 0.0, 1.0};

  const double spacing = std::numbers::pi / (static_cast<double>(tile_intervals) * std::exp2(tile_.zoom));
  const double bent = 1.0 - eccentricity_2 * sin_lat * sin_lat;
  const double across_m = major_axis_m / std::sqrt(bent);
  const double along_m = across_m * (1.0 - eccentricity_2) / bent;
  // Rise per step of posts; one-sided beside posts without data.
  const auto rise = [&](float before, float here, float after) {
    const double low = std::isnan(before) ? here : before, high = std::isnan(after) ? here : after;
    const int steps = (std::isnan(before) ? 0 : 1) + (std::isnan(after) ? 0 : 1);
    return steps == 0 ? 0.0 : (high - low) / steps;
  };
  const float here = lattice.at(x, y);
  const double slope_east = rise(lattice.at(x - 1, y), here, lattice.at(x + 1, y)) / (across_m * cos_lat * spacing);
  const double slope_north = rise(lattice.at(x, y - 1), here, lattice.at(x, y + 1)) / (along_m * spacing);
  const glm::dvec3 east{-sin_lon, cos_lon, 0.0};
  const glm::dvec3 north{-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat};
  const glm::dvec3 up{cos_lat * cos_lon, cos_lat * sin_lon, sin_lat};
  return glm::normalize(up - slope_east * east - slope_north * north);
}

glm::vec3 Normals::at(const TileLattice& lattice, int u, int v) const {
  const double x = static_cast<double>(u) * size / quantized_max, y = static_cast<double>(v) * size / quantized_max;
  const int x0 = static_cast<int>(x + 0.5), y0 = static_cast<int>(y + 0.5);
  if (quantized(x0) == u && quantized(y0) == v) return at_post(lattice, x0, y0);
  const int left = std::min(static_cast<int>(x), size - 1), low = std::min(static_cast<int>(y), size - 1);
  glm::dvec3 sum{0.0};
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      if (!lattice.valid(left + dx, low + dy)) continue;
      const double weight = (dx == 0 ? 1.0 - (x - left) : x - left) * (dy == 0 ? 1.0 - (y - low) : y - low);
      sum += weight * at_post(lattice, left + dx, low + dy);
    }
  }
  return glm::normalize(sum);
}

}  // namespace terrain
}  // namespace lodestone
