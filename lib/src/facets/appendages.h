// SPDX-License-Identifier: MIT
// Detached parts that go: balconies, railings, pipes, antennas, columns, frames.
#pragma once

#include "facets/parts.h"

namespace lodestone::facets {

// The part shifts flat into the plane of what it hangs on and goes behind it. False where there is no such plane: it
// shrinks to a point.
bool sink(FacetMesh& mesh, const Part& part, progressive::EditLog& log);

}  // namespace lodestone::facets
