// SPDX-License-Identifier: MIT
#pragma once

#include <catch2/catch.hpp>

#include <lodestone/generate.h>

namespace lodestone::test {

// A generated house whose textures have no pixels.
[[nodiscard]] inline Mesh small_house(std::uint32_t triangles, Roof roof = Roof::Gable) {
  HouseOptions options;
  options.triangles = triangles;
  options.roof = roof;
  options.pixels = Pixels::Skip;
  auto house = generate_house(options);
  REQUIRE(house.ok());
  return std::move(*house);
}

}  // namespace lodestone::test
