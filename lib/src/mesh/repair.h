// SPDX-License-Identifier: MIT
// The steps of repair(), one function each.
#pragma once

#include <cstdint>

#include <lodestone/mesh.h>

namespace lodestone {

// Moves points onto earlier ones that are nearer than the tolerance; returns how many moved.
std::uint32_t weld_near_points(Mesh& mesh, double tolerance_m);

// Returns how many points were inserted into edges.
std::uint32_t close_t_junctions(Mesh& mesh, double tolerance_m);

// Caps holes whose border is no longer than that; returns how many.
std::uint32_t fill_holes(Mesh& mesh, double perimeter_m);

// Returns how many triangles were turned.
std::uint32_t orient_faces(Mesh& mesh);

}  // namespace lodestone
