// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numeric>

#include <catch2/catch.hpp>

#include "base/rng.h"
#include "fixture.h"
#include "image/area_filter.h"
#include "image/fill.h"

namespace lodestone::test {
namespace {

double to_linear(double byte) {
  const double s = byte / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

Image noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
  Image image{width, height, channels, {}};
  Rng rng{7};
  image.pixels.resize(std::size_t{width} * height * channels);
  for (auto& p : image.pixels) p = static_cast<std::uint8_t>(rng.below(256));
  return image;
}

double mean_light(const Image& image) {
  const double sum = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0,
                                     [](double total, std::uint8_t byte) { return total + to_linear(byte); });
  return sum / static_cast<double>(image.pixels.size());
}

}  // namespace

TEST_CASE("Shrinking keeps the mean light, for whole and fractional steps") {
  const Image image = noise(97, 61, 3);
  for (const auto& [width, height] : {std::pair{48U, 30U}, {50U, 61U}, {97U, 1U}, {78U, 49U}, {1U, 1U}}) {
    const Image small = shrink(image, width, height);
    CHECK(shrink_in_place(image, width, height).pixels == small.pixels);
    CHECK(small.width == width);
    CHECK(small.height == height);
    CHECK(mean_light(small) == Approx(mean_light(image)).margin(0.01));
  }
  CHECK(shrink(image, 97, 61).pixels == image.pixels);
}

TEST_CASE("Black and white average to the grey of half the light, not of half the byte") {
  Image image{2, 1, 1, {0, 255}};
  CHECK(int{shrink(image, 1, 1).pixels.front()} == 188);
  Image clear{2, 1, 4, {255, 0, 0, 0, 0, 255, 0, 255}};  // what is transparent does not colour
  const Image mixed = shrink(clear, 1, 1);
  CHECK(int{mixed.pixels[0]} == 0);
  CHECK(int{mixed.pixels[1]} == 255);
  CHECK(int{mixed.pixels[3]} == 128);
}

TEST_CASE("Filling leaves the known pixels and mixes the others from them") {
  Image image = noise(33, 21, 3);
  for (auto& p : image.pixels) p = static_cast<std::uint8_t>(100 + p / 8);  // 100..131
  const Image before = image;
  std::vector<bool> known(33 * 21, false);
  for (std::size_t i = 0; i < known.size(); ++i) known[i] = i % 33 < 9 && i / 33 > 4;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!known[i]) std::fill_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, std::uint8_t{0});
  }
  fill_unknown(image, known);
  for (std::size_t i = 0; i < known.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int value = image.pixels[3 * i + c];
      if (known[i]) CHECK(value == int{before.pixels[3 * i + c]});
      CHECK((value >= 100 && value <= 131));
    }
  }
  std::vector<bool> one(33 * 21, false);
  one[10 * 33 + 16] = true;
  widen(one, 33, 21, 1);
  CHECK(std::count(one.begin(), one.end(), true) == 9);
}

