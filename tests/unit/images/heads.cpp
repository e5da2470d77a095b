// SPDX-License-Identifier: MIT
// Sizes of images, told from their heads.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <lodestone/formats.h>
#include <catch2/catch.hpp>

#include "base/rng.h"
#include "images/codecs.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_pixels = 1U << 20U;

Bytes bytes_of(const fs::path& file) {
  std::ifstream stream{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

// Plain, 24 bits.
Bytes tga(std::uint8_t side, std::uint8_t high_byte = 0) {
  Bytes bytes(18 + std::size_t{side} * side * 3, 77);
  std::fill_n(bytes.begin(), 18, std::uint8_t{0});
  bytes[2] = 2;
  bytes[12] = bytes[14] = side;
  bytes[13] = bytes[15] = high_byte;
  bytes[16] = 24;
  return bytes;
}

std::vector<std::pair<std::string, Bytes>> seeds() {
  std::vector<std::pair<std::string, Bytes>> seeds{{"small.tga", tga(9)}};
  for (const auto& entry : fs::directory_iterator{fs::path{LODESTONE_CORPUS} / "image"}) {
    seeds.emplace_back(entry.path().filename().string(), bytes_of(entry.path()));
  }
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

void put_big_endian(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::uint8_t>(value >> (24U - 8U * k));
}

}  // namespace

TEST_CASE("A head tells the size of the decoded picture") {
  for (const auto& [name, bytes] : seeds()) {
    INFO(name);
    const auto head = image_head(bytes, bytes.size(), name, most_pixels);
    const auto image = decode_image(bytes, name, most_pixels);
    REQUIRE(head);
    REQUIRE(image);
    CHECK(head->size == glm::uvec2{image->width, image->height});
    CHECK(head->decode_bytes >= image->channels - 1.0);
  }
}

TEST_CASE("A head that claims more pixels than its file can hold, or than are allowed, is refused before decoding") {
  const fs::path corpus = fs::path{LODESTONE_CORPUS} / "image";
  const auto refused = [](const Bytes& bytes, const std::string& name, std::string_view words) {
    INFO(name);
    const auto head = image_head(bytes, bytes.size(), name, 1ULL << 28);
    const auto image = decode_image(bytes, name);
    REQUIRE(!head);
    REQUIRE(!image);
    CHECK(to_line(head.error()) == to_line(image.error()));
    CHECK(head.error().message.find(words) != std::string::npos);
    CHECK(head.error().where == name);
  };
  Bytes png = bytes_of(corpus / "rgb.png");
  for (const std::uint32_t side : {16'000U, 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    put_big_endian(png, 16, side);
    put_big_endian(png, 20, side);
    refused(png, "wide.png", side == 16'000U ? "bytes can hold" : "PNG header is broken");
  }
  Bytes bmp = bytes_of(corpus / "small.bmp");
  bmp[20] = bmp[24] = 2;  // 131,072 more each way
  refused(bmp, "wide.bmp", "bytes can hold");
  refused(tga(9, 200), "wide.tga", "bytes can hold");
  Bytes gif = bytes_of(corpus / "small.gif");
  std::fill_n(gif.begin() + 6, 4, std::uint8_t{0xFF});
  refused(gif, "wide.gif", "more than the limit");
}

TEST_CASE("Pictures without packing that are cut off are refused, but for what fills their last row up") {
  Bytes bmp = bytes_of(fs::path{LODESTONE_CORPUS} / "image/small.bmp");
  const auto whole = decode_image(bmp, "a.bmp");
  REQUIRE(whole);
  for (const std::size_t cut : {4U, 20U, 90U}) {
    CHECK(decode_image(ByteSpan{bmp}.first(bmp.size() - cut), "a.bmp").error().code == ErrorCode::BadData);
  }
  for (const std::size_t cut : {1U, 20U, 200U}) {
    const Bytes plain = tga(9);
    CHECK(decode_image(ByteSpan{plain}.first(plain.size() - cut), "a.tga").error().code == ErrorCode::BadData);
  }
  // 3 pixels of 3 bytes and 3 to fill up in two rows.
  constexpr std::size_t head = 138;
  Bytes narrow(bmp.begin(), bmp.begin() + head);
  narrow[18] = 3;
  narrow[22] = 2;
  narrow.resize(head + std::size_t{2} * 12, 50);
  REQUIRE(decode_image(narrow, "narrow.bmp"));
  CHECK(decode_image(ByteSpan{narrow}.first(narrow.size() - 3), "narrow.bmp"));
  CHECK(!decode_image(ByteSpan{narrow}.first(narrow.size() - 4), "narrow.bmp"));
}

TEST_CASE("However a head is damaged, its size is one the file can hold, and that of the picture if there is one") {
  Rng rng{11};
  for (const auto& [name, bytes] : seeds()) {
    INFO(name);
    const auto size = static_cast<std::uint32_t>(bytes.size());
    for (int run = 0; run < 150; ++run) {
      Bytes damaged = bytes;
      if (run % 4 == 0) damaged.resize(rng.below(size));
      for (std::uint32_t changes = 1 + rng.below(4); changes > 0 && !damaged.empty(); --changes) {
        const auto head = static_cast<std::uint32_t>(std::min<std::size_t>(damaged.size(), 64));
        damaged[rng.below(head)] = static_cast<std::uint8_t>(rng.below(256));
      }
      const auto head = image_head(damaged, damaged.size(), name, most_pixels);
      const auto image = decode_image(damaged, name, most_pixels);
      if (image) REQUIRE(head);
      if (!head) continue;
      const double pixels = static_cast<double>(head->size.x) * head->size.y;
      CHECK(pixels >= 1.0);
      CHECK(pixels <= double{most_pixels});
      CHECK(pixels <= head->byte_pixels * static_cast<double>(damaged.size()));
      if (image) CHECK(head->size == glm::uvec2{image->width, image->height});
    }
  }
}

}  // namespace lodestone::test
