// SPDX-License-Identifier: MIT
#include <viewer/headless/headless.h>

#include <catch2/catch.hpp>

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>
#include <lodestone/generate.h>

#include "data.h"

using namespace lodestone;
using namespace lodestone::render;

namespace {

// Means of 8 x 8 pixels: what colours a picture shows, whatever its detail.
std::vector<glm::dvec3> colours(const Mesh& mesh) {
  RenderOptions options{.width_px = 128, .height_px = 128, .supersample = 1};
  options.look.background = Background::White;
  const auto picture = render_mesh(mesh, options);
  REQUIRE(picture.ok());
  std::vector<glm::dvec3> means(16 * 16, glm::dvec3{0.0});
  for (std::uint32_t y = 0; y < 128; ++y) {
    for (std::uint32_t x = 0; x < 128; ++x) {
      const std::uint8_t* p = picture->image.at(x, y);
      means[y / 8 * 16 + x / 8] += glm::dvec3{p[0], p[1], p[2]} / 64.0;
    }
  }
  return means;
}

double difference(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::length(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

}  // namespace

TEST_CASE("a prefix of a house's file, far from its textures, is drawn in the colours of the whole") {
  HouseOptions options;
  options.triangles = 6000;
  options.textures = 4;
  options.texture_size_px = 256;
  const auto house = generate_house(options);
  REQUIRE(house.ok());
  const auto built = build_by_edge_collapse(*house, {});
  REQUIRE(built.ok());
  const ProgressiveModel& model = *built->model;
  const auto file = test::scratch_folder("previews") / "house.lode";
  const auto bytes = write_model(model, file);
  REQUIRE(bytes.ok());
  std::shared_ptr<const ProgressiveModel> part;
  for (std::uint64_t tenths = 1; tenths < 10 && (part == nullptr || part->record_count() < 1000); ++tenths) {
    part = read_model(file, {.max_bytes = bytes.value() * tenths / 10}).value();
  }
  const Level level = part->record_count();
  REQUIRE(level >= 1000);
  Mesh early = part->extract(level);
  for (std::size_t i = 0; i < early.textures.size(); ++i) {
    CHECK(early.textures[i].encoded->size() < 8192);  // not one of them is there in full
  }
  const auto seen = colours(early);
  const auto wanted = colours(model.extract(level));
  early.textures.clear();
  for (Material& material : early.materials) material.texture = none;
  CAPTURE(difference(colours(early), wanted));
  CHECK(difference(seen, wanted) < 0.1 * difference(colours(early), wanted));
}
