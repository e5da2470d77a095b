// SPDX-License-Identifier: MIT
#include <lodestone/generate.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "generate/outcrop_field.h"

using namespace lodestone;

namespace {

using Make = Result<Mesh> (*)(const GenerateOptions&, const Context&);
using MakeTexture = Image (*)(const GenerateOptions&, std::uint32_t, const Context&);

struct Kind {
  const char* name;
  Make make;
  MakeTexture texture;
};
constexpr Kind kinds[] = {{"outcrop", generate_outcrop, outcrop_texture},
                          {"terrain", generate_terrain, terrain_texture}};

GenerateOptions options_of(std::uint32_t triangles, std::uint32_t textures, std::uint32_t charts = 0) {
  GenerateOptions options;
  options.triangles = triangles;
  options.textures = textures;
  options.charts = charts;
  options.texture_size_px = 64;
  return options;
}

// Parts of a mesh that share vertices by index: its uv charts.
std::size_t charts_by_index(const Mesh& mesh) {
  std::vector<VertexId> root(mesh.vertex_count());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](VertexId v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    root[find(mesh.indices[i])] = find(mesh.indices[i + 1]);
    root[find(mesh.indices[i + 1])] = find(mesh.indices[i + 2]);
  }
  std::set<VertexId> roots;
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) roots.insert(find(v));
  return roots.size();
}

glm::dvec3 color_at(const Image& image, const glm::vec2& uv) {
  const auto clamp_to = [](double x, std::uint32_t n) {
    return static_cast<std::uint32_t>(std::min(std::max(x, 0.0), n - 1.0));
  };
  const std::uint8_t* p =
      image.at(clamp_to(double{uv.x} * image.width, image.width), clamp_to((1.0 - uv.y) * image.height, image.height));
  return {p[0], p[1], p[2]};
}

struct Tone {
  double mean = 0, deviation = 0;
};
Tone tone(const Image& image) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    const double grey = (image.pixels[i] + image.pixels[i + 1] + image.pixels[i + 2]) / 3.0;
    sum += grey;
    squares += grey * grey;
  }
  const double count = static_cast<double>(image.pixels.size()) / 3.0;
  return {sum / count, std::sqrt(squares / count - sum * sum / count / count)};
}

}  // namespace

TEST_CASE("outcrop and terrain keep their promise of triangles") {
  for (const Kind& kind : kinds) {
    for (const std::uint32_t triangles : {2'000U, 50'000U, 1'000'000U}) {
      const Mesh mesh = kind.make(options_of(triangles, 4), {}).value();
      CAPTURE(kind.name, triangles);
      CHECK(mesh.triangle_count() == Approx(triangles).epsilon(0.02));
      REQUIRE(validate(mesh).ok());
    }
  }
}

TEST_CASE("a sheet is one surface with one border, whatever its charts") {
  for (const Kind& kind : kinds) {
    for (const std::uint32_t charts : {1U, 7U, 40U}) {
      const Mesh mesh = kind.make(options_of(20'000, std::min(charts, 5U), charts), {}).value();
      CAPTURE(kind.name, charts);
      const MeshReport report = inspect(mesh);
      CHECK(report.components == 1);
      CHECK(report.non_manifold_edges == 0);
      CHECK(report.degenerate_triangles == 0);
      // Euler's formula of a disc: every further border or hole would show.
      const std::int64_t edges = (3 * std::int64_t{mesh.triangle_count()} + report.boundary_edges) / 2;
      CHECK(std::int64_t{report.corner_points} - edges + mesh.triangle_count() == 1);
      CHECK(charts_by_index(mesh) == charts);
      CHECK(mesh.textures.size() == std::min(charts, 5U));
      for (const glm::vec2& uv : mesh.vertices.uvs)
        REQUIRE((uv.x >= 0.0F && uv.x <= 1.0F && uv.y >= 0.0F && uv.y <= 1.0F));
    }
  }
}

TEST_CASE("pictures agree along the seams") {
  for (const Kind& kind : kinds) {
    GenerateOptions options = options_of(20'000, 6, 12);
    options.texture_size_px = 512;
    const Mesh mesh = kind.make(options, {}).value();
    std::vector<MaterialId> material(mesh.vertex_count(), 0);
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) material[mesh.indices[3 * f + k]] = mesh.face_materials[f];
    }
    std::map<std::array<float, 3>, VertexId> first;
    double difference = 0.0;
    std::size_t count = 0;
    for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
      const glm::vec3& p = mesh.vertices.positions[v];
      const auto [twin, is_new] = first.insert({{p.x, p.y, p.z}, v});
      if (is_new) continue;
      const auto color = [&](VertexId w) { return color_at(*mesh.textures[material[w]].image, mesh.vertices.uvs[w]); };
      difference += glm::length(color(v) - color(twin->second));
      REQUIRE(mesh.vertices.normals[v] == mesh.vertices.normals[twin->second]);
      ++count;
    }
    CAPTURE(kind.name);
    REQUIRE(count > 100);
    // The two images sample the seam at places up to a texel apart; unrelated places differ by 50 and more.
    CHECK(difference / static_cast<double>(count) < 20.0);
  }
}

