// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include <lodestone/generate.h>
#include <lodestone/metrics.h>
#include <catch2/catch.hpp>

#include "fixture.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

// A triangle by its corners' positions and places in the photograph (sixteenths of a pixel), in any rotation.
using Corner = std::array<std::int64_t, 5>;
using Triangle = std::array<Corner, 3>;

Triangle rotated(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

Corner corner(const glm::vec3& p, const glm::dvec2& px) {
  const auto bits = [](float x) { return static_cast<std::int64_t>(std::lround(double{x} * 1e6)); };
  return {bits(p.x), bits(p.y), bits(p.z), std::llround(px.x * 16.0), std::llround(px.y * 16.0)};
}

std::vector<Triangle> triangles_of_source(const Mesh& mesh) {
  std::vector<Triangle> all;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const Image& image = *mesh.textures[mesh.materials[mesh.face_material(f)].texture].image;
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = mesh.indices[3 * std::size_t{f} + k];
      const glm::vec2 uv = mesh.vertices.uvs[v];
      t[k] = corner(mesh.vertices.positions[v], {double{uv.x} * image.width, (1.0 - double{uv.y}) * image.height});
    }
    all.push_back(rotated(t));
  }
  std::sort(all.begin(), all.end());
  return all;
}

// The piece of a tile's texture that a place lies in, gutter included.
const TexturePiece& piece_at(const TileTexture& texture, const glm::dvec2& at) {
  const auto found = std::find_if(texture.pieces.begin(), texture.pieces.end(), [&](const TexturePiece& p) {
    return at.x >= p.to_x && at.y >= p.to_y && at.x <= p.to_x + p.width && at.y <= p.to_y + p.height;
  });
  REQUIRE(found != texture.pieces.end());
  return *found;
}

