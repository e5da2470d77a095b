// SPDX-License-Identifier: MIT
// Terrain made by a formula, and pyramids of it that several tests look at.
#pragma once

#include <lodestone/terrain.h>

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "base/hash.h"
#include "terrain/chains.h"
#include "terrain/lattice.h"

namespace lodestone::test {

class FormulaHeights : public HeightSource {
 public:
  using Formula = std::function<double(double longitude_deg, double latitude_deg)>;
  FormulaHeights(Formula formula, GeoBox box, std::uint32_t zoom)
      : formula_{std::move(formula)}, box_{box}, zoom_{zoom} {}

  [[nodiscard]] Status read(const PostWindow& window, std::span<float> heights_m) const override {
    std::size_t i = 0;
    const std::int64_t around = std::int64_t{512} << window.zoom;
    for (std::uint32_t y = 0; y < window.height; ++y) {
      for (std::uint32_t x = 0; x < window.width; ++x, ++i) {
        const std::int64_t column = ((window.column + x) % around + around) % around, row = window.row + y;
        double longitude = post_longitude_deg(window.zoom, column);
        const double latitude = post_latitude_deg(window.zoom, row);
        if (longitude < box_.west_deg) longitude += 360.0;
        const bool inside = longitude >= box_.west_deg && longitude <= box_.east_deg && latitude >= box_.south_deg &&
                            latitude <= box_.north_deg && row >= 0 && 2 * row <= around;
        heights_m[i] = inside ? static_cast<float>(formula_(longitude, latitude)) : NAN;
      }
    }
    return Done{};
  }
  [[nodiscard]] GeoBox bounds() const override { return box_; }
  [[nodiscard]] std::uint32_t native_zoom() const override { return zoom_; }

 private:
  Formula formula_;
  GeoBox box_;
  std::uint32_t zoom_;
};

// Mountains with ridges at every scale, periodic around the globe.
inline double ranges_m(double longitude_deg, double latitude_deg) {
  constexpr std::size_t octaves = 9;
  // Posts of a window have few longitudes and few latitudes: their waves are kept, or tests would spend their time
  // here.
  struct Waves {
    double at_deg = std::numeric_limits<double>::quiet_NaN();
    std::array<double, octaves> values{};
  };
  static thread_local std::array<Waves, 1024> east{}, north{};
  const auto waves = [](std::array<Waves, 1024> & kept, double at_deg, auto wave) -> const auto& {
    Waves& found = kept[mix64(std::bit_cast<std::uint64_t>(at_deg)) % kept.size()];
    if (found.at_deg != at_deg) {
      found.at_deg = at_deg;
      for (std::size_t octave = 0; octave < octaves; ++octave) {
        found.values[octave] =
            wave(3.0 * std::exp2(octave), static_cast<double>(octave), at_deg * 0.017453292519943295);
      }
    }
    return found.values;
  };
  const auto& a = waves(east, longitude_deg, [](double k, double shift, double x) { return std::sin(k * x + shift); });
  const auto& b = waves(north, latitude_deg,
                        [](double k, double shift, double y) { return std::cos((k + 1.0) * y + 2.0 * shift); });
  double height_m = 0.0, scale = 3000.0;
  for (std::size_t octave = 0; octave < octaves; ++octave, scale *= 0.55) {
    height_m += scale * (1.0 - 2.0 * std::fabs(a[octave] * b[octave]));
  }
  return height_m;
}

// The posts of a formula as one tile's lattice, metres by post.
inline terrain::TileLattice lattice_of(const std::function<double(int, int)>& height_m) {
  terrain::TileLattice lattice;
  for (int y = -1; y <= terrain::size + 1; ++y) {
    for (int x = -1; x <= terrain::size + 1; ++x) lattice.set(x, y, static_cast<float>(height_m(x, y)));
  }
  return lattice;
}

// The vertices of all four borders, as a tile without neighbours of other zooms has them.
inline std::vector<terrain::Tin::Vertex> all_borders(const terrain::TileLattice& lattice, double tolerance_m) {
  std::vector<terrain::Tin::Vertex> vertices;
  for (const terrain::Side side : terrain::all_sides) {
    for (const auto& vertex : border_vertices(lattice, side, {tolerance_m, 0.25, 1})) vertices.push_back(vertex);
  }
  return vertices;
}

}  // namespace lodestone::test
