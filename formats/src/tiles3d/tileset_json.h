// SPDX-License-Identifier: MIT
// tileset.json and the names of what it refers to.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <lodestone/tileset_writer.h>

namespace lodestone {

// CesiumJS and 3DTilesRendererJS refine where the error covers more pixels than this, unless told otherwise.
inline constexpr double client_error_px = 16.0;

// Relative to the folder, with '/'.
[[nodiscard]] std::string tile_name(const OutcropPyramid& pyramid, std::uint32_t tile, TilesVersion version);

// `contents` has a box per tile: of its vertices, skirts with them. A tile's volume holds that and those of its
// children, and no more.
[[nodiscard]] Status write_tileset_json(const OutcropPyramid& pyramid, const std::filesystem::path& file,
                                        TilesVersion version, const std::vector<Box>& contents,
                                        std::vector<Warning>& warnings);

}  // namespace lodestone
