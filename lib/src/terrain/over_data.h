// SPDX-License-Identifier: MIT
// The part of a triangulation that lies over data, as a TIN.
#pragma once

#include <span>

#include "terrain/delaunay.h"
#include "terrain/lattice.h"

namespace lodestone::terrain {

// Precondition: the rims of voids are edges, so that a triangle lies wholly over cells with data or wholly over others.
// Vertices in the order of their use, heights snapped to the step; NaN: a corner of the tile without data.
[[nodiscard]] Tin tin_over_data(const LatticeDelaunay& triangulation, const TileLattice& lattice,
                                std::span<const double> heights_m, double step_m);

}  // namespace lodestone::terrain
