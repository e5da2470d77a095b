// SPDX-License-Identifier: MIT
#include <lodestone/formats.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "data.h"

namespace lodestone::test {

TEST_CASE("The real outcrop becomes a tileset without a seam, with one image and with nine") {
  LODESTONE_REQUIRE_DATA(root);
  for (const auto& [name, file] :
       {std::pair{"sol1151", "sol1151-wheel-measure.obj"}, {"sol1151_multitex", "sol1151_multitex.obj"}}) {
    const std::filesystem::path source = root / "outcrops" / name / file;
    auto loaded = read_mesh(source, {.up = UpAxis::Y, .textures = LoadTextures::Reference});
    REQUIRE(loaded);
    const MeshReport report = inspect(loaded->mesh);
    const std::uint32_t triangles = loaded->mesh.triangle_count();
    const std::filesystem::path folder = scratch_folder(std::string{"tiles_"} + name);
    const auto written = write_outcrop(std::move(loaded->mesh), folder, {});
    REQUIRE(written);
    CHECK(written->levels.size() > 2);
    CHECK(written->levels.front().open_edges == report.boundary_edges);
    const auto check = check_tileset(folder / "tileset.json");
    REQUIRE(check);
    CHECK(check->triangles == triangles);
    CHECK(check->seams_open == 0);
    CHECK(check->faults.empty());
  }
}

}  // namespace lodestone::test
