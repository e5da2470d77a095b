// SPDX-License-Identifier: MIT
// The mesh of the level at hand: faces between vertices of the ground, whose values change from level to level.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone::clusters {

struct LiveFace {
  std::array<VertexId, 3> vertex{};  // of the ground
  FaceId id = none;                  // of the source: material and feature
};

// A face between fewer than three points covers nothing and has no edges: the simplification drops it.
[[nodiscard]] inline bool is_collapsed(const std::array<std::uint32_t, 3>& points) noexcept {
  return points[0] == points[1] || points[1] == points[2] || points[2] == points[0];
}

struct LiveCluster {
  Range faces;
  std::uint32_t draft = none;  // which node draft it is
  std::uint32_t level = 0;
  std::uint32_t failures = 0;  // rounds in which its group could not be reduced
};

struct Live {
  std::vector<LiveFace> faces;
  std::vector<LiveCluster> clusters;

  [[nodiscard]] std::span<const LiveFace> faces_of(const LiveCluster& c) const noexcept {
    return {faces.data() + c.faces.begin, c.faces.size()};
  }
};

// What is known, at the level at hand, of the vertices that the source uses and of the points where they lie. Numbered
// anew, in the order of blocks in space, so that what is near lies near in memory.
struct Ground {
  VertexArrays values;                  // per vertex
  std::vector<std::uint32_t> point_of;  // per vertex: points are places shared by vertices
  std::vector<float> deviation_m;       // per point: of the surface there from the source
  std::vector<std::uint8_t> locked;     // per point: on a cluster that has ended
  std::vector<std::uint8_t> border;     // per point: on the true border, or taken there
};

}  // namespace lodestone::clusters
