// SPDX-License-Identifier: MIT
// The two ways of writing a pyramid.
#pragma once

#include <filesystem>

#include <lodestone/terrain_files.h>

namespace lodestone {

// A tile as glb in earth-centred coordinates, with skirts, because 3D Tiles clients make none.
[[nodiscard]] Status write_tile_glb(const TerrainTile& tile, double skirt_m, const std::filesystem::path& file,
                                    const Context& context);
// How far skirts go down at a zoom.
[[nodiscard]] double skirt_depth_m(const TerrainPyramid& pyramid, std::uint32_t zoom);
[[nodiscard]] Status write_tileset(const TerrainPyramid& pyramid, const std::filesystem::path& folder);

}  // namespace lodestone
