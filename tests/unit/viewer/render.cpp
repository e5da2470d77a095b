// SPDX-License-Identifier: MIT
#include <viewer/headless/headless.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "shapes.h"

using namespace lodestone;
using namespace lodestone::render;

namespace {

struct Rgb {
  int r, g, b;
};

Rgb pixel(const Image& image, double x, double y) {
  const auto* p = image.at(static_cast<std::uint32_t>(x * image.width), static_cast<std::uint32_t>(y * image.height));
  return {p[0], p[1], p[2]};
}

// Upright quad in the plane y = 0, x and z from -1 to 1, seen from the south.
Mesh quad() {
  Mesh mesh;
  mesh.materials.push_back({.name = "pane"});
  mesh.vertices.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  mesh.vertices.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

void add_texture(Mesh& mesh, Image image) {
  mesh.textures.push_back({.name = "made", .image = std::make_shared<const Image>(std::move(image))});
  mesh.materials[0].texture = 0;
}

RenderOptions from_south(std::uint32_t size_px = 96) {
  RenderOptions options{.width_px = size_px, .height_px = size_px, .supersample = 1};
  options.camera.yaw_rad = 0.0;
  options.camera.pitch_rad = 0.0;
  options.look.background = Background::White;
  return options;
}

Image image_of(const Mesh& mesh, const RenderOptions& options) {
  auto picture = render_mesh(mesh, options);
  REQUIRE(picture.ok());
  CHECK(picture->triangles == mesh.triangle_count());
  CHECK(picture->image.width == options.width_px);
  CHECK(picture->image.height == options.height_px);
  return std::move(picture->image);
}

double mean_difference(const Image& a, const Image& b) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(int(a.pixels[i]) - int(b.pixels[i]));
  return sum / static_cast<double>(a.pixels.size());
}

}  // namespace

TEST_CASE("the picture shows the model in its middle and the background around it") {
  const Image image = image_of(test::cube(), from_south());
  const Rgb corner = pixel(image, 0.01, 0.01);
  CHECK((corner.r == 255 && corner.g == 255 && corner.b == 255));
  const Rgb middle = pixel(image, 0.5, 0.5);
  CHECK(middle.r < 240);
  CHECK(middle.r > 60);
}

TEST_CASE("uv origin is the bottom-left corner of the image and row 0 its top") {
  Mesh mesh = quad();
  // top row red, green; bottom row blue, white
  add_texture(
      mesh, Image{.width = 2, .height = 2, .channels = 3, .pixels = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}});
  const Image image = image_of(mesh, from_south());
  const Rgb top_left = pixel(image, 0.28, 0.28);
  const Rgb top_right = pixel(image, 0.72, 0.28);
  const Rgb bottom_left = pixel(image, 0.28, 0.72);
  CHECK((top_left.r > 150 && top_left.g < 60));
  CHECK((top_right.g > 150 && top_right.r < 60));
  CHECK((bottom_left.b > 150 && bottom_left.r < 60));
}

TEST_CASE("without lamps a texture shows its own colour, and colours that tell sizes stay lit") {
  Mesh mesh = quad();
  add_texture(mesh, Image{.width = 1, .height = 1, .channels = 3, .pixels = {200, 100, 50}});
  render::RenderOptions options = from_south();
  const auto lit = image_of(mesh, options);
  options.look.lighting = render::Lighting::Photograph;
  const Rgb plain = pixel(image_of(mesh, options), 0.5, 0.5);
  CHECK((plain.r == Approx(200).margin(1) && plain.g == Approx(100).margin(1) && plain.b == Approx(50).margin(1)));
  CHECK(std::abs(pixel(lit, 0.5, 0.5).r - 200.0) > 5.0);
  options.look.coloring = render::Coloring::Lod;
  const auto sizes = image_of(mesh, options);
  options.look.lighting = render::Lighting::Lamps;
  CHECK(sizes.pixels == image_of(mesh, options).pixels);
}

