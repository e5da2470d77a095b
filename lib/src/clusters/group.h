// SPDX-License-Identifier: MIT
// Which clusters are simplified together, and where the border between them runs.
#pragma once

#include <vector>

#include "clusters/live.h"

namespace lodestone::clusters {

// An edge, by its points, that faces of a group share with faces of another one.
struct BorderEdge {
  std::uint32_t low = 0, high = 0;
  friend bool operator==(const BorderEdge&, const BorderEdge&) = default;
};

struct Group {
  std::vector<std::uint32_t> clusters;  // places in Live::clusters, ascending
  std::vector<BorderEdge> border;
};

struct Grouping {
  std::vector<Group> groups;
  std::vector<std::uint8_t> shared;  // per point: used by more than one group, or by a cluster that has ended
};

inline constexpr std::uint32_t min_group = 8;
inline constexpr std::uint32_t max_group = 32;

// Groups of about `aim` clusters, 8 to 32 unless there are fewer in all. `ended`: faces that take no part any more.
[[nodiscard]] Grouping group_clusters(const Live& live, std::span<const LiveFace> ended, const Ground& ground,
                                      std::uint32_t aim);

}  // namespace lodestone::clusters
