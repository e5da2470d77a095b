// SPDX-License-Identifier: MIT
// What a source may hold besides sound photographs and sound texture coordinates.
#include <algorithm>
#include <array>
#include <fstream>

#include <lodestone/formats.h>
#include <lodestone/tile_loader.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "data.h"
#include "fixture.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;
using Color = std::array<int, 3>;
using Quadrants = std::array<Color, 4>;  // upper left, upper right, lower left, lower right

constexpr Color red{200, 40, 30};
constexpr Color green{40, 180, 60};
constexpr Color blue{30, 50, 190};
constexpr Color pale{230, 220, 210};
constexpr Color white{255, 255, 255};
constexpr int side = 12;

TilesetOptions options(bool resume = false) { return {.pyramid = small_tiles(), .resume = resume}; }

const fs::path& corpus() {
  static const fs::path folder = fs::path{LODESTONE_CORPUS} / "image";
  return folder;
}

Mesh grid_with(const Texture& texture) {
  Mesh mesh = grid(side, side);
  mesh.materials = {{.name = "rock", .texture = 0}};
  mesh.textures = {texture};
  return mesh;
}

Mesh grid_with(const fs::path& file) { return grid_with({.name = file.filename().string(), .path = file.string()}); }

fs::path write_bytes(const fs::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream{file, std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()),
                                              static_cast<std::streamsize>(bytes.size()));
  return file;
}

std::vector<std::uint8_t> half_of(std::vector<std::uint8_t> bytes) {
  bytes.resize(bytes.size() / 2);
  return bytes;
}

Image quadrants(std::uint32_t width, std::uint32_t height) {
  Image image{width, height, 3, {}};
  image.pixels.resize(std::size_t{width} * height * 3);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const Color& c = y < height / 2 ? (x < width / 2 ? red : green) : (x < width / 2 ? blue : pale);
      for (std::size_t k = 0; k < 3; ++k) image.at(x, y)[k] = static_cast<std::uint8_t>(c[k]);
    }
  }
  return image;
}

// What a tile shows at one of its vertices: white where it has no texture.
Color color_of(const Mesh& tile, VertexId vertex) {
  for (std::size_t c = 0; c < tile.indices.size(); ++c) {
    if (tile.indices[c] != vertex) continue;
    const std::uint32_t texture = tile.materials[tile.face_material(static_cast<FaceId>(c / 3))].texture;
    if (texture == none) break;
    const Image& image = *tile.textures[texture].image;
    const glm::vec2 uv = tile.vertices.uvs[vertex];
    const auto at = [](float share, std::uint32_t size) {
      return std::min(static_cast<std::uint32_t>(share * static_cast<float>(size)), size - 1);
    };
    const std::uint8_t* p = image.at(at(uv.x, image.width), at(1.0F - uv.y, image.height));
    return image.channels < 3 ? Color{p[0], p[0], p[0]} : Color{p[0], p[1], p[2]};
  }
  return white;
}

// In the middle of each quarter of the grid, from the tiles of the finest level as they were written.
Quadrants shown(const Mesh& source, const fs::path& folder) {
  const auto pyramid = TilePyramid::open(folder / "tileset.json");
  REQUIRE(pyramid);
  const glm::dvec3 low = source.origin - (*pyramid)->origin();
  Box box;
  for (const glm::vec3& p : source.vertices.positions) box.add(glm::dvec3{p});
  Quadrants colors{};
  std::array<double, 4> nearest{1e9, 1e9, 1e9, 1e9};
  for (NodeId n = 0; n < (*pyramid)->graph().nodes.size(); ++n) {
    if ((*pyramid)->name(n).find("L0_") == std::string::npos) continue;
    const auto tile = (*pyramid)->load(n);
    REQUIRE(tile);
    for (VertexId v = 0; v < tile->vertex_count(); ++v) {
      const glm::dvec3 p = glm::dvec3{tile->vertices.positions[v]} + tile->origin - low;
      for (std::size_t q = 0; q < 4; ++q) {
        const glm::dvec2 part{q % 2 == 0 ? 0.25 : 0.75, q < 2 ? 0.75 : 0.25};
        const glm::dvec2 middle = glm::dvec2{box.min} + part * glm::dvec2{box.max - box.min};
        const double away = glm::length(glm::dvec2{p} - middle);
        if (away >= nearest[q]) continue;
        nearest[q] = away;
        colors[q] = color_of(*tile, v);
      }
    }
  }
  return colors;
}

