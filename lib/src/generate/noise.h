// SPDX-License-Identifier: MIT
// Based on: Perlin 2002, "Improving noise" (gradient noise with the quintic fade); Musgrave's fractal sums.
// Differs: 32-bit lattice hash instead of a permutation table, so that it never repeats and needs no state.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace lodestone::generate {

[[nodiscard]] constexpr std::uint32_t lattice_hash(std::uint32_t seed, std::int32_t x, std::int32_t y) noexcept {
  std::uint32_t h = seed * 0x9e3779b1U + static_cast<std::uint32_t>(x) * 0x85ebca77U;
  h = (h ^ (h >> 15U)) * 0x2c1b3c6dU;
  h += static_cast<std::uint32_t>(y) * 0xc2b2ae3dU;
  h = (h ^ (h >> 12U)) * 0x297a2d39U;
  return h ^ (h >> 15U);
}

// Uniform in [0, 1), a pure function of its arguments.
[[nodiscard]] constexpr double lattice_unit(std::uint32_t seed, std::int32_t x, std::int32_t y = 0) noexcept {
  return static_cast<double>(lattice_hash(seed, x, y)) * 0x1p-32;
}

// 0 below `low`, 1 above `high`, smooth between.
[[nodiscard]] constexpr double smooth_step(double low, double high, double x) noexcept {
  const double t = x <= low ? 0.0 : (x >= high ? 1.0 : (x - low) / (high - low));
  return t * t * (3.0 - 2.0 * t);
}

[[nodiscard]] constexpr double mix(double a, double b, double t) noexcept { return a + (b - a) * t; }

// Gradient noise of wavelength 1, within about -1..1, mean 0.
[[nodiscard]] double noise(std::uint32_t seed, double x, double y) noexcept;

// Sum of octaves, each half the wavelength and `gain` times the amplitude of the last; within about -1..1.
[[nodiscard]] double fractal(std::uint32_t seed, double x, double y, int octaves, double gain = 0.5) noexcept;

// Sharp crests: 0..1, high along lines.
[[nodiscard]] double ridged(std::uint32_t seed, double x, double y, int octaves) noexcept;

// Angular lumps of diameter about 1: height 0..1 above the plane, as a heap of boulders.
[[nodiscard]] double boulders(std::uint32_t seed, double x, double y) noexcept;

// A periodic table of fractal noise for per-pixel work, where noise() itself would be too slow.
class NoiseTable {
 public:
  explicit NoiseTable(std::uint32_t seed);
  // Bilinear, period 1 in both directions, within -1..1.
  [[nodiscard]] float at(double x, double y) const noexcept;

 private:
  static constexpr std::uint32_t side = 512;
  std::vector<float> values_;
};

}  // namespace lodestone::generate
