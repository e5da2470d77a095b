// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include <lodestone/perception.h>

#include "perception/wavelet.h"

using namespace lodestone;

namespace {

std::vector<float> random_plane(std::size_t width, std::size_t height, unsigned seed) {
  std::mt19937 random{seed};
  std::vector<float> plane(width * height);
  for (float& v : plane) v = static_cast<float>(random() % 256);
  return plane;
}

Image grey(std::uint32_t width, std::uint32_t height, std::uint8_t value) {
  return {width, height, 1, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height, value)};
}

// Vertical stripes of `period_px`, between 100 and 156.
Image stripes(std::uint32_t width, std::uint32_t height, double period_px) {
  Image image = grey(width, height, 0);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      *image.at(x, y) = static_cast<std::uint8_t>(std::lround(128.0 + 28.0 * std::cos(2.0 * M_PI * x / period_px)));
    }
  }
  return image;
}

double contrast(const Image& image) {
  // Away from the border.
  double low = 255.0;
  double high = 0.0;
  for (std::uint32_t x = image.width / 4; x < image.width * 3 / 4; ++x) {
    low = std::min<double>(low, *image.at(x, image.height / 2));
    high = std::max<double>(high, *image.at(x, image.height / 2));
  }
  return high - low;
}

}  // namespace

TEST_CASE("the wavelet gives every picture back, of odd and even sizes") {
  for (const auto& [width, height] : std::vector<std::pair<std::size_t, std::size_t>>{
           {1, 1}, {1, 9}, {2, 2}, {3, 2}, {7, 5}, {64, 64}, {65, 33}, {100, 101}, {161, 128}}) {
    const auto before = random_plane(width, height, static_cast<unsigned>(width * 31 + height));
    auto plane = before;
    perception::wavelet_forward(plane, width, width, height);
    perception::wavelet_forward(plane, width, (width + 1) / 2, (height + 1) / 2);
    if (width * height > 4) CHECK(plane != before);
    perception::wavelet_inverse(plane, width, (width + 1) / 2, (height + 1) / 2);
    perception::wavelet_inverse(plane, width, width, height);
    double worst = 0.0;
    for (std::size_t i = 0; i < plane.size(); ++i) worst = std::max<double>(worst, std::abs(plane[i] - before[i]));
    CHECK(worst / 255.0 < 1e-5);
  }
}

TEST_CASE("the wavelet of a picture is that of the picture mirrored at its ends, as far as the picture goes") {
  // The samples at the ends themselves are not repeated; the mirrored signal begins at an even place.
  constexpr std::size_t before = 64;
  for (const std::size_t count : {21U, 22U}) {
    const auto signal = random_plane(count, 1, 7);
    const std::size_t period = 2 * (count - 1);
    std::vector<float> mirrored(before + count + 64 + count % 2);
    for (std::size_t i = 0; i < mirrored.size(); ++i) {
      const std::size_t at = (i + 64 * period - before) % period;
      mirrored[i] = signal[std::min(at, period - at)];
    }
    for (const bool columns : {false, true}) {
      const auto forward = [&](std::vector<float> plane) {
        const std::size_t n = plane.size();
        perception::wavelet_forward(plane, columns ? 1 : n, columns ? 1 : n, columns ? n : 1);
        return plane;
      };
      const auto transformed = forward(signal);
      const auto wanted = forward(mirrored);
      const std::size_t low = (count + 1) / 2;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = i < low ? before / 2 + i : (mirrored.size() + 1) / 2 + before / 2 + i - low;
        CHECK(transformed[i] == Approx(wanted[at]).margin(1e-3));
      }
    }
  }
}

TEST_CASE("the wavelet puts what is smooth into the low band alone") {
  std::vector<float> plane(64 * 64);
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = 10.0F + 0.5F * static_cast<float>(i % 64);
  perception::wavelet_forward(plane, 64, 64, 64);
  for (std::size_t y = 0; y < 64; ++y) {
    for (std::size_t x = 34; x < 60; ++x) CHECK(std::abs(plane[y * 64 + x]) < 1e-3F);  // the ends mirror
  }
}

TEST_CASE("physical set-up: the paper's screen shows 14.82 cycles per degree and needs two levels") {
  const Display display;
  CHECK(max_frequency_cpd(display) == Approx(14.82).epsilon(0.001));
  CHECK(VisionModel{display}.levels() == 2);
  Display far = display;
  far.viewing_distance_m = 1.0;
  CHECK(max_frequency_cpd(far) == Approx(29.64).epsilon(0.001));
  CHECK(VisionModel{far}.levels() == 3);
  Display coarse = display;
  coarse.viewing_distance_m = 0.15;
  CHECK(VisionModel{coarse}.levels() == 0);
}

