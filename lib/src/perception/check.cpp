// SPDX-License-Identifier: MIT
// Based on: Wang, Bovik, Sheikh and Simoncelli 2004 (structural similarity); Zhu et al. 2010, section 5.2.
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "perception/luminance.h"
#include "perception/visible_difference.h"

namespace lodestone {
namespace {

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

// Mean structural similarity of two grey pictures of one size where the mask is set.
double mean_similarity(const Image& a, const Image& b, const std::vector<std::uint8_t>& mask) {
  const std::size_t width = a.width;
  const std::size_t height = a.height;
  const auto& pa = a.pixels;
  const auto& pb = b.pixels;
  const Sums sa{width, height, [&](std::size_t i) { return static_cast<double>(pa[i]); }};
  const Sums sb{width, height, [&](std::size_t i) { return static_cast<double>(pb[i]); }};
  const Sums saa{width, height, [&](std::size_t i) { return static_cast<double>(pa[i]) * pa[i]; }};
  const Sums sbb{width, height, [&](std::size_t i) { return static_cast<double>(pb[i]) * pb[i]; }};
  const Sums sab{width, height, [&](std::size_t i) { return static_cast<double>(pa[i]) * pb[i]; }};
  double ssim = 0.0;
  std::uint64_t pixels = 0;
  constexpr std::size_t reach = 4;  // windows of 9 x 9
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      if (mask[y * width + x] == 0) continue;
      const std::size_t x0 = x - std::min(x, reach);
      const std::size_t y0 = y - std::min(y, reach);
      const std::size_t x1 = std::min(width, x + reach + 1);
      const std::size_t y1 = std::min(height, y + reach + 1);
      const auto n = static_cast<double>((x1 - x0) * (y1 - y0));
      ssim += similarity(n, sa.over(x0, y0, x1, y1), sb.over(x0, y0, x1, y1), saa.over(x0, y0, x1, y1),
                         sbb.over(x0, y0, x1, y1), sab.over(x0, y0, x1, y1));
      ++pixels;
    }
  }
  return ssim / static_cast<double>(pixels);
}

// Where two pictures differ noticeably.
VisionCheck compare(const Image& a, const Image& b, const std::vector<std::uint8_t>& mask, const VisionModel& vision) {
  VisionCheck check;
  check.difference = Image{a.width, a.height, 1, std::vector<std::uint8_t>(mask.size(), 0)};
  const std::vector<float> noticed = perception::visible_difference(a, b, vision);
  std::uint64_t pixels = 0;
  std::uint64_t noticeable = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0) continue;
    check.difference.pixels[i] = static_cast<std::uint8_t>(64.0F + 191.0F * std::min(1.0F, noticed[i]));
    ++pixels;
    if (noticed[i] > 1.0F) ++noticeable;
  }
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
  VisionCheck check = compare(a, b, mask, vision);
  check.ssim = mean_similarity(*seen_a, *seen_b, mask);
  return check;
}

Result<VisionCheck> check_simulation(const ObjectPicture& picture, const VisionModel& vision) {
  if (!fits(picture.image, picture.mask)) return misfit();
  const auto seen = vision.simulate(picture.image);
  if (!seen) return seen.error();
  VisionCheck check = compare(picture.image, *seen, picture.mask, vision);
  Image rendered{seen->width, seen->height, 1, std::vector<std::uint8_t>(picture.mask.size())};
  for (std::size_t i = 0; i < rendered.pixels.size(); ++i) rendered.pixels[i] = perception::grey(picture.image, i);
  check.ssim = mean_similarity(rendered, *seen, picture.mask);
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