TEST_CASE("grey, grey-alpha, RGB and RGBA textures of the same grey look the same") {
  std::vector<Image> images;
  for (const std::uint32_t channels : {1U, 2U, 3U, 4U}) {
    Mesh mesh = quad();
    Image texture{.width = 1, .height = 1, .channels = channels, .pixels = std::vector<std::uint8_t>(channels, 128)};
    if (channels == 2 || channels == 4) texture.pixels.back() = 255;
    add_texture(mesh, std::move(texture));
    images.push_back(image_of(mesh, from_south()));
  }
  for (const Image& image : images) CHECK(image.pixels == images.front().pixels);
  CHECK(pixel(images.front(), 0.5, 0.5).r < 160);
}

TEST_CASE("texels below the alpha cutoff are holes") {
  Mesh mesh = quad();
  Image halves{.width = 2, .height = 1, .channels = 4, .pixels = {0, 0, 0, 0, 0, 0, 0, 255}};
  add_texture(mesh, std::move(halves));
  mesh.materials[0].alpha_cutoff = 0.5F;
  const Image image = image_of(mesh, from_south());
  CHECK(pixel(image, 0.25, 0.5).r == 255);
  CHECK(pixel(image, 0.75, 0.5).r < 30);
}

TEST_CASE("a single-sided face is not drawn from behind, a double-sided one is lit like its front") {
  Mesh mesh = quad();
  RenderOptions behind = from_south();
  behind.camera.yaw_rad = 3.14159265358979;
  const Image both = image_of(mesh, behind);
  CHECK(mean_difference(both, image_of(mesh, from_south())) < 1.0);
  mesh.materials[0].double_sided = false;
  CHECK(pixel(image_of(mesh, behind), 0.5, 0.5).r == 255);
  CHECK(pixel(image_of(mesh, from_south()), 0.5, 0.5).r < 250);
}

TEST_CASE("glass is blended back to front whatever the order of its faces and materials") {
  Mesh mesh = quad();
  mesh.materials = {{.name = "red", .base_color = {1, 0, 0, 0.5F}}, {.name = "blue", .base_color = {0, 0, 1, 0.5F}}};
  for (int i = 0; i < 4; ++i) mesh.vertices.positions.push_back(mesh.vertices.positions[i] + glm::vec3{0, 0.5F, 0});
  mesh.vertices.uvs.clear();
  const std::vector<VertexId> near_pane{0, 1, 2, 0, 2, 3};
  const std::vector<VertexId> far_pane{4, 5, 6, 4, 6, 7};
  const auto with = [&](const std::vector<VertexId>& first, const std::vector<VertexId>& second, bool red_first) {
    Mesh made = mesh;
    made.indices = first;
    made.indices.insert(made.indices.end(), second.begin(), second.end());
    made.face_materials = red_first ? std::vector<MaterialId>{0, 0, 1, 1} : std::vector<MaterialId>{1, 1, 0, 0};
    return image_of(made, from_south());
  };
  const Image red_near = with(near_pane, far_pane, true);
  CHECK(red_near.pixels == with(far_pane, near_pane, false).pixels);
  const Rgb middle = pixel(red_near, 0.5, 0.5);
  CHECK(middle.r > middle.b + 20);
  const Rgb swapped = pixel(with(near_pane, far_pane, false), 0.5, 0.5);
  CHECK(swapped.b > swapped.r + 20);
}

TEST_CASE("a mesh without normals is lit as if each face had its own") {
  Mesh flat = test::unwelded(test::sphere(12, 24));
  const Image with_normals = image_of(flat, from_south(192));
  flat.vertices.normals.clear();
  CHECK(mean_difference(with_normals, image_of(flat, from_south(192))) < 1.0);
}

TEST_CASE("lighting does not depend on the orientation of faces") {
  Mesh mesh = test::sphere(24, 48);
  const Image image = image_of(mesh, from_south());
  for (std::size_t i = 0; i < mesh.indices.size(); i += 6) std::swap(mesh.indices[i], mesh.indices[i + 1]);
  CHECK(mean_difference(image, image_of(mesh, from_south())) < 0.5);
}

