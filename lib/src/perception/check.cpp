// SPDX-License-Identifier: MIT
// Based on: Wang, Bovik, Sheikh and Simoncelli 2004 (structural similarity); Zhu et al. 2010, section 5.2.
// Differs: the visible difference predictor of Daly 1993 is reduced to its two strongest parts: contrast sensitivity
// (both pictures are seen through the vision model) and luminance adaptation (Weber's law against the surroundings).
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "perception/luminance.h"

namespace lodestone {
namespace {

constexpr double weber_fraction = 0.02;
constexpr double least_threshold = 2.0;

// Sums over rectangles in constant time.
class Sums {
 public:
  template <class Value>
  Sums(std::size_t width, std::size_t height, Value value) : width_(width), sums_((width + 1) * (height + 1), 0.0) {
    for (std::size_t y = 0; y < height; ++y) {
      double row = 0.0;
      for (std::size_t x = 0; x < width; ++x) {
        row += value(y * width + x);
        sums_[(y + 1) * (width + 1) + x + 1] = sums_[y * (width + 1) + x + 1] + row;
      }
    }
  }
  [[nodiscard]] double over(std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1) const {
    const std::size_t w = width_ + 1;
    return sums_[y1 * w + x1] - sums_[y0 * w + x1] - sums_[y1 * w + x0] + sums_[y0 * w + x0];
  }

 private:
  std::size_t width_;
  std::vector<double> sums_;
};

double similarity(double n, double a, double b, double aa, double bb, double ab) {
  constexpr double c1 = 0.01 * 255 * 0.01 * 255;
  constexpr double c2 = 0.03 * 255 * 0.03 * 255;
  const double ma = a / n;
  const double mb = b / n;
  const double va = std::max(0.0, aa / n - ma * ma);
  const double vb = std::max(0.0, bb / n - mb * mb);
  const double covariance = ab / n - ma * mb;
  return (2.0 * ma * mb + c1) * (2.0 * covariance + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

// Two grey pictures of one size, pixel by pixel where the mask is set.
VisionCheck compare(const Image& a, const Image& b, const std::vector<std::uint8_t>& mask) {
  const std::size_t width = a.width;
  const std::size_t height = a.height;
  const auto& pa = a.pixels;
  const auto& pb = b.pixels;
  const Sums sa{width, height, [&](std::size_t i) { return static_cast<double>(pa[i]); }};
  const Sums sb{width, height, [&](std::size_t i) { return static_cast<double>(pb[i]); }};
  const Sums saa{width, height, [&](std::size_t i) { return static_cast<double>(pa[i]) * pa[i]; }};
  const Sums sbb{width, height, [&](std::size_t i) { return static_cast<double>(pb[i]) * pb[i]; }};
  const Sums sab{width, height, [&](std::size_t i) { return static_cast<double>(pa[i]) * pb[i]; }};

  VisionCheck check;
  check.difference = Image{a.width, a.height, 1, std::vector<std::uint8_t>(width * height, 0)};
  double ssim = 0.0;
  std::uint64_t pixels = 0;
  std::uint64_t noticeable = 0;
  constexpr std::size_t reach = 4;  // windows of 9 x 9
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = y * width + x;
      if (mask[i] == 0) continue;
      const std::size_t x0 = x - std::min(x, reach);
      const std::size_t y0 = y - std::min(y, reach);
      const std::size_t x1 = std::min(width, x + reach + 1);
      const std::size_t y1 = std::min(height, y + reach + 1);
      const auto n = static_cast<double>((x1 - x0) * (y1 - y0));
      const double around = sa.over(x0, y0, x1, y1);
      ssim += similarity(n, around, sb.over(x0, y0, x1, y1), saa.over(x0, y0, x1, y1), sbb.over(x0, y0, x1, y1),
                         sab.over(x0, y0, x1, y1));
      const double threshold = std::max(least_threshold, weber_fraction * around / n);
      const double difference = std::abs(static_cast<double>(pa[i]) - pb[i]);
      check.difference.pixels[i] =
          static_cast<std::uint8_t>(std::min(255.0, 64.0 + 191.0 * std::min(1.0, difference / threshold)));
      ++pixels;
      if (difference > threshold) ++noticeable;
    }
  }
  check.ssim = ssim / static_cast<double>(pixels);
  check.noticeable_ratio = static_cast<double>(noticeable) / static_cast<double>(pixels);
  return check;
}

bool fits(const Image& image, const std::vector<std::uint8_t>& mask) {
  return !image.empty() && mask.size() == static_cast<std::size_t>(image.width) * image.height &&
         std::any_of(mask.begin(), mask.end(), [](std::uint8_t m) { return m != 0; });
}

Error misfit() {
  return {ErrorCode::BadArgument, "pictures and mask must be of one size, and the mask must not be empty",
          "vision check"};
}

}  // namespace

Result<VisionCheck> check_vision(const Image& a, const Image& b, const std::vector<std::uint8_t>& mask,
                                 const VisionModel& vision) {
  if (!fits(a, mask) || a.width != b.width || a.height != b.height) return misfit();
  const auto seen_a = vision.simulate(a);
  if (!seen_a) return seen_a.error();
  const auto seen_b = vision.simulate(b);
  if (!seen_b) return seen_b.error();
  return compare(*seen_a, *seen_b, mask);
}

Result<VisionCheck> check_simulation(const ObjectPicture& picture, const VisionModel& vision) {
  if (!fits(picture.image, picture.mask)) return misfit();
  const auto seen = vision.simulate(picture.image);
  if (!seen) return seen.error();
  auto check = check_vision(picture.image, *seen, picture.mask, vision);
  if (!check) return check.error();
  Image rendered{seen->width, seen->height, 1, std::vector<std::uint8_t>(picture.mask.size())};
  for (std::size_t i = 0; i < rendered.pixels.size(); ++i) rendered.pixels[i] = perception::grey(picture.image, i);
  check->ssim = compare(rendered, *seen, picture.mask).ssim;
  return check;
}

Result<Image> difference_map(const ObjectPicture& picture, const VisionModel& vision) {
  if (!fits(picture.image, picture.mask)) return misfit();
  auto map = vision.simulate(picture.image);
  if (!map) return map.error();
  constexpr std::uint8_t background = 255;
  constexpr int same = 232;
  constexpr int steps = 12;  // grey values per unit of difference: single ones can be told apart
  for (std::size_t i = 0; i < map->pixels.size(); ++i) {
    const int difference = std::abs(int{perception::grey(picture.image, i)} - int{map->pixels[i]});
    map->pixels[i] = picture.mask[i] == 0 ? background
                     : difference == 0    ? std::uint8_t{same}
                                          : static_cast<std::uint8_t>(std::max(0, 160 - steps * difference));
  }
  return map;
}

}  // namespace lodestone
