// SPDX-License-Identifier: MIT
#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>
#include <lodestone/generate.h>
#include <lodestone/metrics.h>

#include <catch2/catch.hpp>
#include <random>

#include "data.h"
#include "positions_only.h"
#include "shapes.h"

namespace lodestone {
namespace {

// The claimed error times this bounds the 99.9th percentile of the sampled two-sided distance.
constexpr double honesty = 3.0;

using test::positions_only;

EdgeCollapseOptions down_to(double share, const Mesh& mesh) {
  EdgeCollapseOptions options;
  options.target_triangles = static_cast<std::uint32_t>(share * mesh.triangle_count());
  return options;
}

TEST_CASE("the claimed error bounds the measured one within the stated factor") {
  for (const auto& [name, mesh] :
       {test::NamedMesh{"sphere", test::sphere(60, 90)}, test::NamedMesh{"grid", test::grid(60, 50)},
        test::NamedMesh{"seamed grid", test::seamed_grid(60, 50)}, test::NamedMesh{"fins", test::fins(7)},
        test::NamedMesh{"scattered cubes", test::scattered_cubes(60, 3)}}) {
    for (const double share : {0.5, 0.2, 0.05}) {
      CAPTURE(name, share);
      const auto result = simplify(mesh, down_to(share, mesh));
      REQUIRE(result.ok());
      const auto distance = compare(mesh, result->mesh, {.samples = 50'000});
      REQUIRE(distance.ok());
      CHECK(distance->p999_m <= honesty * result->error_m + 1e-6 * distance->diagonal_m);
    }
  }
}

TEST_CASE("a closed manifold stays one, whatever the placement") {
  const Mesh mesh = test::sphere(40, 60);
  for (const Placement placement :
       {Placement::Optimal, Placement::OnEdge, Placement::Midpoint, Placement::EndPoint, Placement::Subset}) {
    CAPTURE(static_cast<int>(placement));
    EdgeCollapseOptions options = down_to(0.05, mesh);
    options.placement = placement;
    const auto result = simplify(mesh, options);
    REQUIRE(result.ok());
    CHECK(result->report.target_reached);
    const MeshReport report = inspect(result->mesh);
    CHECK(report.boundary_edges == 0);
    CHECK(report.non_manifold_edges == 0);
    for (std::size_t i = 0; i < result->mesh.indices.size(); i += 3) {  // the centre is inside: no face is flipped
      const auto& p = result->mesh.vertices.positions;
      const glm::vec3 a = p[result->mesh.indices[i]];
      const glm::vec3 b = p[result->mesh.indices[i + 1]];
      const glm::vec3 c = p[result->mesh.indices[i + 2]];
      CHECK(glm::dot(glm::cross(b - a, c - a), a + b + c) > 0.0F);
    }
  }
}

TEST_CASE("no face turns over where every place costs the same") {
  Mesh mesh = test::positions_only(test::grid(40, 40, 0.0F));
  std::mt19937 random{3};
  std::uniform_real_distribution<float> aside{-0.15F, 0.15F};
  const float step_m = mesh.vertices.positions[1].x - mesh.vertices.positions[0].x;
  for (auto& p : mesh.vertices.positions) p += step_m * glm::vec3{aside(random), aside(random), 0.0F};
  for (const Placement placement :
       {Placement::Optimal, Placement::OnEdge, Placement::Midpoint, Placement::EndPoint, Placement::Subset}) {
    for (const double share : {0.5, 0.2, 0.05}) {
      CAPTURE(static_cast<int>(placement), share);
      EdgeCollapseOptions options = down_to(share, mesh);
      options.placement = placement;
      const auto result = simplify(mesh, options);
      REQUIRE(result.ok());
      const auto& p = result->mesh.vertices.positions;
      for (std::size_t i = 0; i < result->mesh.indices.size(); i += 3) {
        const glm::vec3 a = p[result->mesh.indices[i]];
        const glm::vec3 ab = p[result->mesh.indices[i + 1]] - a, ac = p[result->mesh.indices[i + 2]] - a;
        REQUIRE(ab.x * ac.y - ab.y * ac.x >= 0.0F);
      }
    }
  }
}

// Six times the volume that a closed surface encloses.
double volume_of(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const auto at = [&](std::size_t c) { return glm::dvec3{mesh.vertices.positions[mesh.indices[i + c]]}; };
    sum += glm::dot(at(0), glm::cross(at(1), at(2)));
  }
  return sum;
}

TEST_CASE("a closed surface keeps its volume") {
  const Mesh mesh = test::positions_only(test::sphere(60, 90));
  const auto result = simplify(mesh, down_to(0.1, mesh));
  REQUIRE(result.ok());
  const double kept = volume_of(result->mesh) / volume_of(mesh);
  CHECK(std::fabs(kept - 1.0) < 1e-4);
}

TEST_CASE("uvs count where they are to be kept") {
  Mesh mesh = test::grid(60, 60, 0.0F);
  const auto look = [](const glm::vec3& p) { return glm::vec2{p.x + 0.1F * std::sin(12.0F * p.x), p.y * p.y}; };
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) mesh.vertices.uvs[v] = look(mesh.vertices.positions[v]);
  const auto off = [&](Attributes attributes) {
    EdgeCollapseOptions options = down_to(0.1, mesh);
    options.attributes = attributes;
    const auto result = simplify(mesh, options);
    REQUIRE(result.ok());
    double sum = 0.0;
    const Mesh& made = result->mesh;
    for (std::size_t i = 0; i < made.indices.size(); i += 3) {
      glm::vec3 place{0.0F};
      glm::vec2 uv{0.0F};
      for (std::size_t c = 0; c < 3; ++c) {
        place += made.vertices.positions[made.indices[i + c]] / 3.0F;
        uv += made.vertices.uvs[made.indices[i + c]] / 3.0F;
      }
      sum += glm::distance(uv, look(place));
    }
    return sum / made.triangle_count();
  };
  const double kept = off(Attributes::All), free = off(Attributes::None);
  CAPTURE(kept, free);
  CHECK(kept < 0.8 * free);
}

TEST_CASE("flat meshes reduce to next to nothing without error, faceted and unwelded ones too") {
  for (const Mesh& mesh : {test::grid(16, 16, 0.0F), test::unwelded(test::grid(16, 16, 0.0F))}) {
    EdgeCollapseOptions options;
    options.max_error_m = 1e-5;
    const auto result = simplify(mesh, options);
    REQUIRE(result.ok());
    CHECK(result->mesh.triangle_count() <= 10);
    CHECK(bounds(result->mesh).diagonal_m() == Approx(bounds(mesh).diagonal_m()));
  }
}

TEST_CASE("no hole opens at a seam or between materials") {
  const Mesh mesh = test::seamed_grid(40, 30);
  for (const double share : {0.5, 0.1, 0.03}) {
    const auto result = simplify(mesh, down_to(share, mesh));
    REQUIRE(result.ok());
    const Mesh welded = positions_only(result->mesh);
    // One rectangle without holes: V - E + F = 1 over its corner points.
    const MeshReport report = inspect(welded);
    CHECK(report.non_manifold_edges == 0);
    const auto edges = (3 * welded.triangle_count() + report.boundary_edges) / 2;
    CHECK(static_cast<int>(report.corner_points) - static_cast<int>(edges) +
              static_cast<int>(welded.triangle_count()) ==
          1);
    const auto distance = compare(mesh, result->mesh, {.samples = 20'000});
    REQUIRE(distance.ok());
    CHECK(distance->p999_m <= honesty * result->error_m + 1e-6);
  }
}

TEST_CASE("frozen vertices and locked borders stay where they are") {
  const Mesh mesh = test::grid(30, 30);
  EdgeCollapseOptions options = down_to(0.2, mesh);
  options.borders = Borders::Lock;
  options.frozen.assign(mesh.vertex_count(), 0);
  options.frozen[15 * 31 + 15] = 1;
  const auto result = simplify(mesh, options);
  REQUIRE(result.ok());
  CHECK(inspect(result->mesh).boundary_edges == 120);
  const auto& p = result->mesh.vertices.positions;
  CHECK(std::count(p.begin(), p.end(), mesh.vertices.positions[15 * 31 + 15]) == 1);
}

TEST_CASE("sharp edges are kept as features") {
  const Mesh mesh = test::cube();
  EdgeCollapseOptions options;
  options.sharp_edge_rad = 1.0;
  const auto result = simplify(mesh, options);
  REQUIRE(result.ok());
  CHECK(result->mesh.triangle_count() == mesh.triangle_count());
  CHECK(result->report.locked_by_frozen > 0.9);
  CHECK_FALSE(result->report.sentence.empty());
}

TEST_CASE("subset placement moves no vertex, seams and unwelded faces included") {
  std::vector<test::NamedMesh> meshes = test::mesh_families();
  meshes.push_back({"smooth sphere", test::sphere(30, 40)});
  meshes.push_back({"large unwelded sphere", test::unwelded(test::sphere(30, 40))});
  meshes.push_back({"large seamed grid", test::seamed_grid(40, 30)});
  const auto house = generate_house({GenerateOptions{.triangles = 4'000, .texture_size_px = 16}});
  REQUIRE(house.ok());
  meshes.push_back({"house", *house});
  for (const auto& [name, mesh] : meshes) {
    CAPTURE(name);
    EdgeCollapseOptions options;
    options.placement = Placement::Subset;
    const auto built = build_by_edge_collapse(mesh, options);
    REQUIRE(built.ok());
    CHECK(built->model->data().value_xor.empty());
    CHECK(validate(*built->model).fault.empty());
    if (mesh.triangle_count() > 1000) CHECK(built->model->info(0).triangles < mesh.triangle_count() / 20);
  }
}

TEST_CASE("a limit on the error is kept") {
  const Mesh mesh = test::sphere(60, 90);
  EdgeCollapseOptions options;
  options.max_error_m = 0.002;
  const auto result = simplify(mesh, options);
  REQUIRE(result.ok());
  CHECK(result->error_m <= 0.002);
  CHECK(result->mesh.triangle_count() < mesh.triangle_count() / 2);
}

TEST_CASE("many small parts do not keep a target from being reached, unless they must not vanish") {
  const Mesh mesh = test::scattered_cubes(40, 7);
  EdgeCollapseOptions options = down_to(0.05, mesh);
  const auto pruned = simplify(mesh, options);
  REQUIRE(pruned.ok());
  CHECK(pruned->report.target_reached);
  options.prune_parts = false;
  const auto kept = simplify(mesh, options);
  REQUIRE(kept.ok());
  CHECK_FALSE(kept->report.target_reached);
  CHECK_FALSE(kept->report.sentence.empty());
}

TEST_CASE("triangles that hang together by a point alone go too, at the price of their reach") {
  constexpr std::uint32_t count = 7;
  Mesh mesh;
  mesh.materials.emplace_back();
  mesh.vertices.positions.emplace_back(0.0F, 0.0F, 0.0F);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = 1.0F + 0.1F * static_cast<float>(i);
    mesh.vertices.positions.emplace_back(x, 0.3F * static_cast<float>(i), 0.0F);
    mesh.vertices.positions.emplace_back(x, 0.3F * static_cast<float>(i), 1.0F);
    mesh.indices.insert(mesh.indices.end(), {0, 2 * i + 1, 2 * i + 2});
  }
  for (const std::uint32_t target : {3U, 1U}) {
    const auto result = simplify(mesh, {.target_triangles = target});
    REQUIRE(result.ok());
    CHECK(result->report.target_reached);
    const auto distance = compare(mesh, result->mesh, {.samples = 20'000});
    REQUIRE(distance.ok());
    CHECK(distance->p999_m <= result->error_m);
  }
  const auto built = build_by_edge_collapse(mesh);
  REQUIRE(built.ok());
  CHECK(validate(*built->model).fault.empty());
}

TEST_CASE("keeping looks costs a generated house and outcrop little of their shape") {
  const auto near = [](const Mesh& mesh, double rms_ppm) {
    const auto result = simplify(mesh, down_to(0.5, mesh));
    REQUIRE(result.ok());
    const auto distance = compare(mesh, result->mesh, {.samples = 50'000});
    REQUIRE(distance.ok());
    CHECK(distance->rms_m * 1e6 / distance->diagonal_m < rms_ppm);
  };
  const auto house = generate_house({GenerateOptions{.triangles = 20'000, .texture_size_px = 16}});
  REQUIRE(house.ok());
  near(*house, 300.0);
  const auto outcrop = generate_outcrop({.triangles = 40'000, .texture_size_px = 16});
  REQUIRE(outcrop.ok());
  near(*outcrop, 130.0);
}

TEST_CASE("real buildings reach every target and stay near") {
  LODESTONE_REQUIRE_DATA(root);
  for (const char* id : {"4018215", "4018267", "4018210"}) {
    const auto loaded = read_mesh(root / "buildings" / id / (std::string{id} + ".obj"));
    REQUIRE(loaded.ok());
    const Mesh mesh = positions_only(loaded->mesh);
    for (const double share : {0.5, 0.1, 0.02}) {
      CAPTURE(id, share);
      EdgeCollapseOptions options = down_to(share, mesh);
      options.attributes = Attributes::None;
      const auto result = simplify(mesh, options);
      REQUIRE(result.ok());
      CHECK(result->report.target_reached);
      const auto distance = compare(mesh, result->mesh, {.samples = 50'000});
      REQUIRE(distance.ok());
      CHECK(distance->p999_m <= honesty * result->error_m);
      if (share == 0.1) CHECK(distance->rms_m < 1e-3 * distance->diagonal_m);
    }
  }
}

TEST_CASE("real buildings with their looks stay near: borders of materials do not keep cheap collapses waiting") {
  LODESTONE_REQUIRE_DATA(root);
  const auto loaded = read_mesh(root / "buildings" / "4018210" / "4018210.obj");
  REQUIRE(loaded.ok());
  for (const auto& [share, rms_ppm] : {std::pair{0.5, 150.0}, std::pair{0.1, 1'000.0}, std::pair{0.02, 2'500.0}}) {
    CAPTURE(share);
    const auto result = simplify(loaded->mesh, down_to(share, loaded->mesh));
    REQUIRE(result.ok());
    CHECK(result->report.target_reached);
    const auto distance = compare(loaded->mesh, result->mesh, {.samples = 50'000});
    REQUIRE(distance.ok());
    CHECK(distance->rms_m * 1e6 / distance->diagonal_m < rms_ppm);
    CHECK(distance->p999_m <= honesty * result->error_m);
  }
}

TEST_CASE("the claim holds for a real building of a dozen triangles: a vertex thrown far out counts") {
  LODESTONE_REQUIRE_DATA(root);
  const auto loaded = read_mesh(root / "buildings" / "4018302" / "4018302.obj");
  REQUIRE(loaded.ok());
  const Mesh mesh = positions_only(loaded->mesh);
  for (const double share : {0.1, 0.05, 0.02}) {
    CAPTURE(share);
    const auto result = simplify(mesh, down_to(share, mesh));
    REQUIRE(result.ok());
    const auto distance = compare(mesh, result->mesh, {.samples = 20'000});
    REQUIRE(distance.ok());
    CHECK(distance->p999_m <= honesty * result->error_m);
  }
}

TEST_CASE("a real building with its looks builds exactly down to its end") {
  LODESTONE_REQUIRE_DATA(root);
  const auto loaded = read_mesh(root / "buildings" / "4018115" / "4018115.obj");
  REQUIRE(loaded.ok());
  const auto built = build_by_edge_collapse(loaded->mesh);
  REQUIRE(built.ok());
  const ModelReport report = validate(*built->model);
  CHECK(report.fault.empty());
  CHECK(compare_with_source(*built->model, loaded->mesh).empty());
}

TEST_CASE("a real outcrop with its uv kept stays within the figures of the best geometry-only peer") {
  LODESTONE_REQUIRE_DATA(root);
  const auto loaded = read_mesh(root / "outcrops" / "sol1151" / "sol1151-wheel-measure.obj");
  REQUIRE(loaded.ok());
  for (const auto& [share, rms_ppm] : {std::pair{0.2, 205.0}, std::pair{0.02, 887.0}}) {
    const auto result = simplify(loaded->mesh, down_to(share, loaded->mesh));
    REQUIRE(result.ok());
    const auto distance = compare(loaded->mesh, result->mesh, {.samples = 100'000});
    REQUIRE(distance.ok());
    CHECK(distance->rms_m * 1e6 / distance->diagonal_m < rms_ppm);
    CHECK(distance->p999_m <= honesty * result->error_m);
  }
}

}  // namespace
}  // namespace lodestone
