// SPDX-License-Identifier: MIT
// Borders that are the same line of vertices on several zooms, so that nothing opens between these.
#pragma once

#include <array>
#include <optional>

#include "terrain/chains.h"

namespace lodestone::terrain {

struct SharedBorderOptions {
  std::uint32_t from_zoom = 0;
  std::uint32_t to_zoom = 0;
  ChainOptions chain;                     // of to_zoom, heights in steps that all these zooms have
  std::array<float, 2> polar_height_m{};  // south, north; NaN: no data there
};

// The most zooms above the finest: with more, neighbouring posts of the finest would be one place on the coarsest.
inline constexpr std::uint32_t most_shared_zooms = 6;

// Vertices along a side of a tile between from_zoom and to_zoom, corners included; none where data is missing along the
// line or beside it on one of the zooms. Reads the line from end to end of the coarsest tile that it bounds. Errors of
// the source only.
[[nodiscard]] Result<std::optional<std::vector<Tin::Vertex>>> shared_border(const HeightSource& source,
                                                                            const TileId& tile, Side side,
                                                                            const SharedBorderOptions& options);

}  // namespace lodestone::terrain
