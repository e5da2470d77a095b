// SPDX-License-Identifier: MIT
// Which edges are worth collapsing in this pass: a quick estimate for every edge, then a threshold.
#pragma once

#include <cstdint>
#include <vector>

#include "collapse/symmetric3.h"
#include "collapse/working_mesh.h"

namespace lodestone::collapse {

// An edge and its estimated cost as the bits of a non-negative float, which sort like the number.
struct Candidate {
  std::uint32_t key = 0;
  std::uint32_t u = 0;
  std::uint32_t v = 0;
};

struct Candidates {
  std::vector<Candidate> edges;  // those below the threshold, in order of faces
  float threshold = 0.0F;        // estimated cost
  std::size_t edge_count = 0;    // edges looked at
};

// How lines are found and weighed.
struct LineRules {
  const Mesh& source;
  const EdgeCollapseOptions& options;
  bool looks_matter = false;  // seams and material borders are lines
  double weight = 1.0;
};

// Sums the quadric of every point over its faces and the lines there, and sets its flags.
[[nodiscard]] std::vector<Symmetric3> sum_quadrics(WorkingMesh& mesh, const LineRules& rules, const Context& context);

// The `share` (0..1) of edges with the least estimated cost.
[[nodiscard]] Candidates find_candidates(const WorkingMesh& mesh, const std::vector<Symmetric3>& quadrics,
                                         Placement placement, double share, const Context& context);

}  // namespace lodestone::collapse
