// SPDX-License-Identifier: MIT
// Cameras and cuts for tests of cluster graphs.
#pragma once

#include <lodestone/clusters.h>

#include "base/rng.h"

namespace lodestone::test {

[[nodiscard]] View random_view(Rng& rng, const Sphere& around);

struct FaultCounts {
  std::uint64_t cracks = 0;
  std::uint64_t morphed_cracks = 0;  // the same cuts with every group somewhere on its way
  std::size_t different_cuts = 0;
};
// Cuts from random cameras, each at a random error, with all pages and with a random part of them.
[[nodiscard]] FaultCounts try_cuts(const ClusterGraph& graph, int cameras, std::uint64_t seed);

// The same for random labellings of groups as refined or not, each refined only where all groups that hold what it made
// are: any cut that is valid at all, whatever errors and bounds say.
[[nodiscard]] FaultCounts try_labellings(const ClusterGraph& graph, int labellings, std::uint64_t seed);

// The finest cut.
[[nodiscard]] std::vector<NodeId> leaves(const ClusterGraph& graph);

}  // namespace lodestone::test