TEST_CASE("A tile's texture holds the source's pixels at level 0, and at any level those of the image around it") {
  const Mesh& cliff = small_cliff();
  const auto pyramid = pyramid_of(cliff, small_tiles());
  std::vector<SegmentImages> images;
  for (std::uint32_t s = 0; s < pyramid->segments().size(); ++s) {
    images.emplace_back(*pyramid, s, *cliff.textures[pyramid->segments()[s].texture].image);
  }
  std::uint32_t level = 0;
  for (std::uint32_t i = 0; i < pyramid->tiles().size(); ++i) {
    const OutcropTile& tile = pyramid->tiles()[i];
    if (tile.level != level) {
      level = tile.level;
      for (SegmentImages& one : images) one.go_to(*pyramid, level);
    }
    std::vector<const SegmentImages*> used;
    for (const std::uint32_t s : tile.segments) used.push_back(&images[s]);
    const TileContent content = pyramid->content(i);
    const Image texture = compose(content.texture, used);
    CHECK(texture.width % 8 == 0);
    CHECK(texture.height % 8 == 0);
    for (const TexturePiece& piece : content.texture.pieces) {
      const OutcropSegment& s = pyramid->segments()[piece.segment];
      const Image& whole = images[piece.segment].image();
      const Image& source = *cliff.textures[s.texture].image;
      const std::vector<bool> shown = level == 0 ? pyramid->coverage(piece.segment) : std::vector<bool>{};
      std::size_t wrong = 0;
      for (std::uint32_t y = 0; y < piece.height; ++y) {
        for (std::uint32_t x = 0; x < piece.width; ++x) {
          const auto fx =
              static_cast<std::uint32_t>(std::clamp<std::int64_t>(std::int64_t{piece.from_x} + x, 0, whole.width - 1));
          const auto fy =
              static_cast<std::uint32_t>(std::clamp<std::int64_t>(std::int64_t{piece.from_y} + y, 0, whole.height - 1));
          const std::uint8_t* pixel = texture.at(piece.to_x + x, piece.to_y + y);
          if (!std::equal(pixel, pixel + 3, whole.at(fx, fy))) ++wrong;
          if (level > 0 || !shown[std::size_t{fy} * s.width_px + fx]) continue;
          const std::uint8_t* original =
              source.at(fx + static_cast<std::uint32_t>(s.left_px), fy + static_cast<std::uint32_t>(s.top_px));
          if (!std::equal(pixel, pixel + 3, original)) ++wrong;
        }
      }
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("Corners lie inside their piece, a gutter away from the next one") {
  const auto pyramid = pyramid_of(small_cliff(), small_tiles());
  for (std::uint32_t i = 0; i < pyramid->tiles().size(); ++i) {
    const TileContent content = pyramid->content(i);
    const bool several = content.texture.pieces.size() > 1;
    for (const glm::vec2& uv : content.mesh.vertices.uvs) {
      const glm::dvec2 at{double{uv.x} * content.texture.width, (1.0 - double{uv.y}) * content.texture.height};
      const bool inside =
          std::any_of(content.texture.pieces.begin(), content.texture.pieces.end(), [&](const TexturePiece& p) {
            const double gutter = several ? 5.0 : -2.0;
            return at.x >= p.to_x + gutter && at.y >= p.to_y + gutter && at.x <= p.to_x + p.width - gutter &&
                   at.y <= p.to_y + p.height - gutter;
          });
      CAPTURE(i, at.x, at.y, several, content.texture.pieces.size(), content.texture.width, content.texture.height);
      CHECK(inside);
    }
  }
}

TEST_CASE("What no triangle shows takes no part in coarser levels") {
  // The image is black where no triangle is, white where some are: every coarser tile must be white throughout.
  Mesh mesh = small_cliff();
  const auto sizes = texture_sizes(mesh);
  const auto pyramid = pyramid_of(mesh, small_tiles());
  for (std::uint32_t s = 0; s < pyramid->segments().size(); ++s) {
    const OutcropSegment& segment = pyramid->segments()[s];
    const std::vector<bool> shown = pyramid->coverage(s);
    Image image{sizes[segment.texture].width_px, sizes[segment.texture].height_px, 3, {}};
    image.pixels.assign(std::size_t{image.width} * image.height * 3, 0);
    for (std::uint32_t y = 0; y < segment.height_px; ++y) {
      for (std::uint32_t x = 0; x < segment.width_px; ++x) {
        if (!shown[std::size_t{y} * segment.width_px + x]) continue;
        std::fill_n(
            image.at(x + static_cast<std::uint32_t>(segment.left_px), y + static_cast<std::uint32_t>(segment.top_px)),
            3, std::uint8_t{255});
      }
    }
    SegmentImages images{*pyramid, s, std::move(image)};
    for (std::uint32_t level = 0; level < pyramid->levels().size(); ++level) {
      images.go_to(*pyramid, level);
      CHECK(*std::min_element(images.image().pixels.begin(), images.image().pixels.end()) >= 254);
    }
  }
}

}  // namespace lodestone::test