void check_shown(const Mesh& source, const fs::path& folder, const Quadrants& expected) {
  const Quadrants found = shown(source, folder);
  for (std::size_t q = 0; q < 4; ++q) {
    for (std::size_t k = 0; k < 3; ++k) {
      CAPTURE(q, k, found[q][k], expected[q][k]);
      CHECK(std::abs(found[q][k] - expected[q][k]) <= 6);
    }
  }
}

}  // namespace

TEST_CASE("CMYK, grey and 16-bit photographs come out in their own colours, every corner where it belongs") {
  const fs::path folder = scratch_folder("photographs_odd");
  constexpr Color g[] = {{73, 73, 73}, {142, 142, 142}, {56, 56, 56}, {221, 221, 221}};
  const std::pair<const char*, Quadrants> cases[] = {{"quadrants_cmyk.jpg", {red, green, blue, pale}},
                                                     {"quadrants16.png", {red, green, blue, pale}},
                                                     {"quadrants_grey.jpg", {g[0], g[1], g[2], g[3]}},
                                                     {"quadrants_grey16.png", {g[0], g[1], g[2], g[3]}}};
  for (const auto& [name, expected] : cases) {
    INFO(name);
    const Mesh mesh = grid_with(corpus() / name);
    const auto written = write_outcrop(mesh, folder, options());
    REQUIRE(written);
    CHECK(written.warnings().empty());
    check_shown(mesh, folder, expected);
  }
  for (const char* name : {"palette.png", "small.webp", "small.bmp"}) {
    INFO(name);
    const auto written = write_outcrop(grid_with(corpus() / name), folder, options());
    REQUIRE(written);
    CHECK(written.warnings().empty());
    CHECK(written->decoded_megapixels > 0.0);
  }
}

TEST_CASE("Photographs that EXIF says are turned or mirrored are shown upright") {
  const fs::path folder = scratch_folder("photographs_exif");
  const auto jpeg = encode_jpeg(quadrants(48, 32), 95);
  REQUIRE(jpeg);
  const Quadrants upright[] = {{red, green, blue, pale}, {green, red, pale, blue}, {pale, blue, green, red},
                               {blue, pale, red, green}, {red, blue, green, pale}, {blue, red, pale, green},
                               {pale, green, blue, red}, {green, pale, red, blue}};
  for (std::uint8_t orientation = 1; orientation <= 8; ++orientation) {
    INFO(int{orientation});
    const std::uint8_t exif[] = {0xFF, 0xE1, 0,    34,   'E', 'x', 'i', 'f', 0, 0, 'M', 'M',         0, 42, 0, 0, 0, 8,
                                 0,    1,    0x01, 0x12, 0,   3,   0,   0,   0, 1, 0,   orientation, 0, 0,  0, 0, 0, 0};
    std::vector<std::uint8_t> bytes = *jpeg;
    bytes.insert(bytes.begin() + 2, std::begin(exif), std::end(exif));
    const Mesh mesh = grid_with(write_bytes(folder / "turned.jpg", bytes));
    const auto written = write_outcrop(mesh, folder / "tiles", options());
    REQUIRE(written);
    CHECK((written->segments.front().width_px < written->segments.front().height_px) == (orientation >= 5));
    check_shown(mesh, folder / "tiles", upright[orientation - 1]);
  }
}

TEST_CASE("Grey, coloured and transparent photographs on one tile keep their own colours") {
  const fs::path folder = scratch_folder("photographs_mixed");
  Mesh mesh = grid(side, side);
  mesh.materials = {{.name = "a", .texture = 0}, {.name = "b", .texture = 1}, {.name = "c", .texture = 2}};
  const Image clear{8, 8, 4, std::vector<std::uint8_t>(256, 255)};
  mesh.textures = {
      {.name = "grey", .image = std::make_shared<const Image>(Image{8, 8, 1, std::vector<std::uint8_t>(64, 100)})},
      {.name = "colours", .image = std::make_shared<const Image>(quadrants(16, 16))},
      {.name = "clear", .image = std::make_shared<const Image>(clear)}};
  mesh.face_materials.resize(mesh.triangle_count());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const glm::vec2 uv = mesh.vertices.uvs[mesh.indices[3 * f]];
    mesh.face_materials[f] = uv.y < 0.5F ? 1 : (uv.x < 0.5F ? 0 : 2);
  }
  REQUIRE(write_outcrop(mesh, folder, {.pyramid = {.tile_bytes = 1'000'000}, .image = TileImage::Png}));
  check_shown(mesh, folder, {Color{100, 100, 100}, white, blue, pale});
}

