// SPDX-License-Identifier: MIT
// The constants of the eye, each against a number worked out by hand: a test that calls the formula it checks follows
// any slip in it.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include <lodestone/perception.h>

using namespace lodestone;

namespace {

constexpr std::uint32_t size = 256;
const std::vector<std::uint8_t> everywhere(size* size, 1);

// Of one colour, with a checkerboard or columns of the given amplitude.
Image even(int value) { return {size, size, 1, std::vector<std::uint8_t>(size * size, std::uint8_t(value))}; }

Image stripes(int value, int amplitude, std::uint32_t half_period_px) {
  Image image = even(value);
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      *image.at(x, y) = std::uint8_t(x / half_period_px % 2 == 0 ? value + amplitude : value - amplitude);
    }
  }
  return image;
}

// Fields of a pixel, alternating along both axes.
Image checkers(int value, int amplitude) {
  Image image = even(value);
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      *image.at(x, y) = std::uint8_t((x + y) % 2 == 0 ? value + amplitude : value - amplitude);
    }
  }
  return image;
}

// Where no band reaches the ends: 2 (1 + 2 + 4 + 8 + 16) pixels.
std::vector<std::uint8_t> inside() {
  std::vector<std::uint8_t> mask(everywhere.size(), 0);
  for (std::uint32_t y = 64; y < size - 64; ++y) std::fill_n(mask.begin() + y * size + 64, size - 128, 1);
  return mask;
}

double noticed(const Image& a, const Image& b, double viewing_distance_m = 0.5,
               const std::vector<std::uint8_t>& mask = everywhere) {
  Display display;
  display.viewing_distance_m = viewing_distance_m;
  const auto check = check_vision(a, b, mask, VisionModel{display});
  REQUIRE(check.ok());
  return check->noticeable_ratio;
}

double noticed_inside(const Image& a, const Image& b) { return noticed(a, b, 0.5, inside()); }

double similarity(const Image& a, const Image& b) {
  Display near;
  near.viewing_distance_m = 0.15;  // the eye loses nothing of the picture
  REQUIRE(VisionModel{near}.levels() == 0);
  return check_vision(a, b, everywhere, VisionModel{near})->ssim;
}

}  // namespace

TEST_CASE("contrast sensitivity has the values of equation 14") {
  CHECK(contrast_sensitivity(1.0) == Approx(0.376854).epsilon(1e-5));
  CHECK(contrast_sensitivity(6.2) == Approx(0.980848).epsilon(1e-5));
  CHECK(contrast_sensitivity(14.82) == Approx(0.560102).epsilon(1e-5));
  CHECK(contrast_sensitivity(30.0) == Approx(0.0759626).epsilon(1e-5));
  // Over its peak, at the finest that the paper's screen can show.
  const VisionModel vision{Display{}};
  CHECK(vision.gain(1, vision.max_frequency_cpd()) == Approx(0.571038).epsilon(1e-3));
}

TEST_CASE("the focal length is that of the vertical field of view") {
  CHECK(focal_length_px(Display{}) == Approx(1710.38).epsilon(1e-4));  // 512 px over tan 16.665 degrees
  CHECK(last_distance_m(10.0, 100.0) == Approx(2000.0).epsilon(1e-4));
}

TEST_CASE("stripes along either axis lose their contrast by the sensitivity at their frequency") {
  Display display;
  display.viewing_distance_m = 1.0;  // pixels alternate at 29.64 cycles per degree: gain 0.0807
  const VisionModel vision{display};
  const Image across = stripes(128, 100, 1);
  Image along = even(0);
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) *along.at(x, y) = *across.at(y, x);
  }
  for (const auto& [image, other] : {std::pair{across, std::pair{1U, 0U}}, std::pair{along, std::pair{0U, 1U}}}) {
    const auto seen = vision.simulate(image);
    REQUIRE(seen.ok());
    for (const std::uint32_t at : {0U, 1U, 63U, 64U, size - 2, size - 1}) {  // at the ends too
      const std::uint32_t x = other.first != 0 ? at : 64;
      const std::uint32_t y = other.first != 0 ? 64 : at;
      CHECK(std::abs(std::abs(int{*seen->at(x, y)} - 128) - 8) <= 1);
    }
  }
}

TEST_CASE("what alternates along both axes loses contrast along both") {
  const VisionModel vision{Display{}};  // gain 0.571038 at the highest frequency
  const auto seen = vision.simulate(checkers(128, 100));
  REQUIRE(seen.ok());
  for (const std::uint32_t x : {0U, 1U, 64U, size - 1}) {
    for (const std::uint32_t y : {0U, 63U, size - 1}) {
      CHECK(std::abs(std::abs(int{*seen->at(x, y)} - 128) - 33) <= 1);  // 100 * 0.571038^2
    }
  }
}

