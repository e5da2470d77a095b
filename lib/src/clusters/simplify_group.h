// SPDX-License-Identifier: MIT
// One job of the level loop: a group merged, simplified inside its locked border, and split again. A pure function of
// its input, so that any number of threads gives the same.
#pragma once

#include <string>
#include <vector>

#include <lodestone/clusters.h>

#include "clusters/group.h"
#include "clusters/live.h"
#include "collapse/engine.h"

namespace lodestone::clusters {

// What the job knows of the whole.
struct Work {
  const Mesh& source;
  const Ground& ground;
  const Live& live;
  const Grouping& grouping;
  const ClusterOptions& options;
  double diagonal_m = 0.0;  // of the source
};

struct GroupResult {
  bool reduced = false;
  std::string cause;  // why not
  double error_m = 0.0;
  std::vector<LiveFace> faces;     // in order of clusters
  std::vector<Range> clusters;     // of `faces`
  std::vector<VertexId> vertices;  // of the ground, that the group uses
  // Per element of `vertices`:
  VertexArrays values;               // after the simplification
  std::vector<std::uint32_t> point;  // after it
  std::vector<float> deviation_m;
  std::vector<std::uint32_t> survivor;  // place in `vertices` of where it went; itself if it is still used
  std::vector<std::uint8_t> locked;
};

// After `failures` of its clusters less is demanded.
[[nodiscard]] GroupResult simplify_group(const Work& work, const Group& group, std::uint32_t failures,
                                         collapse::Scruples scruples, const Context& context);

}  // namespace lodestone::clusters
