// SPDX-License-Identifier: MIT
// Based on: Gortler, Grzeszczuk, Szeliski and Cohen 1996, "The Lumigraph" (push-pull filling).
// Differs: works on bytes and weighs a pixel of a coarser level by how many known ones it stands for, 0 to 255.
#include "image/fill.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

namespace lodestone {
namespace {

struct Coarse {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  std::vector<std::uint8_t> weights;
};

// Halves; `weight_at(x, y)` tells how much a pixel of the finer level counts.
template <class Weight>
Coarse halve(std::uint32_t width, std::uint32_t height, std::uint32_t channels, const std::uint8_t* pixels,
             Weight weight_at) {
  Coarse out{(width + 1) / 2, (height + 1) / 2, {}, {}};
  const std::size_t count = static_cast<std::size_t>(out.width) * out.height;
  out.pixels.resize(count * channels);
  out.weights.resize(count);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      std::array<std::uint32_t, 4> sum{};
      std::uint32_t total = 0;
      for (std::uint32_t fy = 2 * y; fy < std::min(height, 2 * y + 2); ++fy) {
        for (std::uint32_t fx = 2 * x; fx < std::min(width, 2 * x + 2); ++fx) {
          const std::uint32_t weight = weight_at(fx, fy);
          total += weight;
          const std::uint8_t* from = pixels + (static_cast<std::size_t>(fy) * width + fx) * channels;
          for (std::uint32_t c = 0; c < channels; ++c) sum[c] += weight * from[c];
        }
      }
      const std::size_t at = static_cast<std::size_t>(y) * out.width + x;
      // A few known pixels are enough to be trusted: the sum, not the mean, of the weights.
      out.weights[at] = static_cast<std::uint8_t>(std::min(total, 255U));
      if (total == 0) continue;
      for (std::uint32_t c = 0; c < channels; ++c) {
        out.pixels[at * channels + c] = static_cast<std::uint8_t>((sum[c] + total / 2) / total);
      }
    }
  }
  return out;
}

// Bilinear look at the next coarser level.
void sample(const Coarse& coarse, std::uint32_t channels, std::uint32_t x, std::uint32_t y, std::uint32_t* out) {
  const std::uint32_t x0 = x / 2;
  const std::uint32_t y0 = y / 2;
  const std::uint32_t x1 = x % 2 == 0 ? (x0 == 0 ? 0 : x0 - 1) : std::min(x0 + 1, coarse.width - 1);
  const std::uint32_t y1 = y % 2 == 0 ? (y0 == 0 ? 0 : y0 - 1) : std::min(y0 + 1, coarse.height - 1);
  const auto at = [&](std::uint32_t cx, std::uint32_t cy) {
    return coarse.pixels.data() + (static_cast<std::size_t>(cy) * coarse.width + cx) * channels;
  };
  const std::uint8_t* near = at(x0, y0);
  const std::uint8_t* side = at(x1, y0);
  const std::uint8_t* above = at(x0, y1);
  const std::uint8_t* far = at(x1, y1);
  for (std::uint32_t c = 0; c < channels; ++c) {
    out[c] = (9U * near[c] + 3U * side[c] + 3U * above[c] + far[c] + 8U) / 16U;
  }
}

}  // namespace

void fill_unknown(Image& image, const std::vector<bool>& known) {
  assert(known.size() == static_cast<std::size_t>(image.width) * image.height);
  const std::uint32_t channels = image.channels;
  if (std::find(known.begin(), known.end(), false) == known.end()) return;
  std::vector<Coarse> levels;
  levels.push_back(halve(image.width, image.height, channels, image.pixels.data(), [&](auto x, auto y) {
    return known[static_cast<std::size_t>(y) * image.width + x] ? 64U : 0U;
  }));
  while (levels.back().width > 1 || levels.back().height > 1) {
    const Coarse& finer = levels.back();
    levels.push_back(halve(finer.width, finer.height, channels, finer.pixels.data(), [&](auto x, auto y) {
      return std::uint32_t{finer.weights[static_cast<std::size_t>(y) * finer.width + x]};
    }));
  }
  if (levels.back().weights[0] == 0) return;
  std::array<std::uint32_t, 4> from{};
  for (std::size_t l = levels.size() - 1; l-- > 0;) {
    Coarse& level = levels[l];
    for (std::uint32_t y = 0; y < level.height; ++y) {
      for (std::uint32_t x = 0; x < level.width; ++x) {
        const std::size_t at = static_cast<std::size_t>(y) * level.width + x;
        const std::uint32_t weight = level.weights[at];
        if (weight == 255) continue;
        sample(levels[l + 1], channels, x, y, from.data());
        for (std::uint32_t c = 0; c < channels; ++c) {
          std::uint8_t& pixel = level.pixels[at * channels + c];
          pixel = static_cast<std::uint8_t>((weight * pixel + (255 - weight) * from[c] + 127) / 255);
        }
      }
    }
  }
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      if (known[static_cast<std::size_t>(y) * image.width + x]) continue;
      sample(levels.front(), channels, x, y, from.data());
      for (std::uint32_t c = 0; c < channels; ++c) image.at(x, y)[c] = static_cast<std::uint8_t>(from[c]);
    }
  }
}

void widen(std::vector<bool>& known, std::uint32_t width, std::uint32_t height, int rings) {
  const auto step = [&](std::size_t count, std::size_t stride, std::size_t lines, std::size_t line_stride) {
    for (std::size_t line = 0; line < lines; ++line) {
      const std::size_t base = line * line_stride;
      bool before = false;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = base + i * stride;
        const bool here = known[at];
        const bool after = i + 1 < count && known[at + stride];
        known[at] = here || before || after;
        before = here;
      }
    }
  };
  for (int ring = 0; ring < rings; ++ring) {
    step(width, 1, height, width);
    step(height, width, width, 1);
  }
}

}  // namespace lodestone
