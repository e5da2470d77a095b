// SPDX-License-Identifier: MIT
// The 49 surveyed buildings, whole and damaged.
#include <lodestone/facet_shift.h>
#include <lodestone/formats.h>
#include <lodestone/metrics.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "blocks.h"
#include "checked_model.h"
#include "data.h"
#include "directions.h"

namespace lodestone {
namespace {

std::vector<std::filesystem::path> building_files(const std::filesystem::path& root) {
  std::vector<std::filesystem::path> files;
  for (const auto& folder : std::filesystem::directory_iterator{root / "buildings"}) {
    const auto file = folder.path() / (folder.path().filename().string() + ".obj");
    if (std::filesystem::exists(file) && folder.path().filename() != "street_all") files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST_CASE("all real buildings build exactly, and the richer ones keep their planes and their shape") {
  LODESTONE_REQUIRE_DATA(root);
  constexpr std::array<double, 5> ratios{0.5, 0.2, 0.1, 0.05, 0.02};
  std::array<double, 5> deviation_deg{};
  std::array<double, 5> rms_ppm{};
  std::array<double, 5> leaning_walls{};
  std::array<double, 5> leaning_others{};
  std::uint32_t rich = 0;
  for (const auto& file : building_files(root)) {
    CAPTURE(file.string());
    const auto loaded = read_mesh(file, {.textures = LoadTextures::Reference});
    REQUIRE(loaded.ok());
    const Mesh& source = loaded->mesh;
    const auto built = build_by_facet_shift(source);
    REQUIRE(built.ok());
    test::check_model(*built->model, source);
    CHECK(built->report.reached_block);
    test::check_block(built->model->extract(0));
    for (Level level = 0; level < built->model->record_count(); level += built->model->record_count() / 4 + 1) {
      CHECK_FALSE(test::grows(source, built->model->extract(level), built->model->error_m(level)));
    }
    if (source.triangle_count() < 1000) continue;
    ++rich;
    const CharacteristicSurfaces directions = characteristic_surfaces(source);
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      const auto wanted = static_cast<std::uint32_t>(ratios[i] * source.triangle_count());
      const Mesh level = built->model->extract(built->model->level_of_triangles(wanted));
      const auto distance = compare(source, level, {.samples = 20'000});
      REQUIRE(distance.ok());
      deviation_deg[i] += glm::degrees(distance->normal_deviation_rad);
      rms_ppm[i] += 1e6 * distance->rms_m / distance->diagonal_m;
      const test::Leaning leaning = test::leaning(directions, level);
      leaning_walls[i] += leaning.walls_m2 / leaning.area_m2;
      leaning_others[i] += leaning.others_m2 / leaning.area_m2;
      // The claim bounds what a sampler finds.
      CHECK(distance->p999_m <= built->model->error_m(built->model->level_of_triangles(wanted)) + 1e-3);
    }
  }
  REQUIRE(rich == 30);
  constexpr std::array<double, 5> most_deg{0.02, 0.04, 0.06, 0.13, 0.8};
  constexpr std::array<double, 5> most_ppm{120.0, 270.0, 490.0, 1180.0, 3400.0};
  // Of the area: walls over half a degree off the upright, roofs and others over a degree off their direction.
  constexpr std::array<double, 5> most_walls{5e-4, 1e-3, 1e-3, 2e-3, 8e-3};
  constexpr std::array<double, 5> most_others{8e-4, 2e-3, 2e-3, 4e-3, 2e-2};
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    CAPTURE(ratios[i]);
    CHECK(deviation_deg[i] / rich < most_deg[i]);
    CHECK(rms_ppm[i] / rich < most_ppm[i]);
    CHECK(leaning_walls[i] / rich < most_walls[i]);
    CHECK(leaning_others[i] / rich < most_others[i]);
  }
}

// Turns, re-points, moves, flattens, drops and repeats faces of a real building at random, and shakes its points.
void damage(Mesh& mesh, std::mt19937& random) {
  const auto pick = [&](std::size_t count) { return std::uniform_int_distribution<std::size_t>{0, count - 1}(random); };
  const auto move_face = [&](std::size_t to, std::size_t from) {
    std::copy_n(mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * from), 3,
                mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * to));
  };
  for (int i = 0; i < 90; ++i) {
    const std::size_t face = pick(mesh.triangle_count());
    const std::size_t f = 3 * face;
    switch (pick(7)) {
      case 0:
        std::swap(mesh.indices[f], mesh.indices[f + 1]);
        break;
      case 1:
        mesh.indices[f] = static_cast<VertexId>(pick(mesh.vertex_count()));
        break;
      case 2:
        mesh.vertices.positions[mesh.indices[f]] += glm::vec3{0.0F, 0.0F, 3.0F};
        break;
      case 3:
        mesh.indices[f + 1] = mesh.indices[f];
        break;
      case 4:  // goes, and the last one takes its place with its own looks
        move_face(face, mesh.triangle_count() - 1);
        mesh.indices.resize(mesh.indices.size() - 3);
        if (!mesh.face_materials.empty()) mesh.face_materials.pop_back();
        if (!mesh.face_features.empty()) mesh.face_features.pop_back();
        break;
      case 5:  // the same face over another one
        move_face(face, pick(mesh.triangle_count()));
        break;
      default: {
        const auto shake = [&] { return 0.002F * static_cast<float>(pick(11)) - 0.01F; };
        mesh.vertices.positions[mesh.indices[f]] += glm::vec3{shake(), shake(), shake()};
        break;
      }
    }
  }
}

TEST_CASE("a damaged building gives a valid model") {
  LODESTONE_REQUIRE_DATA(root);
  for (const char* id : {"4018208", "4018156", "4018106"}) {
    const auto loaded =
        read_mesh(root / "buildings" / id / (std::string{id} + ".obj"), {.textures = LoadTextures::Reference});
    REQUIRE(loaded.ok());
    for (std::uint32_t seed = 1; seed <= 5; ++seed) {
      CAPTURE(id, seed);
      Mesh mesh = loaded->mesh;
      std::mt19937 random{seed};
      damage(mesh, random);
      const auto built = build_by_facet_shift(mesh);
      REQUIRE(built.ok());
      test::check_model(*built->model, mesh);
      mesh.vertices.positions[0].x = std::numeric_limits<float>::quiet_NaN();
      CHECK_FALSE(build_by_facet_shift(mesh).ok());
    }
  }
}

}  // namespace
}  // namespace lodestone
