// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "data.h"
#include "shapes.h"
#include "support.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

std::vector<std::uint8_t> picture(std::uint8_t shade) {
  return encode_png(Image{.width = 2, .height = 2, .channels = 1, .pixels = {shade, 0, 255, shade}}).value();
}

Mesh textured(const std::filesystem::path& folder) {
  Mesh mesh = grid(8, 8);
  spill(folder / "stone.png", picture(7));
  mesh.textures.push_back({.name = "stone",
                           .path = (folder / "stone.png").string(),
                           .mime_type = "image/png",
                           .encoded = std::make_shared<const Bytes>(picture(7)),
                           .image = nullptr});
  mesh.materials[0].texture = 0;
  return mesh;
}

}  // namespace

TEST_CASE("embedded textures travel in the file") {
  const auto folder = scratch_folder("lode-embed");
  const Model model = build(textured(folder), Placement::Optimal);
  (void)written(*model, folder / "a.lode");
  std::filesystem::remove(folder / "stone.png");
  const auto back = read_model(folder / "a.lode");
  REQUIRE(back.ok());
  CHECK(back.warnings().empty());
  REQUIRE(back.value()->data().textures.size() == 1);
  const Texture& texture = back.value()->data().textures[0];
  REQUIRE(texture.encoded != nullptr);
  CHECK(*texture.encoded == picture(7));
  CHECK(texture.mime_type == "image/png");
}

TEST_CASE("referenced textures are found beside the file, also after both moved") {
  const auto folder = scratch_folder("lode-refer");
  std::filesystem::create_directories(folder / "here");
  const Model model = build(textured(folder / "here"), Placement::Optimal);
  (void)written(*model, folder / "here" / "a.lode", {.embed_textures = false});
  std::filesystem::rename(folder / "here", folder / "there");
  const auto back = read_model(folder / "there" / "a.lode");
  REQUIRE(back.ok());
  CHECK(back.warnings().empty());
  REQUIRE(back.value()->data().textures[0].encoded != nullptr);
  CHECK(*back.value()->data().textures[0].encoded == picture(7));
  std::filesystem::remove(folder / "there" / "stone.png");
  const auto bare = read_model(folder / "there" / "a.lode");
  REQUIRE(bare.ok());
  CHECK(bare.warnings().size() == 1);
}

namespace {

// Left half red, right half blue, of noise that does not compress away.
Bytes large_picture(std::uint32_t channels) {
  Image image{.width = 256, .height = 128, .channels = channels, .pixels = {}};
  std::uint32_t noise = 1;
  for (std::uint32_t i = 0; i < image.width * image.height; ++i) {
    noise = noise * 1664525U + 1013904223U;
    const auto grain = static_cast<std::uint8_t>(noise >> 26);
    const bool left = i % image.width < image.width / 2;
    image.pixels.push_back(left ? static_cast<std::uint8_t>(192 + grain) : grain);
    image.pixels.push_back(grain);
    image.pixels.push_back(left ? grain : static_cast<std::uint8_t>(192 + grain));
    if (channels == 4) image.pixels.push_back(i < image.width * image.height / 2 ? 255 : 0);
  }
  return channels == 4 ? encode_png(image).value() : encode_jpeg(image, 95).value();
}

}  // namespace

TEST_CASE("the first bytes of a file already show the colours of its textures, all of them the pictures themselves") {
  const auto file = scratch_folder("lode-preview") / "a.lode";
  Mesh mesh = sphere(60, 80);
  mesh.vertices.uvs.resize(mesh.vertex_count(), glm::vec2{0.5F});
  const std::vector<Bytes> pictures{large_picture(3), picture(7), large_picture(4)};
  for (const Bytes& bytes : pictures) {
    mesh.textures.push_back({.name = "made", .encoded = std::make_shared<const Bytes>(bytes)});
  }
  mesh.materials[0].texture = 0;
  const Model model = build(mesh, Placement::Subset);
  const Bytes whole = written(*model, file);
  const auto part = read_model(file, {.max_bytes = whole.size() / 4});
  REQUIRE(part.ok());
  CHECK(part.value()->record_count() < model->record_count());
  const auto& textures = part.value()->data().textures;
  CHECK(*textures[1].encoded == pictures[1]);  // too small to be made smaller
  CHECK(textures[0].mime_type == "image/jpeg");
  CHECK(textures[2].mime_type == "image/png");
  for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
    REQUIRE(textures[i].encoded != nullptr);
    CHECK(textures[i].encoded->size() < 8192);
    const auto small = decode_image(*textures[i].encoded, "copy");
    REQUIRE(small.ok());
    CHECK(small->width == 64);
    CHECK(small->height == 32);
    const std::uint8_t* left = small->at(12, 8);
    const std::uint8_t* right = small->at(52, 8);
    CHECK((left[0] > 180 && left[2] < 80));
    CHECK((right[2] > 180 && right[0] < 80));
    if (i == 2) CHECK((left[3] == 255 && small->at(12, 24)[3] == 0));
  }
  const auto all = read_model(file);
  REQUIRE(all.ok());
  for (std::size_t i = 0; i < pictures.size(); ++i) CHECK(*all.value()->data().textures[i].encoded == pictures[i]);
}
