// SPDX-License-Identifier: MIT
// How far a level is from the source, tile by tile: its surface, and the chains along which its tiles meet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/mesh.h>

#include "geometry/bvh.h"
#include "outcrop/borders.h"

namespace lodestone::outcrop {

// One surface cut into tiles.
struct Tiled {
  const std::vector<glm::vec3>& positions;
  const std::vector<VertexId>& indices;
  std::span<const std::uint32_t> tile_of_face;
  const Weld& weld;
  std::span<const BorderEdge> borders;  // between the tiles
  std::span<const std::uint8_t> solid;  // per point: held against the other surface; empty = all
};

struct TileDeviation {
  double surface_m = 0.0;
  double border_m = 0.0;
};

// Between each two of the corner points that follow each other, as triangles without area.
[[nodiscard]] TriangleBvh segments_between(const std::vector<glm::vec3>& positions, const Weld& weld,
                                           const std::vector<std::uint32_t>& ends);

class Deviation {
 public:
  Deviation(const std::vector<glm::vec3>& positions, const std::vector<VertexId>& indices)
      : source_(positions, indices) {}

  // Per tile the largest distance of one of its vertices from the source, and of a source vertex that it stands for
  // from the level; the same for the chains. `source` is the source in the level's tiles.
  [[nodiscard]] std::vector<TileDeviation> measure(const Tiled& source, const Tiled& level, std::uint32_t tiles,
                                                   const Context& context) const;

 private:
  TriangleBvh source_;
};

}  // namespace lodestone::outcrop
