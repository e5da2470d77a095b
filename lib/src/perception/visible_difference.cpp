// SPDX-License-Identifier: MIT
// Based on: Daly 1993 (visible differences predictor: contrast sensitivity, luminance adaptation, masking by contrast,
// bands pooled by probability summation); Watson 1993 (masking exponent 0.7).
// Differs: bands are those of the undecimated B3-spline transform (Starck and Murtagh 1994), of all directions
// together, so that the map has the resolution of the picture; the sensitivity is equation 14 of Zhu et al. 2010.
#include "perception/visible_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "perception/luminance.h"

namespace lodestone::perception {
namespace {

constexpr int band_count = 5;
constexpr double weber_fraction = 0.02;  // of luminance
constexpr double display_gamma = 2.2;    // luminance over the values of a picture
constexpr float least_threshold = 1.5F;  // values; so that rounding to 8 bits never counts
constexpr float masking_exponent = 0.7F;

struct Plane {
  std::size_t width, height;
  std::vector<float> values;
};

Plane plane_of(const Image& image) {
  Plane plane{image.width, image.height, std::vector<float>(static_cast<std::size_t>(image.width) * image.height)};
  for (std::size_t i = 0; i < plane.values.size(); ++i) plane.values[i] = luminance(image, i);
  return plane;
}

// B3 spline with holes of `step`: 1 4 6 4 1, ends repeated. Rows are mixed whole, so that all loops run over
// neighbouring values.
Plane smoothed(const Plane& plane, std::size_t step) {
  const std::size_t width = plane.width;
  const std::size_t height = plane.height;
  const auto mix = [](float* out, const std::array<const float*, 5>& in, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      out[i] = 0.375F * in[2][i] + 0.25F * (in[1][i] + in[3][i]) + 0.0625F * (in[0][i] + in[4][i]);
    }
  };
  Plane across = plane;
  std::vector<float> padded(width + 4 * step);
  for (std::size_t y = 0; y < height; ++y) {
    const float* row = plane.values.data() + y * width;
    std::fill_n(padded.begin(), 2 * step, row[0]);
    std::copy_n(row, width, padded.begin() + static_cast<std::ptrdiff_t>(2 * step));
    std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(2 * step), 2 * step, row[width - 1]);
    const float* p = padded.data();
    mix(across.values.data() + y * width, {p, p + step, p + 2 * step, p + 3 * step, p + 4 * step}, width);
  }
  Plane out = plane;
  for (std::size_t y = 0; y < height; ++y) {
    const auto row = [&](std::size_t at) { return across.values.data() + std::min(at, height - 1) * width; };
    const auto before = [&](std::size_t by) { return row(y - std::min(y, by)); };
    mix(out.values.data() + y * width, {before(2 * step), before(step), row(y), row(y + step), row(y + 2 * step)},
        width);
  }
  return out;
}

// Adds the fourth power of one band's difference over its threshold at each pixel.
void add_band(std::vector<float>& sums, const std::vector<float>& a, const std::vector<float>& b,
              const std::vector<float>& around, float over_peak) {
  constexpr auto share = static_cast<float>(weber_fraction / display_gamma);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const float difference = std::abs(a[i] - b[i]);
    if (difference == 0.0F) continue;
    float threshold = over_peak * std::max(least_threshold, share * around[i]);
    const float mask = std::min(std::abs(a[i]), std::abs(b[i]));
    if (mask > threshold) threshold *= std::pow(mask / threshold, masking_exponent);
    const float ratio = difference / threshold;
    sums[i] += ratio * ratio * ratio * ratio;
  }
}

}  // namespace

std::vector<float> visible_difference(const Image& a, const Image& b, const VisionModel& vision) {
  Plane plane_a = plane_of(a);
  Plane plane_b = plane_of(b);
  std::vector<float> sums(plane_a.values.size(), 0.0F);
  std::vector<std::uint8_t> equal(sums.size());
  for (std::size_t i = 0; i < equal.size(); ++i) {
    equal[i] = std::abs(plane_a.values[i] - plane_b.values[i]) < least_threshold ? 1 : 0;
  }
  for (int band = 0; band < band_count; ++band) {
    Plane next_a = smoothed(plane_a, std::size_t{1} << band);
    Plane next_b = smoothed(plane_b, std::size_t{1} << band);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      plane_a.values[i] -= next_a.values[i];
      plane_b.values[i] -= next_b.values[i];
    }
    const double middle_cpd = vision.max_frequency_cpd() / (std::exp2(band) * std::numbers::sqrt2);
    const double over_peak =
        contrast_sensitivity(peak_frequency_cpd) / contrast_sensitivity(std::max(peak_frequency_cpd, middle_cpd));
    add_band(sums, plane_a.values, plane_b.values, next_a.values, static_cast<float>(over_peak));
    plane_a = std::move(next_a);
    plane_b = std::move(next_b);
  }
  // What is broader than all bands is masked by nothing.
  const std::vector<float> level(sums.size(), 0.0F);
  for (std::size_t i = 0; i < sums.size(); ++i) plane_b.values[i] -= plane_a.values[i];
  add_band(sums, plane_b.values, level, plane_a.values, 1.0F);
  // Broad bands reach beyond where the pictures differ; a pixel that is the same does not count.
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = equal[i] != 0 ? 0.0F : std::sqrt(std::sqrt(sums[i]));
  return sums;
}

}  // namespace lodestone::perception
