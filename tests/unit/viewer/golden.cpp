// SPDX-License-Identifier: MIT
// Small scenes against committed pictures. Drivers differ in the last bit and at edges, so a tolerance: root mean
// square of 2 and no 8 x 8 block off by more than 12 on average. After a wanted change: LODESTONE_UPDATE_GOLDEN=1
// test_viewer, then look at the pictures before committing them.
#include <lodestone/formats.h>
#include <viewer/headless/headless.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "data.h"
#include "shapes.h"

using namespace lodestone;
using namespace lodestone::render;

namespace {

struct Difference {
  double rms = 0.0;
  double worst_block = 0.0;
};

Difference difference(const Image& a, const Image& b) {
  constexpr std::uint32_t block_px = 8;
  Difference found;
  for (std::uint32_t by = 0; by < a.height; by += block_px) {
    for (std::uint32_t bx = 0; bx < a.width; bx += block_px) {
      double sum = 0.0;
      double count = 0.0;
      for (std::uint32_t y = by; y < std::min(by + block_px, a.height); ++y) {
        for (std::uint32_t x = bx; x < std::min(bx + block_px, a.width); ++x) {
          for (std::uint32_t c = 0; c < 3; ++c) {
            const double d = std::abs(double(a.at(x, y)[c]) - double(b.at(x, y)[c]));
            sum += d;
            count += 1.0;
            found.rms += d * d;
          }
        }
      }
      found.worst_block = std::max(found.worst_block, sum / count);
    }
  }
  found.rms = std::sqrt(found.rms / (3.0 * a.width * a.height));
  return found;
}

void check_golden(const std::string& name, const Image& image) {
  const std::filesystem::path golden = std::filesystem::path{LODESTONE_GOLDEN_DIR} / (name + ".png");
  if (std::getenv("LODESTONE_UPDATE_GOLDEN") != nullptr) {
    REQUIRE(write_image(image, golden).ok());
    WARN("wrote " << golden);
    return;
  }
  const auto wanted = read_image(golden);
  INFO("golden image " << golden);
  REQUIRE(wanted.ok());
  REQUIRE(wanted->width == image.width);
  REQUIRE(wanted->height == image.height);
  REQUIRE(wanted->channels == 3);
  const Difference off = difference(image, *wanted);
  if (off.rms > 2.0 || off.worst_block > 12.0) {
    const auto seen = test::scratch_folder("golden_" + name) / "seen.png";
    CHECK(write_image(image, seen).ok());
    WARN("the picture made now is " << seen);
  }
  CHECK(off.rms <= 2.0);
  CHECK(off.worst_block <= 12.0);
}

Mesh bumpy_sphere() {
  Mesh mesh = test::sphere(40, 80);
  for (auto& p : mesh.vertices.positions) p *= 1.0F + 0.1F * std::sin(p.x * 9) * std::sin(p.y * 7) * std::sin(p.z * 8);
  compute_normals(mesh);
  return mesh;
}

// A box with a checkered wall, glass on one side and a cut-out disc on top.
Mesh materials_box() {
  Mesh mesh = test::unwelded(test::cube());
  mesh.vertices.normals.clear();
  mesh.vertices.uvs.clear();
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const glm::vec3 a = mesh.vertices.positions[mesh.indices[3 * f]];
    const glm::vec3 n = glm::cross(mesh.vertices.positions[mesh.indices[3 * f + 1]] - a,
                                   mesh.vertices.positions[mesh.indices[3 * f + 2]] - a);
    const bool side = std::abs(n.x) > 0.5F;
    const bool top = std::abs(n.z) > 0.5F;
    mesh.face_materials.push_back(top ? 2 : side ? 1 : 0);
  }
  for (const glm::vec3& p : mesh.vertices.positions) mesh.vertices.uvs.emplace_back((p.x + 1) / 2, (p.y + p.z + 2) / 2);
  Image checks{.width = 8, .height = 8, .channels = 3, .pixels = {}};
  Image disc{.width = 32, .height = 32, .channels = 4, .pixels = {}};
  for (std::uint32_t i = 0; i < 64; ++i) {
    const std::uint8_t v = (i + i / 8) % 2 == 0 ? 220 : 90;
    checks.pixels.insert(checks.pixels.end(), {v, static_cast<std::uint8_t>(v / 2), 60});
  }
  for (int i = 0; i < 1024; ++i) {
    const int dx = i % 32 - 16;
    const int dy = i / 32 - 16;
    disc.pixels.insert(disc.pixels.end(), {60, 110, 60, static_cast<std::uint8_t>(dx * dx + dy * dy < 150 ? 255 : 0)});
  }
  mesh.textures = {{.name = "checks", .image = std::make_shared<const Image>(checks)},
                   {.name = "disc", .image = std::make_shared<const Image>(disc)}};
  mesh.materials = {{.name = "wall", .texture = 0},
                    {.name = "glass", .base_color = {0.5F, 0.8F, 1.0F, 0.4F}},
                    {.name = "leaf", .texture = 1, .alpha_cutoff = 0.5F}};
  return mesh;
}

constexpr RenderOptions small{.width_px = 160, .height_px = 120, .supersample = 2};

Image rendered(const Mesh& mesh, const RenderOptions& options) {
  auto picture = render_mesh(mesh, options);
  REQUIRE(picture.ok());
  return std::move(picture->image);
}

}  // namespace

TEST_CASE("golden: smooth shading") { check_golden("smooth", rendered(bumpy_sphere(), {small})); }

TEST_CASE("golden: textures, glass and cut-outs") { check_golden("materials", rendered(materials_box(), {small})); }

TEST_CASE("golden: wireframe over flat shading") {
  RenderOptions options{small};
  options.look = {.background = Background::White, .wireframe = true};
  check_golden("wireframe", rendered(test::seamed_grid(16, 16), options));
}

TEST_CASE("golden: LOD colours") {
  RenderOptions options{small};
  options.look.coloring = Coloring::Lod;
  check_golden("lod_colors", rendered(bumpy_sphere(), options));
}