TEST_CASE("A photograph's alpha is in its tiles, and makes holes where the material says so") {
  const fs::path folder = scratch_folder("photographs_alpha");
  Image leaf{16, 16, 4, std::vector<std::uint8_t>(16 * 16 * 4, 90)};
  for (std::uint32_t y = 0; y < 16; ++y) leaf.at(15, y)[3] = 0;
  for (const float cutoff : {0.0F, 0.5F}) {
    CAPTURE(cutoff);
    Mesh mesh = grid_with({.name = "leaf", .image = std::make_shared<const Image>(leaf)});
    mesh.materials.front().alpha_cutoff = cutoff;
    REQUIRE(write_outcrop(mesh, folder, {.pyramid = {.tile_bytes = 1'000'000}}));
    const auto pyramid = TilePyramid::open(folder / "tileset.json");
    REQUIRE(pyramid);
    const auto tile = (*pyramid)->load(0);
    REQUIRE(tile);
    CHECK(tile->materials.front().alpha_cutoff == cutoff);
    REQUIRE(tile->textures.size() == 1);
    const Image& shown = *tile->textures.front().image;
    REQUIRE(shown.channels == 4);
    CHECK(shown.at(0, 0)[3] == 90);
    CHECK(shown.at(shown.width - 1, 0)[3] == 0);
  }
}

TEST_CASE("A photograph that is missing, empty, cut off or no image leaves its faces plain, and is told by name") {
  const fs::path folder = scratch_folder("photographs_damaged");
  const auto jpeg = encode_jpeg(quadrants(64, 64), 95);
  const auto png = encode_png(quadrants(64, 64));
  REQUIRE((jpeg && png));
  write_bytes(folder / "empty.jpg", {});
  write_bytes(folder / "text.jpg", {'h', 'e', 'l', 'l', 'o'});
  write_bytes(folder / "cut.jpg", half_of(*jpeg));
  write_bytes(folder / "cut.png", half_of(*png));
  write_bytes(folder / "head.jpg", {jpeg->begin(), jpeg->begin() + 30});
  std::vector<std::uint8_t> flipped = *png;
  flipped[flipped.size() / 2] ^= 1U;
  write_bytes(folder / "flipped.png", flipped);
  std::vector<std::uint8_t> wide = *png;
  std::fill_n(wide.begin() + 16, 8, std::uint8_t{0x7F});  // 2139062143 pixels each way
  write_bytes(folder / "wide.png", wide);
  std::vector<std::uint8_t> frame{'G', 'I', 'F', '8', '9', 'a', 255, 255, 255, 255, 0, 0, 0};
  write_bytes(folder / "wide.gif", frame);
  std::vector<std::uint8_t> plain(18 + 64 * 64 * 3 - 50, 90);  // 50 bytes are missing
  std::fill_n(plain.begin(), 18, std::uint8_t{0});
  plain[2] = 2;
  plain[12] = plain[14] = 64;
  plain[16] = 24;
  write_bytes(folder / "cut.tga", plain);
  for (const char* name : {"missing.jpg", "empty.jpg", "text.jpg", "cut.jpg", "cut.png", "flipped.png", "head.jpg",
                           "wide.png", "wide.gif", "cut.tga"}) {
    INFO(name);
    const Mesh mesh = grid_with(folder / name);
    const auto written = write_outcrop(mesh, folder / "tiles", options());
    REQUIRE(written);
    REQUIRE(written.warnings().size() == 1);
    CHECK(written.warnings().front().message.find("its faces stay plain") != std::string::npos);
    CHECK(written.warnings().front().where == (folder / name).string());
    check_shown(mesh, folder / "tiles", {white, white, white, white});
  }
  // Inside a file, as in a GLB.
  Texture inside{.name = "#1", .encoded = std::make_shared<const std::vector<std::uint8_t>>(half_of(*jpeg))};
  const auto written = write_outcrop(grid_with(inside), folder / "tiles", options());
  REQUIRE(written);
  REQUIRE(written.warnings().size() == 1);
  CHECK(written.warnings().front().where == "#1");
}

