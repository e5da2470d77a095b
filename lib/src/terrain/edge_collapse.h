// SPDX-License-Identifier: MIT
// Edge collapse of a TIN whose borders stay: by error, or down to a number of edges.
#pragma once

#include <cstdint>
#include <span>

#include "terrain/lattice.h"

namespace lodestone::terrain {

struct CollapseOptions {
  double limit_m = 0.0;            // no post may be farther off; unless target_edges is given
  std::uint32_t target_edges = 0;  // 0: by error
  double step_m = 1.0;             // heights are multiples of it
  double volume_weight = 0.5;
  double shape_weight = 1e-10;
  std::span<const Post> fixed = {};  // vertices at these posts stay
};

[[nodiscard]] Tin collapse_edges(const Tin& tin, const TileLattice& lattice, const CollapseOptions& options);

}  // namespace lodestone::terrain
