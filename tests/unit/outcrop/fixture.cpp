// SPDX-License-Identifier: MIT
#include "fixture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <iterator>

#include <lodestone/generate.h>
#include <catch2/catch.hpp>

namespace lodestone::test {

const Mesh& small_cliff() {
  static const Mesh mesh = [] {
    GenerateOptions options{.triangles = 8'000, .textures = 3, .texture_size_px = 256, .seed = 5, .charts = 6};
    auto made = generate_outcrop(options);
    REQUIRE(made);
    return std::move(*made);
  }();
  return mesh;
}

std::vector<TextureInfo> texture_sizes(const Mesh& mesh) {
  std::vector<TextureInfo> sizes;
  for (const Texture& texture : mesh.textures) sizes.push_back({texture.image->width, texture.image->height, 0});
  return sizes;
}

OutcropOptions small_tiles() { return {.tile_bytes = 24'000}; }

std::shared_ptr<const OutcropPyramid> pyramid_of(const Mesh& mesh, const OutcropOptions& options, unsigned workers) {
  const std::vector<TextureInfo> sizes = texture_sizes(mesh);
  auto pyramid = OutcropPyramid::build(mesh, sizes, options, {.max_workers = workers});
  REQUIRE(pyramid);
  return *pyramid;
}

std::size_t open_edges(const std::vector<Mesh>& tiles) {
  using Point = std::array<std::uint32_t, 3>;
  std::vector<std::array<Point, 2>> edges;
  const auto bits = [](const glm::vec3& p) {
    return Point{std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                 std::bit_cast<std::uint32_t>(p.z)};
  };
  for (const Mesh& tile : tiles) {
    for (std::size_t c = 0; c < tile.indices.size(); ++c) {
      Point a = bits(tile.vertices.positions[tile.indices[c]]);
      Point b = bits(tile.vertices.positions[tile.indices[c % 3 == 2 ? c - 2 : c + 1]]);
      if (b < a) std::swap(a, b);
      if (a != b) edges.push_back({a, b});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool before = i > 0 && edges[i - 1] == edges[i];
    const bool after = i + 1 < edges.size() && edges[i + 1] == edges[i];
    if (!before && !after) ++open;
  }
  return open;
}

void remove_skirts(Mesh& mesh) {
  Mesh bare = mesh;
  bare.indices.clear();
  bare.face_materials.clear();
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    if (is_skirt(mesh, f)) continue;
    for (std::size_t k = 0; k < 3; ++k) bare.indices.push_back(mesh.indices[3 * std::size_t{f} + k]);
    bare.face_materials.push_back(mesh.face_materials[f]);
  }
  bare.face_features.clear();
  remove_unused(bare);
  mesh = std::move(bare);
}

std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder}) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream{entry.path(), std::ios::binary};
    files[std::filesystem::relative(entry.path(), folder).generic_string()] =
        std::string{std::istreambuf_iterator<char>{stream}, {}};
  }
  return files;
}

}  // namespace lodestone::test