TEST_CASE("colours are as bright as Rec. 709 has them") {
  const VisionModel vision{Display{}};
  const std::pair<std::array<std::uint8_t, 3>, int> colors[] = {
      {{255, 0, 0}, 54}, {{0, 255, 0}, 182}, {{0, 0, 255}, 18}, {{255, 255, 255}, 255}, {{100, 50, 200}, 71}};
  for (const auto& [color, wanted] : colors) {
    Image image{8, 8, 3, {}};
    for (int i = 0; i < 64; ++i) image.pixels.insert(image.pixels.end(), color.begin(), color.end());
    const auto seen = vision.simulate(image);
    REQUIRE(seen.ok());
    CHECK(int{*seen->at(4, 4)} == wanted);
  }
}

TEST_CASE("structural similarity has the constants of its paper") {
  // (2 a b + c1) / (a^2 + b^2 + c1) with c1 = 2.55^2, where nothing varies.
  CHECK(similarity(even(10), even(14)) == Approx(0.947108).epsilon(1e-5));
  // c2 / (v + c2) with c2 = 7.65^2 where one varies: windows of nine columns have a variance near 16.
  CHECK(similarity(even(100), stripes(100, 4, 1)) == Approx(0.786).margin(0.004));
}

TEST_CASE("a broad difference is noticeable from 2 % of the luminance, on a screen of gamma 2.2, and 1.5 values") {
  CHECK(noticed(even(60), even(61)) == 0.0);
  CHECK(noticed(even(60), even(62)) == 1.0);    // 1.5 values
  CHECK(noticed(even(200), even(202)) == 1.0);  // 200 * 0.02 / 2.2 = 1.82
  CHECK(noticed(even(250), even(252)) == 0.0);  // 2.27
  CHECK(noticed(even(250), even(253)) == 1.0);
}

TEST_CASE("fine differences are noticed from near and not from afar; coarse ones from everywhere") {
  const Image flat = even(128);
  CHECK(noticed(flat, stripes(128, 6, 1), 0.5) > 0.99);
  CHECK(noticed(flat, stripes(128, 6, 1), 2.0) == 0.0);
  CHECK(noticed(flat, stripes(128, 6, 16), 2.0) > 0.75);
}

TEST_CASE("contrast that both pictures have hides what is added to it") {
  // A difference of 6 stands out from grey, and drowns between stripes of 60.
  CHECK(noticed(even(128), stripes(128, 6, 1)) > 0.99);
  CHECK(noticed(stripes(128, 60, 1), stripes(128, 66, 1)) == 0.0);
  // Masked, not blinded: with stripes of 60, 24 more are past the raised threshold.
  CHECK(noticed(stripes(128, 60, 1), stripes(128, 84, 1)) > 0.99);
  // Contrast of one picture alone hides nothing.
  CHECK(noticed(even(128), stripes(128, 60, 1)) > 0.99);
}

TEST_CASE("contrast of 60 hides a difference of 20 and not one of 22: an exponent of 0.7 over the threshold") {
  // Threshold of the finest band, 10.48 cycles per degree: 1.5 * 0.980848 / 0.8246 = 1.784; raised by
  // (60 / 1.784)^0.7 to 20.9.
  CHECK(noticed_inside(stripes(128, 60, 1), stripes(128, 80, 1)) < 0.05);
  CHECK(noticed_inside(stripes(128, 60, 1), stripes(128, 82, 1)) > 0.95);
}

TEST_CASE("contrast hides differences in five octaves; what is broader is hidden by nothing") {
  CHECK(noticed_inside(stripes(128, 60, 24), stripes(128, 66, 24)) < 0.05);
  CHECK(noticed_inside(stripes(128, 60, 40), stripes(128, 72, 40)) > 0.75);
}

TEST_CASE("two differences that are not noticed alone are noticed together, by their fourth powers") {
  // At 240: 2 over 2.18 broadly and 2 over 2.60 in stripes: 0.71 + 0.35 > 1. Darker stripes leave nothing to notice.
  CHECK(noticed_inside(even(240), even(242)) == 0.0);
  CHECK(noticed_inside(even(240), stripes(240, 2, 1)) == 0.0);
  CHECK(noticed_inside(even(240), stripes(242, 2, 1)) == Approx(0.5).margin(0.02));
  // At 250: 0.60 + 0.30 < 1, where the squares would make more than 1.
  CHECK(noticed_inside(even(250), stripes(252, 2, 1)) == 0.0);
}
