// SPDX-License-Identifier: MIT
// The constants of the cost, in one place. docs/edge_collapse.md tells how each was chosen.
#pragma once

namespace lodestone::collapse {

// Weight of a border, seam or feature line of length l: distance^2 * l^4 * weight beside distance^2 * (2 area)^2 of a
// face.
inline constexpr double line_weight = 1.0;

// Pull towards the middle of the edge, as a share of the quadric's trace: decides where flat and straight leave it
// open.
inline constexpr double middle_weight = 1e-3;

// Cost of length, as a share of the trace: flat regions collapse short edges first.
inline constexpr double length_weight = 1e-8;

// Share of the mean squared distance that a collapse adds to the square of the error around it.
inline constexpr double error_growth = 4.0;

// A face may not turn further than this in one collapse (cosine).
inline constexpr double flip_cosine = 0.2;

}  // namespace lodestone::collapse
