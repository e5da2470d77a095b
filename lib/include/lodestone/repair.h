// SPDX-License-Identifier: MIT
/// \file
/// Making a dirty mesh cleaner: every step is optional, says what it did, and moves no vertex farther than it was told.
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone {

/// Which steps to take; they are taken in this order.
struct RepairOptions {
  /// Corner points nearer to each other than this become one; 0 = leave. Each moves to the first point there. Larger
  /// values close wider gaps, and fold up details of that size.
  double weld_tolerance_m = 0.0;

  /// Drop triangles with two equal corners or without any area.
  bool remove_degenerate = true;

  /// Drop triangles with the three positions of an earlier one that turn the same way; those that turn the other way
  /// too where the material is double-sided.
  bool remove_duplicates = true;

  /// Close T-junctions: where a point of an open edge lies within this distance of another open edge, the triangle on
  /// that edge is cut so that it uses the point, with interpolated normal, uv and colour; 0 = leave. Cracks up to this
  /// width disappear. 1 mm suits buildings in metres.
  double t_junction_tolerance_m = 0.0;

  /// Cap holes whose border is no longer than this, with the material, feature and uv of the triangles around and a
  /// normal of their own; 0 = leave. The outline of an open sheet is no hole. Caps are appended after the other
  /// triangles.
  double fill_holes_perimeter_m = 0.0;

  /// Turn triangles so that neighbours agree: closed parts outwards, open ones as the larger share of their area.
  bool orient = false;
};

/// What repair() did.
struct RepairReport {
  std::uint32_t welded_points = 0;         ///< points that moved onto another
  std::uint32_t degenerate_triangles = 0;  ///< removed
  std::uint32_t duplicate_triangles = 0;   ///< removed
  std::uint32_t closed_t_junctions = 0;    ///< points inserted into edges
  std::uint32_t filled_holes = 0;
  std::uint32_t flipped_triangles = 0;
};

/// Repairs in place. Triangles keep their order, pieces of a cut one stand in its place; vertices, materials and
/// features are kept even if no triangle uses them any more (see remove_unused()). Precondition: validate(mesh).
/// Deterministic. O(size log size).
RepairReport repair(Mesh& mesh, const RepairOptions& options = {});

/// Takes the texture from the marked faces: they get copies of their materials without it, appended. `faces` has one
/// element per triangle.
void leave_plain(Mesh& mesh, const std::vector<bool>& faces);

}  // namespace lodestone