std::vector<Triangle> triangles_of_level_0(const OutcropPyramid& pyramid) {
  std::vector<Triangle> all;
  for (std::uint32_t i = 0; i < pyramid.levels().front().tiles; ++i) {
    const TileContent content = pyramid.content(i);
    for (FaceId f = 0; f < content.mesh.triangle_count(); ++f) {
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId v = content.mesh.indices[3 * std::size_t{f} + k];
        const glm::vec2 uv = content.mesh.vertices.uvs[v];
        const glm::dvec2 at{double{uv.x} * content.texture.width, (1.0 - double{uv.y}) * content.texture.height};
        const TexturePiece& piece = piece_at(content.texture, at);
        const OutcropSegment& s = pyramid.segments()[piece.segment];
        t[k] = corner(
            content.mesh.vertices.positions[v],
            at - glm::dvec2{piece.to_x, piece.to_y} + glm::dvec2{piece.from_x + s.left_px, piece.from_y + s.top_px});
      }
      all.push_back(rotated(t));
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Mesh> tiles_of_level(const OutcropPyramid& pyramid, std::uint32_t level) {
  std::vector<Mesh> tiles;
  for (std::uint32_t i = 0; i < pyramid.tiles().size(); ++i) {
    if (pyramid.tiles()[i].level == level) tiles.push_back(pyramid.content(i).mesh);
  }
  return tiles;
}

// One image with two charts that lie side by side in it and far apart in space.
Mesh torn_charts() {
  Mesh left = grid(30, 30, 0.05F);
  Mesh right = left;
  for (auto& uv : left.vertices.uvs) uv = {uv.x, uv.y * 0.35F};
  for (auto& uv : right.vertices.uvs) uv = {uv.x, 0.35F + uv.y * 0.65F};
  for (auto& p : right.vertices.positions) p.x += 1000.0F;
  const std::uint32_t shift = left.vertex_count();
  for (std::size_t v = 0; v < right.vertices.positions.size(); ++v) {
    left.vertices.positions.push_back(right.vertices.positions[v]);
    left.vertices.uvs.push_back(right.vertices.uvs[v]);
    if (!left.vertices.normals.empty()) left.vertices.normals.push_back(right.vertices.normals[v]);
  }
  for (const VertexId v : right.indices) left.indices.push_back(v + shift);
  left.face_materials.clear();
  left.face_features.clear();
  return left;
}

Mesh textured(Mesh mesh, std::uint32_t size_px) {
  Image image{size_px, size_px, 3, {}};
  image.pixels.assign(std::size_t{size_px} * size_px * 3, 128);
  mesh.textures = {{.name = "rock", .image = std::make_shared<const Image>(std::move(image))}};
  mesh.materials = {{.name = "rock", .texture = 0}};
  return mesh;
}

}  // namespace

TEST_CASE("The finest level has every source triangle, with its positions and its place in the photograph") {
  const Mesh& cliff = small_cliff();
  for (const TileSplit split : {TileSplit::Texture, TileSplit::Space}) {
    OutcropOptions options = small_tiles();
    options.split = split;
    const auto pyramid = pyramid_of(cliff, options);
    CHECK(pyramid->levels().front().tiles > 8);
    CHECK(triangles_of_level_0(*pyramid) == triangles_of_source(cliff));
  }
}

TEST_CASE("Tiles of one level fit without a crack, bit for bit") {
  const auto pyramid = pyramid_of(small_cliff(), small_tiles());
  REQUIRE(pyramid->levels().size() >= 3);
  const MeshReport source = inspect(small_cliff());
  for (std::uint32_t level = 0; level < pyramid->levels().size(); ++level) {
    const std::vector<Mesh> tiles = tiles_of_level(*pyramid, level);
    const std::size_t open = open_edges(tiles);
    CHECK(open == pyramid->levels()[level].open_edges);
    CHECK(open <= source.boundary_edges);
    if (tiles.size() == 1) continue;
    std::size_t alone = 0;
    for (const Mesh& tile : tiles) alone += open_edges({tile});
    CHECK(alone > open);  // there are borders that could have cracked
  }
  CHECK(pyramid->levels().front().open_edges == source.boundary_edges);
}

TEST_CASE("Boxes enclose what is below, errors grow upwards, every tile has its parent") {
  const auto pyramid = pyramid_of(small_cliff(), small_tiles());
  for (std::uint32_t i = 0; i < pyramid->tiles().size(); ++i) {
    const OutcropTile& tile = pyramid->tiles()[i];
    CHECK((tile.parent == none) == (i == pyramid->root()));
    CHECK(tile.children.size() <= 4);
    CHECK((tile.level == 0) == tile.children.empty());
    for (const std::uint32_t c : tile.children) {
      const OutcropTile& child = pyramid->tiles()[c];
      CHECK(child.parent == i);
      CHECK(child.level + 1 == tile.level);
      CHECK(child.error_m < tile.error_m);
      CHECK(glm::all(glm::lessThanEqual(tile.bounds.min, child.bounds.min)));
      CHECK(glm::all(glm::greaterThanEqual(tile.bounds.max, child.bounds.max)));
    }
  }
}

TEST_CASE("As a graph the pyramid is cut by the one rule: from far the root, from nowhere coarser than asked") {
  const auto pyramid = pyramid_of(small_cliff(), small_tiles());
  const AssembledGraph assembled = pyramid->graph();
  CHECK(validate(assembled.graph).ok());
  REQUIRE(assembled.graph.nodes.size() == pyramid->tiles().size());
  CutScratch scratch;
  std::vector<NodeId> cut;
  View view;
  view.eye = {0.0, -1e6, 0.0};
  select_cut(assembled.graph, view, {}, scratch, cut);
  REQUIRE(cut.size() == 1);
  CHECK(assembled.node_draft[cut.front()] == pyramid->root());
  select_cut(assembled.graph, view, {.error_px = 1e-9, .culling = Culling::None}, scratch, cut);
  std::uint32_t triangles = 0;
  for (const NodeId n : cut) triangles += pyramid->tiles()[assembled.node_draft[n]].triangles;
  CHECK(triangles == small_cliff().triangle_count());
}

TEST_CASE("A level's error bounds its measured distance from the source and includes the texel") {
  const Mesh& cliff = small_cliff();
  const auto pyramid = pyramid_of(cliff, small_tiles());
  for (std::uint32_t level = 1; level < pyramid->levels().size(); ++level) {
    double largest = 0.0;
    for (std::uint32_t i = 0; i < pyramid->tiles().size(); ++i) {
      if (pyramid->tiles()[i].level != level) continue;
      largest = std::max(largest, pyramid->tiles()[i].error_m);
      CHECK(pyramid->tiles()[i].error_m >= pyramid->tiles()[i].texel_m);
    }
    Mesh whole = cliff;
    whole.vertices = {};
    whole.indices.clear();
    whole.face_materials.clear();
    whole.face_features.clear();
    for (const Mesh& tile : tiles_of_level(*pyramid, level)) {
      for (const VertexId v : tile.indices) whole.indices.push_back(v + whole.vertices.size());
      whole.vertices.positions.insert(whole.vertices.positions.end(), tile.vertices.positions.begin(),
                                      tile.vertices.positions.end());
    }
    const auto distance = compare(cliff, whole, {.samples = 20'000});
    REQUIRE(distance);
    CHECK(distance->p999_m <= largest);
  }
}

TEST_CASE("Levels take their triangles from the ratio, tiles their bytes from the threshold") {
  OutcropOptions options = small_tiles();
  options.ratio = 0.5;
  const auto pyramid = pyramid_of(small_cliff(), options);
  for (std::size_t level = 1; level < pyramid->levels().size(); ++level) {
    const double ratio =
        static_cast<double>(pyramid->levels()[level].triangles) / pyramid->levels()[level - 1].triangles;
    CHECK(ratio == Approx(0.5).margin(0.02));
    CHECK(pyramid->levels()[level].texture_scale == Approx(0.5 * pyramid->levels()[level - 1].texture_scale));
    CHECK(pyramid->levels()[level].tiles <= pyramid->levels()[level - 1].tiles);
  }
  CHECK(pyramid->levels().back().tiles == 1);
}

TEST_CASE("Without a ratio rock that is rough beside its texels keeps its triangles, rock that is smooth loses them") {
  const auto second_step = [](std::uint32_t width_px) {
    std::vector<TextureInfo> sizes = texture_sizes(small_cliff());
    for (TextureInfo& size : sizes) size.width_px = size.height_px = width_px;
    const auto pyramid = OutcropPyramid::build(small_cliff(), sizes, {.tile_bytes = 24'000});
    REQUIRE(pyramid);
    const std::vector<OutcropLevel>& levels = (*pyramid)->levels();
    REQUIRE(levels.size() > 2);
    return static_cast<double>(levels[2].triangles) / levels[1].triangles;
  };
  CHECK(second_step(2048) == Approx(0.7).margin(0.01));  // a texel of centimetres
  CHECK(second_step(16) == Approx(0.2).margin(0.01));    // of metres
}

TEST_CASE("However large tiles are, the root is small, since nothing shows before it is read") {
  const auto cliff = generate_outcrop({.triangles = 30'000, .textures = 1, .texture_size_px = 64});
  REQUIRE(cliff);
  const auto pyramid = pyramid_of(*cliff, {.tile_bytes = 8'000'000});
  CHECK(pyramid->levels().front().tiles == 1);
  constexpr std::uint32_t bytes_of_a_triangle = 20;  // with its share of vertices
  CHECK(pyramid->levels().back().triangles < 256'000 / bytes_of_a_triangle);
}

TEST_CASE("The same pyramid comes out for any number of workers") {
  const auto one = pyramid_of(small_cliff(), small_tiles(), 1);
  for (const unsigned workers : {2U, 8U}) {
    const auto other = pyramid_of(small_cliff(), small_tiles(), workers);
    REQUIRE(other->tiles().size() == one->tiles().size());
    for (std::uint32_t i = 0; i < one->tiles().size(); ++i) {
      const TileContent a = one->content(i);
      const TileContent b = other->content(i);
      CHECK(a.mesh.vertices == b.mesh.vertices);
      CHECK(a.mesh.indices == b.mesh.indices);
      CHECK(one->tiles()[i].error_m == other->tiles()[i].error_m);
    }
  }
}

TEST_CASE("Charts that lie together in the image but apart in space are cut in space") {
  const auto pyramid = pyramid_of(textured(torn_charts(), 256), {.tile_bytes = 4096});
  CHECK(pyramid->segments().front().charts == 2);
  CHECK(pyramid->segments().front().split == TileSplit::Space);
  for (std::uint32_t i = 0; i < pyramid->levels().front().tiles; ++i) {
    CHECK(pyramid->tiles()[i].bounds.size().x < 500.0);
  }
  const auto sheet = pyramid_of(textured(grid(40, 40), 256), {.tile_bytes = 4096});
  CHECK(sheet->segments().front().split == TileSplit::Texture);
}

TEST_CASE("Textures that repeat are unwrapped, and left out where a triangle repeats too often") {
  Mesh mesh = textured(grid(20, 20), 64);
  for (auto& uv : mesh.vertices.uvs) uv = uv * 3.0F - 7.5F;
  const std::vector<TextureInfo> sizes = texture_sizes(mesh);
  const auto pyramid = OutcropPyramid::build(mesh, sizes, {.tile_bytes = 4096});
  REQUIRE(pyramid);
  CHECK((*pyramid)->segments().front().width_px <= 2 * 64 + 4);
  CHECK((*pyramid)->levels().front().triangles == mesh.triangle_count());

  // Far out, a step of floats is too wide for pixels.
  for (const float far : {900.0F, 3000.0F, 1e6F}) {
    Mesh moved = mesh;
    for (auto& uv : moved.vertices.uvs) uv.x += far;
    const auto built = OutcropPyramid::build(moved, sizes, {});
    REQUIRE(built);
    CHECK(((*built)->segments().front().texture == none) == (far > 1000.0F));
    CHECK(built.warnings().empty() == (far < 1000.0F));
  }

  for (auto& uv : mesh.vertices.uvs) uv *= 100.0F;
  const auto plain = OutcropPyramid::build(mesh, sizes, {});
  REQUIRE(plain);
  REQUIRE(plain.warnings().size() == 1);
  CHECK(plain.warnings().front().count == mesh.triangle_count());
  REQUIRE((*plain)->segments().size() == 1);
  CHECK((*plain)->segments().front().texture == none);
}

TEST_CASE("Charts without area, plain faces and vertex colours become tiles as well") {
  Mesh mesh = textured(grid(20, 20), 64);
  for (auto& uv : mesh.vertices.uvs) uv = {0.5F, 0.5F};
  CHECK(pyramid_of(mesh, {.tile_bytes = 4096})->levels().front().triangles == mesh.triangle_count());

  Mesh plain = grid(30, 30);
  plain.textures.clear();
  plain.materials = {{.name = "rock"}};
  plain.vertices.colors.assign(plain.vertex_count(), {200, 100, 50, 255});
  const auto pyramid = pyramid_of(plain, {.tile_bytes = 4096});
  REQUIRE(pyramid->segments().size() == 1);
  CHECK(pyramid->segments().front().texture == none);
  CHECK(pyramid->levels().size() > 1);
  const TileContent content = pyramid->content(pyramid->root());
  CHECK(content.texture.pieces.empty());
  CHECK(content.mesh.textures.empty());
  CHECK(content.mesh.vertices.colors.size() == content.mesh.vertices.size());
}

TEST_CASE("Nonsense is refused by name") {
  Mesh mesh = textured(grid(4, 4), 16);
  const std::vector<TextureInfo> sizes = texture_sizes(mesh);
  CHECK(OutcropPyramid::build(mesh, {}, {}).error().code == ErrorCode::BadArgument);
  CHECK(OutcropPyramid::build(mesh, sizes, {.ratio = 1.5}).error().code == ErrorCode::BadArgument);
  mesh.vertices.uvs.front().x = std::nanf("");
  CHECK(OutcropPyramid::build(mesh, sizes, {}).error().code == ErrorCode::BadData);
  Mesh empty = mesh;
  empty.indices.clear();
  empty.vertices = {};
  CHECK(OutcropPyramid::build(empty, sizes, {}).error().code == ErrorCode::BadData);
  const std::atomic<bool> cancelled{true};
  CHECK(OutcropPyramid::build(small_cliff(), texture_sizes(small_cliff()), {}, {.cancel = &cancelled}).error().code ==
        ErrorCode::Cancelled);
}

}  // namespace lodestone::test
