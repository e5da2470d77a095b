// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include <lodestone/metrics.h>

namespace lodestone {
namespace {

// Differences in R, G and B; grey images count as three equal channels, alpha is left out.
std::array<int, 3> difference(const Image& a, const Image& b, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = a.at(x, y);
  const std::uint8_t* q = b.at(x, y);
  std::array<int, 3> d{};
  for (std::size_t c = 0; c < 3; ++c) d[c] = int{p[a.channels < 3 ? 0 : c]} - int{q[b.channels < 3 ? 0 : c]};
  return d;
}

}  // namespace

glm::vec3 mean_color(const Image& image) {
  assert(!image.empty());
  constexpr std::uint32_t most_samples = 64;  // of width and height
  const std::uint32_t step_x = std::max(1U, image.width / most_samples);
  const std::uint32_t step_y = std::max(1U, image.height / most_samples);
  glm::dvec3 sum{0.0};
  double count = 0.0;
  for (std::uint32_t y = 0; y < image.height; y += step_y) {
    for (std::uint32_t x = 0; x < image.width; x += step_x) {
      const std::uint8_t* texel = image.at(x, y);
      const bool grey = image.channels < 3;
      sum += glm::dvec3{texel[0], texel[grey ? 0 : 1], texel[grey ? 0 : 2]} / 255.0;
      count += 1.0;
    }
  }
  return glm::vec3{sum / count};
}

double image_rms(const Image& a, const Image& b, std::span<const std::uint8_t> mask) {
  assert(a.width == b.width && a.height == b.height);
  assert(mask.empty() || mask.size() == std::size_t{a.width} * a.height);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::uint32_t y = 0; y < a.height; ++y) {
    for (std::uint32_t x = 0; x < a.width; ++x) {
      if (!mask.empty() && mask[std::size_t{y} * a.width + x] == 0) continue;
      for (const int d : difference(a, b, x, y)) sum += d * d;
      count += 3;
    }
  }
  return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

double block_pop(const Image& a, const Image& b) {
  assert(a.width == b.width && a.height == b.height);
  constexpr std::uint32_t side = 16;
  double largest = 0.0;
  for (std::uint32_t top = 0; top < a.height; top += side) {
    for (std::uint32_t left = 0; left < a.width; left += side) {
      const std::uint32_t bottom = std::min(top + side, a.height);
      const std::uint32_t right = std::min(left + side, a.width);
      std::uint32_t sum = 0;
      for (std::uint32_t y = top; y < bottom; ++y) {
        for (std::uint32_t x = left; x < right; ++x) {
          for (const int d : difference(a, b, x, y)) sum += static_cast<std::uint32_t>(std::abs(d));
        }
      }
      largest = std::max(largest, sum / (3.0 * (bottom - top) * (right - left)));
    }
  }
  return largest;
}

}  // namespace lodestone
