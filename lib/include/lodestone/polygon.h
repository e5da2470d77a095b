// SPDX-License-Identifier: MIT
/// \file
/// Cutting polygons into triangles: what readers of formats with n-gons and holes need.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/types.h>

namespace lodestone {

/// Triangulates a polygon with holes that lies more or less in a plane.
///
/// `points` holds all rings one after the other, the outer one first; ring i ends before `ring_ends[i]`, so the last
/// entry is `points.size()`. Rings may run either way round and may or may not repeat their first point at the end.
///
/// Returns triples of indices into `points`, turning the same way as the outer ring. Every corner of a proper polygon
/// is used, also those in the middle of a straight side, so that neighbours meet without T-junctions; no triangle is
/// degenerate. A single triangle is returned as it is. Input that is no polygon (crossing or touching sides, holes
/// that lie outside) is covered as well as its rings allow; nothing comes back if all points lie on one line or a
/// coordinate is not finite.
///
/// Always ends. O(n log n) typical for n points, O(n * holes) with many holes.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const glm::dvec3> points,
                                                                            std::span<const std::uint32_t> ring_ends);

}  // namespace lodestone
