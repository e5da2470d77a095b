// SPDX-License-Identifier: MIT
#include "generate/noise.h"

#include <algorithm>

namespace lodestone::generate {

namespace {

// Dot product of the offset with one of eight gradients.
double gradient(std::uint32_t hash, double x, double y) noexcept {
  const double a = (hash & 1U) != 0 ? x : y;
  const double b = (hash & 1U) != 0 ? y : x;
  const double main = (hash & 2U) != 0 ? a : -a;
  const double side = (hash & 4U) != 0 ? b : -b;
  return main + 0.5 * side;
}

double fade(double t) noexcept { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }

// Noise on a lattice that repeats after `period` cells.
double periodic_noise(std::uint32_t seed, double x, double y, std::int32_t period) noexcept {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::int32_t>(fx) % period;
  const auto iy = static_cast<std::int32_t>(fy) % period;
  const std::int32_t jx = (ix + 1) % period;
  const std::int32_t jy = (iy + 1) % period;
  const double dx = x - fx;
  const double dy = y - fy;
  const double low =
      mix(gradient(lattice_hash(seed, ix, iy), dx, dy), gradient(lattice_hash(seed, jx, iy), dx - 1, dy), fade(dx));
  const double high = mix(gradient(lattice_hash(seed, ix, jy), dx, dy - 1),
                          gradient(lattice_hash(seed, jx, jy), dx - 1, dy - 1), fade(dx));
  return mix(low, high, fade(dy));
}

}  // namespace

double noise(std::uint32_t seed, double x, double y) noexcept {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::int32_t>(fx);
  const auto iy = static_cast<std::int32_t>(fy);
  const double dx = x - fx;
  const double dy = y - fy;
  const double low =
      mix(gradient(lattice_hash(seed, ix, iy), dx, dy), gradient(lattice_hash(seed, ix + 1, iy), dx - 1, dy), fade(dx));
  const double high = mix(gradient(lattice_hash(seed, ix, iy + 1), dx, dy - 1),
                          gradient(lattice_hash(seed, ix + 1, iy + 1), dx - 1, dy - 1), fade(dx));
  return 1.2 * mix(low, high, fade(dy));
}

double fractal(std::uint32_t seed, double x, double y, int octaves, double gain) noexcept {
  double sum = 0.0;
  double amplitude = 1.0;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * noise(seed + static_cast<std::uint32_t>(i), x, y);
    amplitude *= gain;
    // Turned a little at each octave, so that the lattices do not line up.
    const double tx = 1.6 * x + 1.2 * y;
    y = -1.2 * x + 1.6 * y;
    x = tx;
  }
  return sum * (1.0 - gain) / (1.0 - amplitude) * 1.4;
}

double ridged(std::uint32_t seed, double x, double y, int octaves) noexcept {
  double sum = 0.0;
  double amplitude = 0.5;
  double weight = 1.0;
  for (int i = 0; i < octaves; ++i) {
    double crest = 1.0 - std::min(1.0, std::abs(noise(seed + static_cast<std::uint32_t>(i), x, y)));
    crest *= crest * weight;
    weight = std::clamp(crest * 1.5, 0.0, 1.0);
    sum += amplitude * crest;
    amplitude *= 0.5;
    const double tx = 1.6 * x + 1.2 * y;
    y = -1.2 * x + 1.6 * y;
    x = tx;
  }
  return std::min(1.0, sum);
}

double boulders(std::uint32_t seed, double x, double y) noexcept {
  const auto ix = static_cast<std::int32_t>(std::floor(x));
  const auto iy = static_cast<std::int32_t>(std::floor(y));
  double top = 0.0;
  for (std::int32_t cy = iy - 1; cy <= iy + 1; ++cy) {
    for (std::int32_t cx = ix - 1; cx <= ix + 1; ++cx) {
      const std::uint32_t h = lattice_hash(seed, cx, cy);
      const auto part = [h](unsigned shift) { return static_cast<double>((h >> shift) & 255U) / 255.0; };
      const double px = x - cx - 0.2 - 0.6 * part(0);
      const double py = y - cy - 0.2 - 0.6 * part(8);
      const double size = 0.25 + 0.5 * part(16);
      // A block with flat, tilted sides: the steepest of three slanted planes.
      const double turn = part(24) - 0.5;
      const double a = std::abs(px + turn * py);
      const double b = std::abs(py - turn * px);
      const double c = 0.75 * (a + b);
      const double rise = size - std::max({a, b, c});
      top = std::max(top, std::min(rise * 1.8, size * 0.55 + 0.25 * (px * turn + py * (part(4) - 0.5))));
    }
  }
  return top;
}

NoiseTable::NoiseTable(std::uint32_t seed) : values_(std::size_t{side} * side) {
  float largest = 0.0F;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      double sum = 0.0;
      double amplitude = 1.0;
      for (std::int32_t cells = 16; cells <= 256; cells *= 2) {
        const double scale = static_cast<double>(cells) / side;
        sum += amplitude *
               periodic_noise(seed + static_cast<std::uint32_t>(cells), (x + 0.37) * scale, (y + 0.37) * scale, cells);
        amplitude *= 0.62;
      }
      float& value = values_[std::size_t{y} * side + x];
      value = static_cast<float>(sum);
      largest = std::max(largest, std::abs(value));
    }
  }
  for (float& value : values_) value /= largest;
}

float NoiseTable::at(double x, double y) const noexcept {
  const double sx = (x - std::floor(x)) * side;
  const double sy = (y - std::floor(y)) * side;
  const auto ix = static_cast<std::uint32_t>(sx);
  const auto iy = static_cast<std::uint32_t>(sy);
  const auto fx = static_cast<float>(sx - ix);
  const auto fy = static_cast<float>(sy - iy);
  constexpr std::uint32_t mask = side - 1;
  const float* row = &values_[std::size_t{iy & mask} * side];
  const float* next = &values_[std::size_t{(iy + 1) & mask} * side];
  const std::uint32_t x0 = ix & mask;
  const std::uint32_t x1 = (ix + 1) & mask;
  const float low = row[x0] + (row[x1] - row[x0]) * fx;
  const float high = next[x0] + (next[x1] - next[x0]) * fx;
  return low + (high - low) * fy;
}

}  // namespace lodestone::generate
