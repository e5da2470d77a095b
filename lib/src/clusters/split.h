// SPDX-License-Identifier: MIT
// Cuts faces into clusters.
#pragma once

#include <vector>

#include "clusters/live.h"

namespace lodestone::clusters {

inline constexpr std::uint32_t max_cluster_vertices = 255;

// The faces put in order of clusters, and where each begins and ends.
struct Pieces {
  std::vector<LiveFace> faces;
  std::vector<Range> clusters;
};

// Of a piece small enough for one graph: as few clusters as hold it, all nearly full, none above 255 vertices.
[[nodiscard]] Pieces split(std::vector<LiveFace> faces, const Ground& ground, std::uint32_t max_triangles);

// Cuts a mesh of any size into compact blocks of at most `block_faces`, each but the last in space a whole number of
// clusters full. Returns where each begins; `faces` are put in order.
[[nodiscard]] std::vector<Range> cut_blocks(std::vector<LiveFace>& faces, std::span<const glm::vec3> positions,
                                            std::uint32_t block_faces, std::uint32_t cluster_faces);

}  // namespace lodestone::clusters
