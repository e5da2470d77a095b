// SPDX-License-Identifier: MIT
// Tiles under EXT_meshopt_compression, and features in tiles.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>

#include <lodestone/formats.h>
#include <lodestone/tileset_writer.h>
#include <catch2/catch.hpp>

#include "base/rng.h"
#include "data.h"
#include "fixture.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

// Written once each.
const fs::path& tiles(TileCompression compression) {
  static std::map<TileCompression, fs::path> made;
  fs::path& folder = made[compression];
  if (folder.empty()) {
    folder = scratch_folder(compression == TileCompression::None ? "packed_not" : "packed");
    REQUIRE(write_outcrop(small_cliff(), folder, {.pyramid = small_tiles(), .compression = compression}));
  }
  return folder;
}

Mesh tile(const fs::path& file) {
  auto loaded = read_mesh(file, {.textures = LoadTextures::Encoded});
  if (!loaded) FAIL(to_line(loaded.error()));
  return std::move(loaded->mesh);
}

using Corner = std::array<double, 8>;  // place, uv, normal
// Triangles by their corners, in an order of their own; the first corner is the least.
std::vector<std::array<Corner, 3>> corners_of(const Mesh& mesh, double grid_m) {
  std::vector<std::array<Corner, 3>> out;
  for (std::size_t c = 0; c < mesh.indices.size(); c += 3) {
    std::array<Corner, 3> t;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = mesh.indices[c + k];
      for (int a = 0; a < 3; ++a) {
        t[k][a] = std::round(mesh.vertices.positions[v][a] / grid_m) * grid_m;
        t[k][5 + a] = mesh.vertices.normals.empty() ? 0.0 : static_cast<double>(mesh.vertices.normals[v][a]);
      }
      for (int a = 0; a < 2; ++a) t[k][3 + a] = mesh.vertices.uvs[v][a];
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    out.push_back(t);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("Packed tiles fit bit for bit, pass the check, and take fewer bytes") {
  const auto check = check_tileset(tiles(TileCompression::Meshopt) / "tileset.json");
  REQUIRE(check);
  CHECK(check->seams_open == 0);
  CHECK(check->faults.empty());
  CHECK(check->triangles == small_cliff().triangle_count());
  const auto plain = check_tileset(tiles(TileCompression::None) / "tileset.json");
  REQUIRE(plain);
  CHECK(check->bytes < plain->bytes * 3 / 4);
  std::vector<Mesh> finest;
  for (const auto& [name, content] : files_of(tiles(TileCompression::Meshopt))) {
    if (!name.starts_with("tiles/L0_")) continue;
    finest.push_back(tile(tiles(TileCompression::Meshopt) / name));
    remove_skirts(finest.back());
  }
  CHECK(open_edges(finest) == inspect(small_cliff()).boundary_edges);
}

TEST_CASE("A packed tile is the plain one: places to 0.05 mm, texels to a hundredth, normals to a degree") {
  constexpr double step_m = 1.0 / 16384;  // of the grid of an outcrop of this size
  std::size_t compared = 0;
  for (const char* name : {"tiles/L0_0.glb", "tiles/L0_7.glb", "tiles/L1_0.glb"}) {
    const Mesh plain = tile(tiles(TileCompression::None) / name);
    const Mesh packed = tile(tiles(TileCompression::Meshopt) / name);
    REQUIRE(packed.triangle_count() == plain.triangle_count());
    for (const glm::vec3& p : packed.vertices.positions) {
      CHECK(std::remainder(static_cast<double>(p.x), step_m) == 0.0);
    }
    const auto wanted = corners_of(plain, step_m);
    const auto found = corners_of(packed, step_m);
    const auto decoded = decode_image(*packed.textures.front().encoded, name);
    REQUIRE(decoded);
    const double texel = 1.0 / std::max(decoded->width, decoded->height);
    std::size_t same = 0;
    for (std::size_t t = 0; t < wanted.size(); ++t) {
      bool equal = true;
      for (int k = 0; k < 3; ++k) {
        const Corner& a = wanted[t][k];
        const Corner& b = found[t][k];
        double turned = 0.0;
        for (int c = 0; c < 3; ++c) equal = equal && a[c] == b[c];
        for (int c = 3; c < 5; ++c) equal = equal && std::abs(a[c] - b[c]) < 0.01 * texel;
        for (int c = 5; c < 8; ++c) turned += (a[c] - b[c]) * (a[c] - b[c]);
        equal = equal && std::sqrt(turned) < 0.0175;
      }
      if (equal) ++same;
    }
    // Corners in one place with two uvs may sort otherwise.
    CHECK(same > wanted.size() * 97 / 100);
    compared += wanted.size();
  }
  CHECK(compared > 500);
}

TEST_CASE("Features of faces are in the tiles, plain and packed, with their names") {
  Mesh mesh = small_cliff();
  mesh.features = {{.id = "cliff"}, {.id = "bed 1", .semantic_class = "Sandstone", .parent = 0}, {.id = "bed 2"}};
  const Box box = bounds(mesh);
  mesh.face_features.clear();
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const double z = static_cast<double>(mesh.vertices.positions[mesh.indices[3 * std::size_t{f}]].z);
    const double height = (z - box.min.z) / box.size().z;
    mesh.face_features.push_back(height < 0.3 ? 1 : (height < 0.6 ? 2 : none));
  }
  const auto triangles_of = [](const Mesh& of, std::map<std::string, std::uint32_t>& count) {
    for (FaceId f = 0; f < of.triangle_count(); ++f) {
      if (is_skirt(of, f)) continue;
      const FeatureId feature = of.face_feature(f);
      ++count[feature == none ? "" : of.features[feature].id + '|' + of.features[feature].semantic_class];
    }
  };
  std::map<std::string, std::uint32_t> wanted;
  triangles_of(mesh, wanted);
  REQUIRE(wanted.size() == 3);
  for (const TileCompression compression : {TileCompression::None, TileCompression::Meshopt}) {
    const fs::path folder = scratch_folder("packed_features");
    REQUIRE(write_outcrop(mesh, folder, {.pyramid = small_tiles(), .compression = compression}));
    std::map<std::string, std::uint32_t> found;
    for (const auto& [name, content] : files_of(folder)) {
      if (name.starts_with("tiles/L0_")) triangles_of(tile(folder / name), found);
    }
    CHECK(found == wanted);
    const auto check = check_tileset(folder / "tileset.json");
    REQUIRE(check);
    CHECK(check->faults.empty());
  }
}

TEST_CASE("A packed tile that is damaged is refused or read, and never believed in its sizes") {
  const fs::path folder = scratch_folder("packed_damaged");
  const fs::path file = folder / "tile.glb";
  fs::copy_file(tiles(TileCompression::Meshopt) / "tiles/L0_0.glb", file);
  const std::string good = files_of(folder)["tile.glb"];
  const auto read_as = [&](const std::string& bytes) {
    std::ofstream{file, std::ios::binary} << bytes;
    return read_mesh(file, {.textures = LoadTextures::Reference});
  };
  REQUIRE(read_as(good));
  const auto with = [&](const std::string& from, const std::string& to) {
    REQUIRE(from.size() == to.size());
    std::string bad = good;
    const std::size_t at = bad.find(from);
    REQUIRE(at != std::string::npos);
    return bad.replace(at, from.size(), to);
  };
  CHECK(read_as(with("\"mode\":\"ATTRIBUTES\"", "\"mode\":\"ATTRIBUTED\"")).error().code == ErrorCode::BadData);
  CHECK(read_as(with("\"filter\":\"EXPONENTIAL\"", "\"filter\":\"EXPONENTIOL\"")).error().code == ErrorCode::BadData);
  CHECK(read_as(with("\"buffer\":0,", "\"buffer\":5,")).error().code == ErrorCode::Unsupported);
  CHECK(read_as(with("\"byteStride\":12,\"count\"", "\"byteStride\":13,\"count\"")).error().code == ErrorCode::BadData);
  const std::size_t count = good.find("\"count\":");
  std::string many = good;
  many.replace(count, 11, "\"count\":9e9");
  CHECK(!read_as(many));
  Rng rng{11};
  std::size_t refused = 0;
  for (int i = 0; i < 150; ++i) {
    std::string bad = good;
    for (int k = 0; k < 3; ++k) {
      char& byte = bad[rng.below(static_cast<std::uint32_t>(bad.size()))];
      byte = static_cast<char>(byte ^ (1 << rng.below(8)));
    }
    if (i % 3 == 0) bad.resize(rng.below(static_cast<std::uint32_t>(bad.size())));
    if (!read_as(bad)) ++refused;
  }
  CHECK(refused > 50);  // those that are cut off, at the least
}

}  // namespace lodestone::test
