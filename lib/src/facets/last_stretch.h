// SPDX-License-Identifier: MIT
// From where few faces are left the shared engine of edge collapse goes on, with planes held.
#pragma once

#include "facets/block.h"
#include "facets/facet_mesh.h"

namespace lodestone::facets {

// Share of the source's triangles that is left when the engine takes over. With 4 % distances are better and planes
// worse (docs/DECISIONS.md).
inline constexpr double last_stretch_share = 0.03;

// By the loop: its largest error and its last price.
struct Reached {
  double error_m = 0.0;
  double price = 0.0;
};

// Collapses edges until the options' target or largest error is reached, or nothing is left to go but what the block
// needs. Vertices stay in the planes around them; a plane lets go when its area has become small beside the square of
// the error, and turns at a price from then on. Windows close whole as the price goes on to rise.
// Surfaces may come to cross each other. Returns the number of records. Precondition: the block exists.
std::uint32_t collapse_the_rest(FacetMesh& mesh, const FacetShiftOptions& options, const Block& block, Reached reached,
                                const Context& context, progressive::EditLog& log);

}  // namespace lodestone::facets
