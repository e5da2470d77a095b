// SPDX-License-Identifier: MIT
// The constants of the engine, in one place. docs/edge_collapse.md tells how each was chosen.
#pragma once

namespace lodestone::collapse {

// Weight of a border, seam or feature line of length l: distance^2 * l^4 * weight beside distance^2 * (2 area)^2 of a
// face. Soup is full of borders that only meet a coplanar neighbour, so there they count less.
inline constexpr double line_weight = 1.0;
inline constexpr double soup_line_weight = 0.1;

// Pull towards the middle of the edge, as a share of the quadric's trace: decides where flat and straight leave it
// open.
inline constexpr double middle_weight = 1e-5;

// Cost of length, as a share of the trace: flat regions collapse short edges first.
inline constexpr double length_weight = 1e-8;

// Share of the mean squared distance that a collapse adds to the square of the error around it.
inline constexpr double error_growth = 4.0;

// A face may not turn further than this in one collapse (cosine).
inline constexpr double flip_cosine = 0.2;

// An edge whose ends have more faces waits until edges around it have collapsed: an attempt costs the square of the
// faces, and the hub of a fan has an edge for each of them.
inline constexpr unsigned most_star_faces = 512;

// A part may vanish once this share of the largest error so far covers its distance from what stays.
inline constexpr double prune_share = 1.0;

// In large meshes parts are looked at again when that has grown so much: to measure them is dear.
inline constexpr double prune_growth = 1.25;

// Share of the edges, cheapest first, that a pass looks at, in small and in large meshes.
inline constexpr double small_share = 0.5;
inline constexpr double large_share = 0.6;

// An edge collapses when its exact cost is at most so many times the estimated cost that is on.
inline constexpr double slack = 2.0;

// Share of the points that may go in one pass, for small and for large meshes: less is nearer to strict order.
inline constexpr double small_quota = 0.05;
inline constexpr double large_quota = 0.5;

}  // namespace lodestone::collapse