TEST_CASE("physical set-up: first and last distance are those of the paper") {
  const double radius_m = 19.64;
  const double focal_px = 757.4;
  CHECK(first_distance_m(radius_m, 33.33 * M_PI / 180.0) == Approx(68.48).epsilon(0.01));
  CHECK(last_distance_m(radius_m, focal_px) == Approx(29750.0).epsilon(0.01));
  CHECK(last_distance_m(radius_m, focal_px) / first_distance_m(radius_m, 33.33 * M_PI / 180.0) ==
        Approx(434.4).epsilon(0.01));
  CHECK(imperceptible_error_m(68.48, focal_px) == Approx(0.0452).epsilon(0.01));
}

TEST_CASE("the filters equal the contrast sensitivity over its peak at their sampled frequencies") {
  for (const double distance_m : {0.5, 0.8, 2.0}) {
    Display display;
    display.viewing_distance_m = distance_m;
    const VisionModel vision{display};
    for (int level = 1; level <= vision.levels(); ++level) {
      const double top = max_frequency_cpd(display) / std::exp2(level - 1);
      for (int k = 0; k <= 8; ++k) {
        const double f = top * (1.0 - k / 17.0);
        const double wanted = f <= peak_frequency_cpd
                                  ? 1.0
                                  : std::min(1.0, contrast_sensitivity(f) / contrast_sensitivity(peak_frequency_cpd));
        CHECK(vision.gain(level, f) == Approx(wanted).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("contrast sensitivity peaks near 6.2 cycles per degree and falls to almost nothing at 60") {
  for (const double f : {1.0, 4.0, 9.0, 20.0})
    CHECK(contrast_sensitivity(f) < contrast_sensitivity(peak_frequency_cpd));
  CHECK(contrast_sensitivity(60.0) < 0.01);
}

TEST_CASE("the eye keeps coarse stripes and loses fine ones") {
  Display display;
  display.viewing_distance_m = 2.0;  // 59 cycles per degree at the finest
  const VisionModel vision{display};
  const Image fine = stripes(256, 64, 2.0);
  const Image coarse = stripes(256, 64, 64.0);
  CHECK(contrast(fine) > 50.0);
  CHECK(contrast(*vision.simulate(fine)) < 5.0);
  CHECK(contrast(*vision.simulate(coarse)) > 50.0);
  const Image flat = grey(40, 30, 77);
  CHECK(vision.simulate(flat)->pixels == flat.pixels);
  CHECK_FALSE(vision.simulate(Image{}).ok());
}

TEST_CASE("visible detail counts the object's pixels alone, and refuses a picture without object") {
  const VisionModel vision{Display{}};
  ObjectPicture picture{stripes(128, 64, 2.0), std::vector<std::uint8_t>(128 * 64, 0)};
  CHECK_FALSE(visible_detail(picture, vision).ok());
  for (std::size_t i = 0; i < 64 * 32; ++i) picture.mask[i] = 255;
  const auto fine = visible_detail(picture, vision);
  REQUIRE(fine.ok());
  CHECK(fine->object_pixels == 64 * 32);
  CHECK(fine->imperceptible_pixels > 64 * 24);
  picture.image = grey(128, 64, 200);
  CHECK(visible_detail(picture, vision)->imperceptible_pixels == 0);
  picture.mask.pop_back();
  CHECK_FALSE(visible_detail(picture, vision).ok());
}

TEST_CASE("the vision check calls equal pictures equal and a changed patch noticeable") {
  const VisionModel vision{Display{}};
  const Image a = stripes(128, 128, 32.0);
  const std::vector<std::uint8_t> mask(128 * 128, 255);
  const auto same = check_vision(a, a, mask, vision);
  REQUIRE(same.ok());
  CHECK(same->ssim == Approx(1.0));
  CHECK(same->noticeable_ratio == 0.0);
  Image b = a;
  for (std::uint32_t y = 40; y < 72; ++y) {
    for (std::uint32_t x = 40; x < 72; ++x) *b.at(x, y) = 10;
  }
  const auto changed = check_vision(a, b, mask, vision);
  REQUIRE(changed.ok());
  CHECK(changed->ssim < 0.97);
  CHECK(changed->noticeable_ratio == Approx(32.0 * 32.0 / (128.0 * 128.0)).epsilon(0.25));
  CHECK(*changed->difference.at(56, 56) == 255);
  CHECK(*changed->difference.at(5, 5) == 64);
  CHECK_FALSE(check_vision(a, grey(4, 4, 0), mask, vision).ok());
  CHECK_FALSE(check_vision(a, a, std::vector<std::uint8_t>(128 * 128, 0), vision).ok());
}
