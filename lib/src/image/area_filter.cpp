// SPDX-License-Identifier: MIT
// Based on: box filter over the exact footprint of each pixel, fractions of source pixels at its edges included.
#include "image/area_filter.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include <lodestone/types.h>

namespace lodestone {
namespace {

double to_linear(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }

// sRGB bytes to linear light and back. Back by a table over the 12 leading bits of the linear value is not enough in
// the dark, so the byte is found by comparing with the light half way between two bytes, from a first guess.
struct LightTables {
  LightTables() {
    for (int i = 0; i < 256; ++i) linear[i] = static_cast<float>(to_linear(i / 255.0));
    for (int i = 0; i < 255; ++i) limit[i] = static_cast<float>(to_linear((i + 0.5) / 255.0));
    int byte = 0;
    for (int i = 0; i < guess_count; ++i) {
      const float light = static_cast<float>(i) / guess_count;
      while (byte < 255 && limit[byte] <= light) ++byte;
      guess[i] = static_cast<std::uint8_t>(byte);
    }
  }
  [[nodiscard]] std::uint8_t byte_of(float light) const noexcept {
    int byte = guess[std::clamp(static_cast<int>(light * guess_count), 0, guess_count - 1)];
    while (byte < 255 && limit[byte] <= light) ++byte;
    return static_cast<std::uint8_t>(byte);
  }
  static constexpr int guess_count = 4096;
  std::array<float, 256> linear{};
  std::array<float, 255> limit{};
  std::array<std::uint8_t, guess_count> guess{};
};

const LightTables& tables() {
  static const LightTables made;
  return made;
}

// The source pixels under pixel i of `count` out of `length`: first, and the weight of each (they sum to 1).
struct Footprint {
  std::uint32_t first = 0;
  std::uint32_t offset = 0;  // into the weights
  std::uint32_t count = 0;
};
struct Footprints {
  std::vector<Footprint> of;
  std::vector<float> weights;
};

Footprints footprints(std::uint32_t length, std::uint32_t count) {
  Footprints result;
  result.of.reserve(count);
  const double step = static_cast<double>(length) / count;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double begin = i * step;
    const double end = std::min<double>(length, (i + 1) * step);
    const auto first = static_cast<std::uint32_t>(begin);
    const auto last = std::min(length, static_cast<std::uint32_t>(std::ceil(end - 1e-9)));
    result.of.push_back({first, static_cast<std::uint32_t>(result.weights.size()), last - first});
    for (std::uint32_t p = first; p < last; ++p) {
      const double covered = std::min<double>(end, p + 1.0) - std::max<double>(begin, p);
      result.weights.push_back(static_cast<float>(covered / (end - begin)));
    }
  }
  return result;
}

// One source row made narrower, in linear light. Colours are weighted by alpha. The number of channels is known when it
// is compiled: this is where the time goes.
template <std::uint32_t channels>
void filter_row(const std::uint8_t* row, const Footprints& across, float* to) {
  const float* linear = tables().linear.data();
  constexpr bool has_alpha = channels == 2 || channels == 4;
  constexpr std::uint32_t colors = has_alpha ? channels - 1 : channels;
  for (const Footprint& print : across.of) {
    const std::uint8_t* from = row + std::size_t{print.first} * channels;
    const float* w = &across.weights[print.offset];
    std::array<float, channels> sum{};
    for (std::uint32_t i = 0; i < print.count; ++i, from += channels) {
      const float opaque = has_alpha ? w[i] * static_cast<float>(from[channels - 1]) / 255.0F : w[i];
      for (std::uint32_t c = 0; c < colors; ++c) sum[c] += opaque * linear[from[c]];
      if (has_alpha) sum[channels - 1] += opaque;
    }
    for (std::uint32_t c = 0; c < channels; ++c) *to++ = sum[c];
  }
}

using FilterRow = void (*)(const std::uint8_t*, const Footprints&, float*);
FilterRow filter_of(std::uint32_t channels) {
  constexpr std::array<FilterRow, 4> filters{filter_row<1>, filter_row<2>, filter_row<3>, filter_row<4>};
  return filters[channels - 1];
}

// Writes one row of `width` pixels.
void store_row(const std::vector<float>& sums, std::uint32_t channels, std::uint32_t width, std::uint8_t* to) {
  const LightTables& light = tables();
  const bool has_alpha = channels == 2 || channels == 4;
  const std::uint32_t colors = has_alpha ? channels - 1 : channels;
  const float* sum = sums.data();
  for (std::uint32_t x = 0; x < width; ++x, sum += channels, to += channels) {
    const float alpha = has_alpha ? sum[colors] : 1.0F;
    for (std::uint32_t c = 0; c < colors; ++c) to[c] = light.byte_of(alpha > 0.0F ? sum[c] / alpha : 0.0F);
    if (has_alpha) to[colors] = static_cast<std::uint8_t>(std::lround(std::clamp(alpha, 0.0F, 1.0F) * 255.0F));
  }
}

// Row by row into `to`, which may be the source's own memory: a row of the result ends before the first row of the
// source that the rows after it are made of, but for one that is shared, and that is kept in `row`.
void shrink_rows(const Image& source, std::uint32_t width, std::uint32_t height, std::uint8_t* to) {
  assert(width >= 1 && height >= 1 && width <= source.width && height <= source.height);
  const Footprints across = footprints(source.width, width);
  const Footprints down = footprints(source.height, height);
  std::vector<float> sums(static_cast<std::size_t>(width) * source.channels);
  std::vector<float> row(sums.size());
  const FilterRow filter = filter_of(source.channels);
  std::uint32_t filtered = none;  // the source row in `row`: one that two pixels share is filtered once
  for (std::uint32_t y = 0; y < height; ++y, to += sums.size()) {
    std::fill(sums.begin(), sums.end(), 0.0F);
    const Footprint& print = down.of[y];
    for (std::uint32_t i = 0; i < print.count; ++i) {
      if (filtered != print.first + i) filter(source.at(0, print.first + i), across, row.data());
      filtered = print.first + i;
      const float weight = down.weights[print.offset + i];
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += weight * row[k];
    }
    store_row(sums, source.channels, width, to);
  }
}

}  // namespace

Image shrink(const Image& source, std::uint32_t width, std::uint32_t height) {
  Image out{width, height, source.channels, {}};
  out.pixels.resize(static_cast<std::size_t>(width) * height * source.channels);
  shrink_rows(source, width, height, out.pixels.data());
  return out;
}

Image shrink_in_place(Image source, std::uint32_t width, std::uint32_t height) {
  shrink_rows(source, width, height, source.pixels.data());
  source.width = width;
  source.height = height;
  source.pixels.resize(static_cast<std::size_t>(width) * height * source.channels);
  return source;
}

}  // namespace lodestone