TEST_CASE("wireframe draws lines, LOD colours tell fine from coarse") {
  RenderOptions options = from_south();
  const Image plain = image_of(test::sphere(16, 32), options);
  options.look.wireframe = true;
  CHECK(mean_difference(plain, image_of(test::sphere(16, 32), options)) > 2.0);
  options.look = {.coloring = Coloring::Lod, .background = Background::White};
  const Rgb coarse = pixel(image_of(test::sphere(4, 8), options), 0.45, 0.55);
  const Rgb fine = pixel(image_of(test::sphere(200, 400), options), 0.45, 0.55);
  CHECK(coarse.r > coarse.b);
  CHECK(fine.b > fine.r);
}

TEST_CASE("an eye in world coordinates takes the origin into account") {
  Mesh mesh = quad();
  mesh.origin = {680'000.0, 5'400'000.0, 370.0};
  RenderOptions options = from_south();
  options.camera.eye_m = mesh.origin + glm::dvec3{0.0, -6.0, 0.0};
  CHECK(pixel(image_of(mesh, options), 0.5, 0.5).r < 250);
  options.camera.target_m = mesh.origin + glm::dvec3{0.0, -12.0, 0.0};
  CHECK(pixel(image_of(mesh, options), 0.5, 0.5).r == 255);
}

TEST_CASE("a texture that cannot be had is drawn white and named in a warning") {
  Mesh mesh = quad();
  mesh.textures.push_back({.name = "brick.jpg", .path = "/nowhere/brick.jpg"});
  mesh.materials[0].texture = 0;
  const auto picture = render_mesh(mesh, from_south());
  REQUIRE(picture.ok());
  REQUIRE(picture.warnings().size() == 1);
  CHECK(picture.warnings()[0].where.find("brick.jpg") != std::string::npos);
  CHECK(pixel(picture->image, 0.5, 0.5).r > 100);
}

TEST_CASE("every mesh family renders, the empty one as background") {
  RenderOptions options = from_south();
  options.camera.pitch_rad = 0.5;
  for (const auto& [name, mesh] : test::mesh_families()) {
    INFO(name);
    const Image image = image_of(mesh, options);
    const bool blank = std::all_of(image.pixels.begin(), image.pixels.end(), [](auto v) { return v == 255; });
    CHECK(blank == (mesh.triangle_count() == 0));
  }
}

TEST_CASE("wrong sizes, angles and places of the camera are refused with a reason") {
  const auto refused = [](const RenderOptions& options) {
    const auto picture = render_mesh(test::cube(), options);
    REQUIRE_FALSE(picture.ok());
    CHECK(picture.error().code == ErrorCode::BadArgument);
    CHECK_FALSE(picture.error().message.empty());
  };
  refused({.width_px = 0});
  refused({.width_px = 1'000'000});
  refused({.supersample = 0});
  refused({.supersample = 5});
  refused({.camera = {.fov_y_rad = 0.0}});
  refused({.camera = {.eye_m = glm::dvec3{1.0}, .target_m = glm::dvec3{1.0}}});
}

TEST_CASE("six-direction distance is zero for the same shape, grows with the difference, and knows origins") {
  const Mesh sphere = test::sphere(24, 48);
  const auto same = six_direction_rms(sphere, sphere, 128);
  REQUIRE(same.ok());
  CHECK(*same == 0.0);
  const auto near = six_direction_rms(sphere, test::sphere(12, 24), 128);
  const auto far = six_direction_rms(sphere, test::sphere(3, 5), 128);
  REQUIRE((near.ok() && far.ok()));
  CHECK(*near > 0.0);
  CHECK(*far > 2.0 * *near);
  Mesh moved = sphere;
  moved.origin = {100.0, 0.0, 0.0};
  for (auto& p : moved.vertices.positions) p.x -= 100.0F;
  const auto shifted = six_direction_rms(sphere, moved, 128);
  REQUIRE(shifted.ok());
  CHECK(*shifted < 1.0);
}
