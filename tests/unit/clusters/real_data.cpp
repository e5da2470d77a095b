// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>

#include <lodestone/clusters.h>
#include <lodestone/formats.h>
#include <lodestone/generate.h>
#include <lodestone/metrics.h>

#include "cut_support.h"
#include "data.h"

namespace lodestone::test {
namespace {

// Every promise, on one model.
void require_sound(const Mesh& mesh, int cameras, int labellings) {
  const auto graph = build_cluster_graph(mesh);
  REQUIRE(graph.ok());
  REQUIRE(validate(graph->graph).ok());
  REQUIRE(graph->roots.size() == 1);
  CHECK(graph->roots[0].cause.empty());
  CHECK(extract(*graph, leaves(*graph)).triangle_count() == mesh.triangle_count());
  CHECK(changed_border_edges(*graph) == 0);
  for (const FaultCounts& faults : {try_cuts(*graph, cameras, 5), try_labellings(*graph, labellings, 6)}) {
    CHECK(faults.cracks == 0);
    CHECK(faults.morphed_cracks == 0);
  }
  CHECK(graph->levels[1].mean_fill >= 115.0);
}

// Gives every third face vertices and uvs of its own, as exporters of photogrammetry do.
void cut_third_loose(Mesh& mesh) {
  for (std::uint32_t f = 0; f < mesh.triangle_count(); f += 3) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const VertexId v = mesh.indices[3 * f + k];
      mesh.indices[3 * f + k] = mesh.vertices.size();
      mesh.vertices.positions.push_back(glm::vec3{mesh.vertices.positions[v]});
      if (!mesh.vertices.normals.empty()) mesh.vertices.normals.push_back(glm::vec3{mesh.vertices.normals[v]});
      mesh.vertices.uvs.push_back(mesh.vertices.uvs[v] + glm::vec2{0.01F * static_cast<float>(f % 7), 0.0F});
    }
  }
}

}  // namespace

TEST_CASE("real scans, outcrops, geology and a building: one root, no cracks") {
  LODESTONE_REQUIRE_DATA(root);
  for (const char* name : {"meshes/koala/koala.obj", "meshes/boat/boat.obj", "geology/obj/geomodel3d.obj",
                           "outcrops/sol1151/sol1151-wheel-measure.obj",
                           "outcrops/sol1151_multitex/sol1151_multitex.obj", "buildings/4018210/4018210.obj"}) {
    INFO(name);
    const auto loaded = read_mesh(root / name, {.textures = LoadTextures::Reference});
    REQUIRE(loaded.ok());
    require_sound(loaded->mesh, 1000, 100);
  }
}

TEST_CASE("a generated outcrop with many charts, and with a third of its faces cut loose: one root, no cracks") {
  auto mesh = generate_outcrop({.triangles = 30'000, .texture_size_px = 16, .charts = 60, .pixels = Pixels::Skip});
  REQUIRE(mesh.ok());
  require_sound(*mesh, 20, 10);
  cut_third_loose(*mesh);
  require_sound(*mesh, 20, 10);
}

// Minutes: run by scripts/long_checks.sh, which fetches the dragon and says where it is.
TEST_CASE("the dragon and a million triangles, cut loose or not: a thousand cameras, a hundred labellings", "[.]") {
  if (const char* dragon = std::getenv("LODESTONE_DRAGON"); dragon != nullptr && *dragon != '\0') {
    const auto loaded = read_mesh(dragon);
    REQUIRE(loaded.ok());
    require_sound(loaded->mesh, 1000, 100);
  } else {
    WARN("skipped for the dragon: LODESTONE_DRAGON does not name its file");
  }
  auto mesh = generate_outcrop({.triangles = 1'000'000, .texture_size_px = 16, .charts = 300, .pixels = Pixels::Skip});
  REQUIRE(mesh.ok());
  require_sound(*mesh, 1000, 100);
  cut_third_loose(*mesh);
  require_sound(*mesh, 1000, 100);
}

TEST_CASE("the error of a level bounds what sampling finds, 99.9 % of it by itself and all of it twice over") {
  auto mesh = generate_outcrop({.triangles = 30'000, .texture_size_px = 16, .pixels = Pixels::Skip});
  REQUIRE(mesh.ok());
  const auto graph = build_cluster_graph(*mesh);
  REQUIRE(graph.ok());
  View far;
  far.eye = graph->graph.groups[0].bounds.center - glm::dvec3{0.0, 1e7, 0.0};
  CutScratch scratch;
  std::vector<NodeId> cut;
  for (std::size_t i = 1; i < graph->levels.size(); i += 2) {
    const double claimed_m = graph->levels[i].error_m;
    const CutOptions options{.error_px = claimed_m * focal_px(far) / 1e7 * 1.001, .culling = Culling::None};
    select_cut(graph->graph, far, options, scratch, cut);
    const auto found = compare(*mesh, extract(*graph, cut), {.samples = 20'000});
    REQUIRE(found.ok());
    INFO("level " << i);
    CHECK(found->p999_m <= claimed_m);
    CHECK(found->hausdorff_m <= 2.0 * claimed_m);
  }
}

}  // namespace lodestone::test