TEST_CASE("pictures look like photographs: neither flat nor black nor burnt out") {
  for (const Kind& kind : kinds) {
    GenerateOptions options = options_of(2'000, 4);
    options.texture_size_px = 256;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const Tone t = tone(kind.texture(options, i, {}));
      CAPTURE(kind.name, i);
      CHECK(t.mean > 50.0);
      CHECK(t.mean < 190.0);
      CHECK(t.deviation > 12.0);
      CHECK(t.deviation < 80.0);
    }
  }
}

TEST_CASE("pixels made one at a time are those of the mesh") {
  for (const Kind& kind : kinds) {
    GenerateOptions options = options_of(2'000, 3, 9);
    const Mesh mesh = kind.make(options, {}).value();
    options.pixels = Pixels::Skip;
    const Mesh bare = kind.make(options, {}).value();
    for (std::uint32_t i = 0; i < 3; ++i) {
      CHECK(bare.textures[i].image == nullptr);
      CHECK(kind.texture(options, i, {}).pixels == mesh.textures[i].image->pixels);
    }
    CHECK(bare.vertices == mesh.vertices);
  }
}

TEST_CASE("sheets: the same bytes for any number of threads, other ones for another seed") {
  for (const Kind& kind : kinds) {
    GenerateOptions options = options_of(30'000, 3);
    Context context;
    context.max_workers = 1;
    const Mesh first = kind.make(options, context).value();
    for (const unsigned workers : {2U, 8U}) {
      context.max_workers = workers;
      const Mesh again = kind.make(options, context).value();
      CHECK(again.vertices == first.vertices);
      CHECK(again.indices == first.indices);
      for (std::size_t i = 0; i < 3; ++i) CHECK(again.textures[i].image->pixels == first.textures[i].image->pixels);
    }
    options.seed = 2;
    CHECK_FALSE(kind.make(options, {}).value().vertices == first.vertices);
  }
}

TEST_CASE("the cliff overhangs, has beds of two hardnesses and a fault") {
  const generate::OutcropField field{1};
  // Walking straight up the cliff, the rock comes forward again and again: hard beds jut out over soft ones.
  int overhangs = 0;
  for (double t = 14.0; t < 34.0; t += 0.05) {
    const double step = field.position(20.0, t + 0.05, 0.05).y - field.position(20.0, t, 0.05).y;
    overhangs += step < -0.05 ? 1 : 0;
  }
  CHECK(overhangs > 8);
  // Along one level of the cliff the strata jump where the fault passes, and nowhere else.
  int jumps = 0;
  for (double s = 5.0; s < 75.0; s += 0.02) {
    const double jump = std::abs(field.sample(s + 0.02, 24.0, 0.02).strata_m - field.sample(s, 24.0, 0.02).strata_m);
    jumps += jump > 0.5 ? 1 : 0;
  }
  CHECK(jumps == 1);
}

TEST_CASE("finer grids of one outcrop lie on the same rock") {
  const Mesh coarse = generate_outcrop(options_of(5'000, 1)).value();
  const Mesh fine = generate_outcrop(options_of(80'000, 1)).value();
  const Box a = bounds(coarse);
  const Box b = bounds(fine);
  CHECK(glm::length(a.center() - b.center()) < 1.0);
  CHECK(glm::length(a.size() - b.size()) < 3.0);
}

TEST_CASE("sheets refuse options out of range and stop when cancelled") {
  for (const Kind& kind : kinds) {
    CHECK(kind.make(options_of(1'000, 20'000), {}).error().code == ErrorCode::BadArgument);
    CHECK(kind.make(options_of(1'000, 8, 4), {}).error().code == ErrorCode::BadArgument);
    const std::atomic<bool> cancel{true};
    Context context;
    context.cancel = &cancel;
    CHECK(kind.make(options_of(1'000, 1), context).error().code == ErrorCode::Cancelled);
  }
}
