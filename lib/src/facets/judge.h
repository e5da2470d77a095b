// SPDX-License-Identifier: MIT
// What a set of moves costs, and whether it may be done.
#pragma once

#include "facets/facet_mesh.h"

namespace lodestone::facets {

// Costs are integrals of squared distance over area, m^4: what adds up to the mean square error.
struct Verdict {
  bool allowed = false;
  bool tilts = false;  // some face leaves its direction
  double cost = 0.0;
  double error_m = 0.0;
  std::uint32_t faces_gone = 0;

  // The price per face, by which everything is ordered.
  [[nodiscard]] double key() const noexcept { return cost / (faces_gone == 0 ? 1 : faces_gone); }
};

// A point slides onto a neighbour. Looks at borders and at the outlines of materials as well. Not allowed if it costs
// more than `most_cost`.
[[nodiscard]] Verdict judge_slide(const FacetMesh& mesh, Moved& moved, const Move& move, double most_cost);

// Planes move: whatever stands between them and their new place shrinks.
[[nodiscard]] Verdict judge_shift(const FacetMesh& mesh, Moved& moved, std::span<const Move> moves);

}  // namespace lodestone::facets
