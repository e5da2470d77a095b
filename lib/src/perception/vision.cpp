// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, section 3.2; Nadenau, Reichel and Kunt 2003 (contrast sensitivity as FIR filters on the
// wavelet bands).
// Differs: the filters are designed by frequency sampling, so that the response equals equation 14 at the sampled
// frequencies exactly; a band is filtered along the directions in which it is a high band.
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "perception/luminance.h"
#include "perception/wavelet.h"

namespace lodestone {
namespace {

constexpr double pi = std::numbers::pi;

// A high band has been sampled at half its rate: digital frequency w in [0, pi] there is the frequency
// top * (1 - w / (2 pi)) of the picture, `top` being the upper end of the band.
double band_frequency_cpd(double top_cpd, double w) { return top_cpd * (1.0 - w / (2.0 * pi)); }

double wanted_gain(double frequency_cpd) {
  if (frequency_cpd <= peak_frequency_cpd) return 1.0;
  return std::min(1.0, contrast_sensitivity(frequency_cpd) / contrast_sensitivity(peak_frequency_cpd));
}

}  // namespace

VisionModel::VisionModel(const Display& display) : max_frequency_cpd_(lodestone::max_frequency_cpd(display)) {
  constexpr int max_levels = 12;
  while (levels_ < max_levels && max_frequency_cpd_ / std::exp2(levels_) > peak_frequency_cpd) ++levels_;
  constexpr int samples = 2 * half_taps + 1;
  for (int level = 1; level <= levels_; ++level) {
    const double top_cpd = max_frequency_cpd_ / std::exp2(level - 1);
    Filter filter;
    for (int tap = 0; tap <= half_taps; ++tap) {
      double sum = wanted_gain(top_cpd);  // at w = 0
      for (int k = 1; k <= half_taps; ++k) {
        const double w = 2.0 * pi * k / samples;
        sum += 2.0 * wanted_gain(band_frequency_cpd(top_cpd, w)) * std::cos(w * tap);
      }
      filter.taps[static_cast<std::size_t>(tap)] = sum / samples;
    }
    filters_.push_back(filter);
  }
}

double VisionModel::gain(int level, double frequency_cpd) const noexcept {
  const double top_cpd = max_frequency_cpd_ / std::exp2(level - 1);
  const double w = 2.0 * pi * (1.0 - frequency_cpd / top_cpd);
  const Filter& filter = filters_[static_cast<std::size_t>(level - 1)];
  double sum = filter.taps[0];
  for (int tap = 1; tap <= half_taps; ++tap)
    sum += 2.0 * filter.taps[static_cast<std::size_t>(tap)] * std::cos(w * tap);
  return sum;
}

// Convolves the samples of a band with the filter along its rows or columns, mirrored at the ends. Columns are taken a
// cache line at a time, so that one loop over contiguous floats serves both directions.
void VisionModel::filter_band(std::vector<float>& plane, std::size_t stride, const Band& band, bool rows,
                              const Filter& filter) const {
  constexpr std::size_t columns_at_once = 16;
  constexpr auto reach = static_cast<std::size_t>(half_taps);
  const std::size_t count = rows ? band.width : band.height;
  const std::size_t lines = rows ? band.height : band.width;
  const std::size_t step = rows ? 1 : stride;
  if (count == 0) return;
  const auto period = static_cast<std::ptrdiff_t>(2 * count);
  std::vector<float> padded;
  std::vector<float> sums;
  for (std::size_t line = 0; line < lines; line += rows ? 1 : columns_at_once) {
    const std::size_t signals = rows ? 1 : std::min(columns_at_once, lines - line);
    float* first = plane.data() + (rows ? (band.y + line) * stride + band.x : band.y * stride + band.x + line);
    padded.resize((count + 2 * reach) * signals);
    for (std::size_t i = 0; i < count + 2 * reach; ++i) {
      auto at = ((static_cast<std::ptrdiff_t>(i) - half_taps) % period + period) % period;
      if (at >= static_cast<std::ptrdiff_t>(count)) at = period - 1 - at;
      std::copy_n(first + static_cast<std::size_t>(at) * step, signals, padded.data() + i * signals);
    }
    sums.assign(count * signals, 0.0F);
    const float* middle = padded.data() + reach * signals;
    for (std::size_t tap = 0; tap <= reach; ++tap) {
      const auto weight = static_cast<float>(tap == 0 ? 0.5 * filter.taps[0] : filter.taps[tap]);
      const float* before = middle - tap * signals;
      const float* after = middle + tap * signals;
      for (std::size_t j = 0; j < sums.size(); ++j) sums[j] += weight * (before[j] + after[j]);
    }
    for (std::size_t i = 0; i < count; ++i) std::copy_n(sums.data() + i * signals, signals, first + i * step);
  }
}

Result<Image> VisionModel::simulate(const Image& rendered) const {
  if (rendered.empty() || rendered.channels == 0) {
    return Error{ErrorCode::BadArgument, "there is no picture to look at", "vision model"};
  }
  const std::size_t width = rendered.width;
  const std::size_t height = rendered.height;
  std::vector<float> plane(width * height);
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = perception::luminance(rendered, i);
  std::vector<std::array<std::size_t, 2>> sizes{{width, height}};
  for (int level = 1; level <= levels_; ++level) {
    const auto [w, h] = sizes.back();
    perception::wavelet_forward(plane, width, w, h);
    const std::size_t lw = (w + 1) / 2;
    const std::size_t lh = (h + 1) / 2;
    const Filter& filter = filters_[static_cast<std::size_t>(level - 1)];
    filter_band(plane, width, {lw, 0, w - lw, h}, true, filter);   // high along x: HL and HH
    filter_band(plane, width, {0, lh, w, h - lh}, false, filter);  // high along y: LH and HH
    sizes.push_back({lw, lh});
  }
  for (int level = levels_; level >= 1; --level) {
    const auto [w, h] = sizes[static_cast<std::size_t>(level - 1)];
    perception::wavelet_inverse(plane, width, w, h);
  }
  Image seen{rendered.width, rendered.height, 1, std::vector<std::uint8_t>(plane.size())};
  std::transform(plane.begin(), plane.end(), seen.pixels.begin(),
                 [](float v) { return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0F, 255.0F))); });
  return seen;
}

}  // namespace lodestone
