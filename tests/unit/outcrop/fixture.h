// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <lodestone/outcrop.h>

namespace lodestone::test {

// A small generated cliff with pixels, made once: 8,000 triangles, 3 images of 256², 6 charts.
[[nodiscard]] const Mesh& small_cliff();
[[nodiscard]] std::vector<TextureInfo> texture_sizes(const Mesh& mesh);
// Tiles of a few kB, so that there are several levels.
[[nodiscard]] std::shared_ptr<const OutcropPyramid> pyramid_of(const Mesh& mesh, const OutcropOptions& options,
                                                               unsigned workers = 1);
[[nodiscard]] OutcropOptions small_tiles();

// Edges with one triangle of the tiles of a level together, by the bits of positions.
[[nodiscard]] std::size_t open_edges(const std::vector<Mesh>& tiles);

void remove_skirts(Mesh& mesh);

// Name below the folder to content.
[[nodiscard]] std::map<std::string, std::string> files_of(const std::filesystem::path& folder);

}  // namespace lodestone::test
