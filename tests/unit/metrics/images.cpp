// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>

#include <lodestone/metrics.h>

using namespace lodestone;

namespace {

Image flat(std::uint32_t width, std::uint32_t height, std::uint32_t channels, std::uint8_t value) {
  return {width, height, channels, std::vector<std::uint8_t>(std::size_t{width} * height * channels, value)};
}

}  // namespace

TEST_CASE("image_rms is the constant difference, over RGB, within the mask") {
  CHECK(image_rms(flat(7, 5, 3, 10), flat(7, 5, 3, 10)) == 0.0);
  CHECK(image_rms(flat(7, 5, 3, 10), flat(7, 5, 4, 25)) == Approx(15.0));
  CHECK(image_rms(flat(7, 5, 1, 30), flat(7, 5, 3, 25)) == Approx(5.0));
  Image one = flat(4, 1, 3, 0);
  one.at(2, 0)[1] = 60;
  CHECK(image_rms(one, flat(4, 1, 3, 0)) == Approx(std::sqrt(3600.0 / 12.0)));
  CHECK(image_rms(one, flat(4, 1, 3, 0), std::vector<std::uint8_t>{1, 1, 0, 1}) == 0.0);
  CHECK(image_rms(one, flat(4, 1, 3, 0), std::vector<std::uint8_t>{0, 0, 255, 0}) == Approx(std::sqrt(1200.0)));
  CHECK(image_rms(one, one, std::vector<std::uint8_t>{0, 0, 0, 0}) == 0.0);
}

TEST_CASE("transparency does not count as a difference") {
  Image a = flat(3, 3, 4, 9);
  for (std::uint32_t i = 0; i < 9; ++i) a.pixels[4 * i + 3] = 200;
  CHECK(image_rms(a, flat(3, 3, 4, 9)) == 0.0);
  CHECK(block_pop(a, flat(3, 3, 4, 9)) == 0.0);
}

TEST_CASE("block_pop finds the block that changed most, also the cut ones at the border") {
  const Image before = flat(40, 20, 3, 100);
  Image after = before;
  for (std::uint32_t y = 0; y < 16; ++y) {
    for (std::uint32_t x = 16; x < 32; ++x) after.at(x, y)[0] = 130;  // 30 in one channel of a whole block
  }
  CHECK(block_pop(before, after) == Approx(10.0));
  for (std::uint32_t y = 16; y < 20; ++y) {
    for (std::uint32_t x = 32; x < 40; ++x) after.at(x, y)[2] = 40;  // -60 in one channel of the 8 x 4 corner
  }
  CHECK(block_pop(before, after) == Approx(20.0));
  CHECK(block_pop(before, before) == 0.0);
}
