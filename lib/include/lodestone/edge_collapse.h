// SPDX-License-Identifier: MIT
/// \file
/// A progressive model of any mesh by edge collapse. Sources: Garland and Heckbert 1997 and 1998 (quadrics,
/// attributes), Hoppe 1999 (wedge attributes, memoryless), Lindstrom and Turk 1998 (boundary cost). Works on dirty
/// input: seams, several materials, non-manifold edges, duplicate and degenerate faces, many small parts.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/progressive_model.h>

namespace lodestone {

/// Where the vertex that two collapse into is put.
enum class Placement : std::uint8_t {
  Optimal,  ///< minimum of the quadric, fallback on-edge, then end points; best shape
  OnEdge,   ///< minimum along the edge
  Midpoint,
  EndPoint,  ///< the better end
  Subset,    ///< the end that stays, never moved: smallest records, fastest playback, vertices shared by all levels
};

enum class Attributes : std::uint8_t {
  All,   ///< uv, normals and colours count in the cost and are carried along
  None,  ///< geometry only: attributes travel with their vertices but do not steer
};

enum class Borders : std::uint8_t {
  Simplify,  ///< true borders collapse along themselves, held by border quadrics
  Lock,      ///< border vertices never move
};

/// A plane that faces are to keep: dot(normal, p) == offset_m, relative to the mesh's origin.
struct HeldPlane {
  glm::dvec3 normal{0.0};  ///< unit
  double offset_m = 0.0;
  bool firm = true;  ///< else faces may leave it at the price of EdgeCollapseOptions::plane_arm_m
};

struct EdgeCollapseOptions {
  Placement placement = Placement::Optimal;
  Attributes attributes = Attributes::All;
  Borders borders = Borders::Simplify;
  /// Stop at so many triangles; 0 goes on until nothing can collapse (or max_error_m is reached).
  std::uint32_t target_triangles = 0;
  /// Stop before the error exceeds this; metres.
  double max_error_m = std::numeric_limits<double>::infinity();
  /// Weight of one unit of uv and colour against the mesh's diagonal, and of one unit of normal against the length of
  /// the edge that collapses; 0 switches one off. Larger keeps looks longer at the price of shape. uv and normal cost
  /// a generated outcrop 5 to 10 % of distance at these values (docs/edge_collapse.md); colour was not measured.
  double uv_weight = 1.0;
  double normal_weight = 0.25;
  double color_weight = 0.1;
  /// Faces count in the cost by the sharpness of the vertex they lie around (how far the normals there differ:
  /// equations 4 to 7 of Ao et al. 2025) to this power: 1 keeps ridges and hollows of rock longer than plains, 0 = off.
  double sharpness_power = 0.0;
  /// Edges with a larger dihedral angle are kept as features: leaving their line costs, and vertices on them go along
  /// them only. Angles are those of the mesh as it stands, so a crease that coarse faces no longer show is none.
  /// Radians, pi = off.
  double sharp_edge_rad = 3.141592653589793;
  /// Detached parts whose size falls below the error reached may vanish, as records of their own.
  bool prune_parts = true;
  /// Per material the group it belongs to; the last face of a group never goes, so the target may not be reached.
  /// Faces without area do not count. Empty = all may go.
  std::vector<std::uint32_t> material_groups;
  /// One per vertex (any nonzero = never moved, never removed); empty = none.
  std::vector<std::uint8_t> frozen;
  /// Planes that faces lie in and keep as long as they live: a vertex around which the faces of one plane lie moves in
  /// that plane only, of two along the line where they meet, and one of three or more stays, or is met by neighbours
  /// that lie on the same planes. Two corners of different planes may meet where these do, so that a bevel between
  /// them becomes an edge. Where planes are nearly parallel the ones listed first count.
  std::vector<HeldPlane> planes;
  /// Per face its plane, `none` = free: only the planes of its neighbours hold it. Empty = all are free.
  std::vector<std::uint32_t> face_planes;
  /// A vertex may be put so far from a plane; at least 1e-6 of the diagonal, for positions are floats. One that does
  /// not move may lie farther, where the source does: surveyed walls are flat to 1 or 2 mm. Metres.
  double plane_tolerance_m = 0.0;
  /// A face that turns away from the normal of its plane costs as if it lay so far off, times the sine of the turn:
  /// steers faces of planes that are not firm, and places that firm planes leave open. max_error_m limits
  /// it too, but no error tells of it. 0 switches it off; metres.
  double plane_arm_m = 0.0;
};

/// Why building stopped short of the target: share of the remaining candidate edges held by each cause, 0..1.
struct CollapseReport {
  bool target_reached = true;
  double locked_by_border = 0.0;
  double locked_by_flip = 0.0;
  double locked_by_link = 0.0;
  double locked_by_frozen = 0.0;  ///< or the last face of its group would go
  double locked_by_planes = 0.0;
  std::string sentence;  ///< empty if the target was reached
};

struct EdgeCollapseResult {
  std::shared_ptr<const ProgressiveModel> model;
  CollapseReport report;
};

/// Builds the stack from the source (finest level, bit for bit) down to the target. The same bytes come out for any
/// number of workers. Three times the error of a level bounds the 99.9th percentile of its sampled two-sided distance
/// from the source. Time about 1.2 us per source triangle, memory about 400 bytes per source vertex while building.
/// Errors: BadData from validate(mesh), BadArgument, Cancelled.
[[nodiscard]] Result<EdgeCollapseResult> build_by_edge_collapse(const Mesh& mesh,
                                                                const EdgeCollapseOptions& options = {},
                                                                const Context& context = {});

/// The same engine without records: the simplified mesh only. A mesh that is moved in is changed in place, which saves
/// the memory of a copy.
struct SimplifyResult {
  Mesh mesh;
  double error_m = 0.0;
  CollapseReport report;
};
[[nodiscard]] Result<SimplifyResult> simplify(Mesh mesh, const EdgeCollapseOptions& options,
                                              const Context& context = {});

}  // namespace lodestone
