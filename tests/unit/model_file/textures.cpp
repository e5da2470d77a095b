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
