// SPDX-License-Identifier: MIT
// Cluster graphs drawn from their pages: the vertex shader against the plain function, and what a flight shows.
#include <lodestone/cluster_file.h>
#include <lodestone/generate.h>
#include <lodestone/metrics.h>
#include <viewer/headless/headless_clusters.h>
#include <viewer/headless/stage.h>
#include <viewer/render/cluster_scene.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "data.h"
#include "shapes.h"

using namespace lodestone;
using namespace lodestone::render;

namespace {

std::filesystem::path written(const Mesh& mesh, const std::string& name) {
  const auto graph = build_cluster_graph(mesh);
  REQUIRE(graph.ok());
  const auto path = test::scratch_folder(name) / "a.lodg";
  REQUIRE(write_cluster_graph(*graph, path).ok());
  return path;
}

std::shared_ptr<const ClusterFile> opened(const std::filesystem::path& path) {
  auto file = ClusterFile::open(path);
  REQUIRE(file.ok());
  return *file;
}

std::shared_ptr<const ClusterFile> file_of(const Mesh& mesh, const std::string& name) {
  return opened(written(mesh, name));
}

Mesh outcrop(std::uint32_t triangles) {
  auto mesh = generate_outcrop({.triangles = triangles, .texture_size_px = 64});
  REQUIRE(mesh.ok());
  return std::move(mesh).value();
}

// Root mean square over the pixels that differ from white in either.
double object_rms(const Image& a, const Image& b) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); i += 3) {
    bool white = true;
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      white = white && a.pixels[i + k] == 255 && b.pixels[i + k] == 255;
      square += std::pow(double(a.pixels[i + k]) - double(b.pixels[i + k]), 2.0);
    }
    if (white) continue;
    sum += square;
    count += 3.0;
  }
  REQUIRE(count > 10'000.0);
  return std::sqrt(sum / count);
}

// From far to near, towards the middle of the box.
View flying_in(const Box& bounds, double share) {
  const double radius_m = 0.5 * bounds.diagonal_m();
  View view;
  view.eye = bounds.center() - glm::dvec3{0.0, (8.0 - 6.5 * share) * radius_m, 0.0};
  return view;
}

View watching(const Box& bounds) { return framed_view(bounds, {}, 320, 240); }

}  // namespace

TEST_CASE("the vertex shader morphs as the plain function does: positions, normals, uvs and colours") {
  Mesh mesh = outcrop(20'000);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    const auto shade = static_cast<std::uint8_t>(120 + 100 * std::sin(mesh.vertices.positions[v].x));
    mesh.vertices.colors.emplace_back(shade, 255 - shade, 200, 255);
  }
  const auto path = written(mesh, "scene_shader");
  const auto graph = read_cluster_graph(path);
  REQUIRE(graph.ok());
  const auto stage = Stage::create();
  REQUIRE(stage.ok());
  const auto frame = Frame::create((*stage)->gl(), {320, 240, 2});
  REQUIRE(frame.ok());
  ClusterScene scene{(*stage)->gl(), opened(path)};
  const Surfaces surfaces{(*stage)->gl(), *graph};
  const View view = watching(scene.bounds());
  std::size_t on_the_way = 0;
  for (const double limit_px : {1.5, 2.0, 3.0, 4.0, 5.0, 7.0}) {
    scene.settle(view, {.error_px = limit_px, .culling = Culling::None});
    on_the_way += static_cast<std::size_t>(
        std::count_if(scene.weights().begin(), scene.weights().end(), [](double w) { return w > 0.05 && w < 0.95; }));
    (*stage)->renderer().draw(*frame, view, scene.bounds(), scene.items(Coloring::Materials), {});
    const Image shader = (*stage)->presenter().read(*frame);
    const Mesh plain = extract_morphed(*graph, scene.cut(), scene.weights());
    const SortedMesh sorted{plain};
    const Geometry geometry{(*stage)->gl(), sorted.arrays()};
    const Item item{.geometry = &geometry, .surfaces = &surfaces, .size_m = scene.bounds().diagonal_m()};
    (*stage)->renderer().draw(*frame, view, scene.bounds(), {&item, 1}, {});
    const Image by_hand = (*stage)->presenter().read(*frame);
    INFO(limit_px << " pixels");
    CHECK(image_rms(shader, by_hand) < 0.5);
  }
  REQUIRE(on_the_way >= 3);
}

TEST_CASE("on a flight the largest jump is at most a quarter with the morph of what it is without") {
  const auto file = file_of(outcrop(20'000), "scene_flight");
  FlightOptions options{.frames = 100, .path = flying_in, .watch = watching};
  options.render = {.width_px = 320, .height_px = 240, .supersample = 1};
  options.render.look.coloring = Coloring::Untextured;
  const auto morphed = fly_clusters(file, options);
  options.morph_seconds = 0.0;
  const auto hard = fly_clusters(file, options);
  REQUIRE(morphed.ok());
  REQUIRE(hard.ok());
  const double largest = *std::max_element(hard->pops.begin(), hard->pops.end());
  CHECK(largest > 5.0);
  CHECK(*std::max_element(morphed->pops.begin(), morphed->pops.end()) <= 0.25 * largest);
  CHECK(morphed->mean_triangles > 0.7 * hard->mean_triangles);
}

TEST_CASE("at one pixel a cut hardly differs from full resolution") {
  const Mesh mesh = outcrop(20'000);
  const auto file = file_of(mesh, "scene_pixel");
  RenderOptions options{.width_px = 320, .height_px = 240};
  options.look.background = Background::White;
  const auto cut = render_clusters(file, options, 1.0);
  const auto full = render_clusters(file, options, 1e-3);
  REQUIRE(cut.ok());
  REQUIRE(full.ok());
  CHECK(full->triangles == mesh.triangle_count());
  CHECK(cut->triangles < mesh.triangle_count() * 4 / 5);
  CHECK(object_rms(cut->image, full->image) < 2.0);
}

TEST_CASE("with a budget of bytes that is too small what is coarser stands in, and the picture is whole") {
  const auto file = file_of(outcrop(30'000), "scene_budget");
  const auto stage = Stage::create();
  REQUIRE(stage.ok());
  ClusterScene scene{(*stage)->gl(), file, {.stream = {.budget_bytes = 200'000}}};
  const View view = watching(scene.bounds());
  const ClusterFrame frame = scene.settle(view, {.error_px = 0.01, .culling = Culling::None});
  CHECK(frame.missing_groups > 0);
  CHECK(frame.cut.triangle_count < 30'000 / 2);
  CHECK(scene.streamer().resident_bytes() < 600'000);
  std::uint64_t drawn = 0;
  for (const Item& item : scene.items(Coloring::Clusters)) {
    for (const DrawRange& draw : item.draws) drawn += draw.index_count / 3;
    CHECK(item.draw_colors.size() == item.draws.size());
  }
  CHECK(drawn == frame.cut.triangle_count);
}
