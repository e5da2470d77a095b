// SPDX-License-Identifier: MIT
// Faces of more than three corners, as files have them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lodestone {

// Triangles, as positions in `points`, that cover the polygon; n - 2 of them unless it crosses itself. A fan where one
// corner sees all others (every convex polygon), else a triangulation. `triangles` is replaced.
void split_polygon(std::span<const glm::dvec3> points, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace lodestone
