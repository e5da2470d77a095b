// SPDX-License-Identifier: MIT
// A tileset.json with boxes and one content per tile, and its payloads. Nothing in it is trusted.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <lodestone/formats.h>

#include "tiles3d/tile_cache.h"

namespace lodestone {

struct TilesetTile {
  std::uint32_t parent = none;
  std::vector<std::uint32_t> children;
  std::uint32_t level = 0;  // 0 = the deepest tiles of the tree
  Box bounds;
  double geometric_error = 0.0;
  std::string uri;  // empty if it has no content
};

// The root first, parents before children.
struct Tileset {
  std::filesystem::path folder;
  std::vector<TilesetTile> tiles;
  std::uint32_t level_count = 0;
  std::vector<std::uint64_t> open_edges;  // per level, as the writer counted them; empty if it did not
  glm::dvec3 origin{0.0};  // in the source's coordinates if the writer told it, else the root's transform
};

constexpr std::uint64_t most_tileset_bytes = 256ULL << 20;

// Boxes, spheres (as the box around them). Errors: BadData for what is missing, out of range, or leaves the folder.
[[nodiscard]] Result<Tileset> read_tileset(const std::filesystem::path& file);
[[nodiscard]] Result<Tileset> parse_tileset(std::span<const std::uint8_t> bytes, const std::string& name);

// By its name: the root of a tree of OpenSceneGraph files.
[[nodiscard]] bool is_osgb(const std::filesystem::path& file);

struct LoadedTile {
  Mesh mesh;  // in the frame of the root's content
  std::uint64_t file_bytes = 0;
};
// glb or b3dm.
[[nodiscard]] Result<Mesh> parse_tile(std::span<const std::uint8_t> bytes, const std::filesystem::path& file,
                                      const ReadOptions& options);
[[nodiscard]] Result<LoadedTile> read_tile(const Tileset& tileset, std::uint32_t tile, LoadTextures textures,
                                           TileCache* cache = nullptr);

}  // namespace lodestone
