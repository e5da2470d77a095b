// SPDX-License-Identifier: MIT
// The order of triangles within a cluster.
#pragma once

#include "clusters/live.h"

namespace lodestone::clusters {

// Puts the faces of one cluster in order of materials, and within a material in an order in which each, where possible,
// lies at the one before or at one shortly before it, and begins with the edge between: a file needs few bits for that.
void put_in_order(std::span<LiveFace> faces, const Mesh& source);

}  // namespace lodestone::clusters
