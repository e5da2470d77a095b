// SPDX-License-Identifier: MIT
#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "data.h"
#include "viewer/headless/headless.h"

namespace lodestone::test {
namespace {

// What MeshLab 2020.09 (with texture) and libmeshoptimizer 0.18 make of sol1151 with one image, the better of the two
// in each column: docs/outcrops.md, "Simplification (their Figure 16)".
struct Peers {
  double removed, hausdorff_ppm, rms_ppm, picture_rms;
};
constexpr Peers half{0.5, 7263.0, 103.0, 4.34};
constexpr Peers nine_tenths{0.9, 10183.0, 379.0, 10.09};

const std::pair<const char*, const char*> forms[] = {{"sol1151", "sol1151-wheel-measure.obj"},
                                                     {"sol1151_multitex", "sol1151_multitex.obj"}};

}  // namespace

TEST_CASE(
    "Real rock simplified as outcrops are is nearer to its shape and its photographs than by MeshLab or quadrics") {
  LODESTONE_REQUIRE_DATA(root);
  for (const auto& [name, file] : forms) {
    const auto loaded = read_mesh(root / "outcrops" / name / file, {.up = UpAxis::Y});
    REQUIRE(loaded);
    const Mesh& mesh = loaded->mesh;
    for (const Peers& peers : {half, nine_tenths}) {
      const auto target = static_cast<std::uint32_t>(mesh.triangle_count() * (1.0 - peers.removed));
      const auto ours = simplify(mesh, {.target_triangles = target, .uv_weight = 0.2, .sharpness_power = 2.0});
      REQUIRE(ours);
      CHECK(ours->mesh.triangle_count() <= target);
      const auto distance = compare(mesh, ours->mesh, {.samples = 200'000});
      REQUIRE(distance);
      CHECK(1e6 * distance->hausdorff_m / distance->diagonal_m < peers.hausdorff_ppm);
      CHECK(1e6 * distance->rms_m / distance->diagonal_m < peers.rms_ppm);
      const auto pictures =
          render::six_direction_rms(mesh, ours->mesh, 384, {.lighting = render::Lighting::Photograph});
      REQUIRE(pictures);
      CHECK(*pictures > 1.0);  // something is seen
      CHECK(*pictures < peers.picture_rms);
    }
  }
}

TEST_CASE("The real outcrop becomes a tileset without a seam, with one image and with nine") {
  LODESTONE_REQUIRE_DATA(root);
  for (const auto& [name, file] : forms) {
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
