// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/edge_collapse.h>
#include <lodestone/generate.h>

namespace lodestone {
namespace {

GenerateOptions options_of(std::uint32_t triangles) {
  return {.triangles = triangles, .texture_size_px = 16, .pixels = Pixels::Skip};
}

std::vector<std::pair<std::string, Result<Mesh>>> all_kinds() {
  std::vector<std::pair<std::string, Result<Mesh>>> kinds;
  for (const Roof roof : {Roof::Flat, Roof::Gable, Roof::Hip, Roof::Spire}) {
    kinds.emplace_back("house, roof " + std::to_string(static_cast<int>(roof)),
                       generate_house({options_of(4'000), roof}));
  }
  kinds.emplace_back("street", generate_street(options_of(30'000)));
  kinds.emplace_back("outcrop", generate_outcrop(options_of(4'000)));
  kinds.emplace_back("terrain", generate_terrain(options_of(4'000)));
  return kinds;
}

TEST_CASE("every generated kind is exact, monotone and in-use consistent, and ends in its source") {
  for (const auto& [kind, mesh] : all_kinds()) {
    CAPTURE(kind);
    REQUIRE(mesh.ok());
    const auto built = build_by_edge_collapse(*mesh);
    REQUIRE(built.ok());
    const ModelReport report = validate(*built->model);
    CHECK(report.fault.empty());
    CHECK((report.exact && report.monotone && report.in_use_consistent));
    CHECK(compare_with_source(*built->model, *mesh) == "");
    CHECK(built->model->info(0).triangles * 20 < mesh->triangle_count());
  }
}

}  // namespace
}  // namespace lodestone