TEST_CASE(
    "After a photograph was mended or exchanged, resuming makes its tiles anew; until then each run tells of it") {
  const fs::path folder = scratch_folder("photographs_mended");
  const auto jpeg = encode_jpeg(quadrants(64, 64), 95);
  REQUIRE(jpeg);
  std::vector<std::uint8_t> torn = *jpeg;  // as long as it was
  std::fill(torn.begin() + static_cast<std::ptrdiff_t>(torn.size() / 2), torn.end(), std::uint8_t{0});
  const Mesh mesh = grid_with(write_bytes(folder / "photo.jpg", torn));
  const auto first = write_outcrop(mesh, folder / "tiles", options());
  REQUIRE(first);
  const auto again = write_outcrop(mesh, folder / "tiles", options(true));
  REQUIRE(again);
  CHECK(again->kept_tiles == again->tiles);
  REQUIRE(again.warnings().size() == 1);
  CHECK(to_line(again.warnings().front()) == to_line(first.warnings().front()));

  write_bytes(folder / "photo.jpg", *jpeg);
  const auto mended = write_outcrop(mesh, folder / "tiles", options(true));
  REQUIRE(mended);
  CHECK(mended->kept_tiles == 0);
  REQUIRE(mended.warnings().size() == 1);
  CHECK(mended.warnings().front().where == "photo.jpg");
  check_shown(mesh, folder / "tiles", {red, green, blue, pale});
  REQUIRE(write_outcrop(mesh, folder / "fresh", options()));
  CHECK(files_of(folder / "tiles") == files_of(folder / "fresh"));

  const auto refused = [&](const Mesh& other, const TilesetOptions& with) {
    const auto written = write_outcrop(other, folder / "tiles", with);
    REQUIRE(!written);
    CHECK(written.error().code == ErrorCode::BadArgument);
    CHECK(written.error().where == (folder / "tiles").string());
    return written.error().message;
  };
  TilesetOptions sharper = options(true);
  sharper.jpeg_quality = 99;
  CHECK(refused(mesh, sharper).find("with other options") != std::string::npos);
  Mesh other = mesh;
  other.vertices.positions.front().z += 1.0F;
  CHECK(refused(other, options(true)).find("from another mesh") != std::string::npos);
  CHECK(files_of(folder / "tiles") == files_of(folder / "fresh"));
}

TEST_CASE("A texture coordinate that is no number, or far out, leaves its faces plain, counted and with their file") {
  const fs::path folder = scratch_folder("photographs_uv");
  REQUIRE(write_image(quadrants(64, 64), folder / "photo.jpg"));
  std::ofstream{folder / "wall.mtl"} << "newmtl rock\nmap_Kd photo.jpg\n";
  const Mesh source = grid(side, side);
  const auto write_wall = [&](const char* bad) {
    std::ofstream obj{folder / "wall.obj"};
    obj << "mtllib wall.mtl\nusemtl rock\n";
    for (VertexId v = 0; v < source.vertex_count(); ++v) {
      const glm::vec3 p = source.vertices.positions[v];
      const glm::vec2 uv = source.vertices.uvs[v];
      obj << "v " << p.x << ' ' << p.y << ' ' << p.z << "\nvt " << uv.x << ' ';
      v == 20 ? obj << bad << '\n' : obj << uv.y << '\n';
    }
    for (std::size_t i = 0; i < source.indices.size(); i += 3) {
      obj << 'f';
      for (std::size_t k = 0; k < 3; ++k) obj << ' ' << source.indices[i + k] + 1 << '/' << source.indices[i + k] + 1;
      obj << '\n';
    }
  };
  for (const char* bad : {"nan", "inf", "1e39", "1e30", "1e9", "-7"}) {
    INFO(bad);
    write_wall(bad);
    auto loaded = read_mesh(folder / "wall.obj", {.textures = LoadTextures::Reference});
    REQUIRE(loaded);
    const auto written = write_outcrop(std::move(loaded->mesh), folder / "tiles", options());
    REQUIRE(written);
    std::vector<Warning> told = loaded.warnings();
    told.insert(told.end(), written.warnings().begin(), written.warnings().end());
    REQUIRE(told.size() == 1);
    CHECK(told.front().message.find("stay") != std::string::npos);
    CHECK(told.front().count == (loaded.warnings().empty() ? 6 : 1));  // triangles of the corner, or the corner
    CHECK(written->segments.size() == 2);
    CHECK(written->segments.back().triangles == 6);
    const auto check = check_tileset(folder / "tiles/tileset.json");
    REQUIRE(check);
    CHECK(check->faults.empty());
    check_shown(source, folder / "tiles", {red, green, blue, pale});
  }
}

TEST_CASE("Triangles without area are counted") {
  const fs::path folder = scratch_folder("photographs_flat");
  Mesh mesh = grid(4, 4);
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 2, 2, 2});
  const auto written = write_outcrop(mesh, folder, options());
  REQUIRE(written);
  CHECK(written->degenerate_triangles == 2);
  const auto check = check_tileset(folder / "tileset.json");
  REQUIRE(check);
  CHECK(check->triangles == mesh.triangle_count());
}

}  // namespace lodestone::test
