// SPDX-License-Identifier: MIT
#include <lodestone/texture_colors.h>

#include <catch2/catch.hpp>

#include <lodestone/formats.h>

using namespace lodestone;

TEST_CASE("the mean colour of a texture is the same from pixels, from bytes, and white from nothing") {
  Image image{200, 100, 3, {}};
  for (std::uint32_t i = 0; i < 200 * 100; ++i) {
    const bool left = i % 200 < 100;
    image.pixels.insert(image.pixels.end(), {std::uint8_t(left ? 200 : 100), 50, std::uint8_t(left ? 0 : 60)});
  }
  Surroundings source;
  source.textures.resize(4);
  source.textures[0].image = std::make_shared<const Image>(image);
  const auto keep = [](Result<std::vector<std::uint8_t>> bytes) {
    REQUIRE(bytes.ok());
    return std::make_shared<const std::vector<std::uint8_t>>(std::move(*bytes));
  };
  source.textures[1].encoded = keep(encode_png(image));
  source.textures[2].encoded = keep(encode_jpeg(image, 95));
  source.textures[3].path = "no/such/file.png";
  const auto colors = mean_texture_colors(source);
  REQUIRE(colors.size() == 4);
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    CHECK(colors[i].r == Approx(150.0 / 255.0).margin(0.02));
    CHECK(colors[i].g == Approx(50.0 / 255.0).margin(0.02));
    CHECK(colors[i].b == Approx(30.0 / 255.0).margin(0.02));
  }
  CHECK(colors[3] == glm::vec3{1.0F});
}
