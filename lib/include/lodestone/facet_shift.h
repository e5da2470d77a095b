// SPDX-License-Identifier: MIT
/// \file
/// A progressive model of a building by facet shift: whole planes move along their normals onto the next plane of their
/// family, so that walls stay vertical and roofs keep their pitch while window frames, balconies, reveals, dormers and
/// chimneys go. Source: Li, Li, Lin and Yi 2019, "Method for 3D City Building Continuous Transformation Based on an
/// Improved LOD Topological Data Structure"; extended to surveyed LoD3 models, which are soups of open, touching and
/// overlapping parts.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/progressive_model.h>

namespace lodestone {

/// What a characteristic surface is: from the semantic class of its feature where the source tells, else by direction.
enum class SurfaceClass : std::uint8_t { Wall, Roof, Ground, Opening, Installation, Other };

/// Connected faces of one plane, the unit that shifts.
struct CharacteristicSurface {
  glm::dvec3 normal{0.0};  ///< unit
  double offset_m = 0.0;   ///< dot(normal, p) of its points, relative to the mesh's origin
  double area_m2 = 0.0;    ///< its importance
  std::uint32_t face_count = 0;
  SurfaceClass kind = SurfaceClass::Other;
};

struct CharacteristicSurfaces {
  std::vector<CharacteristicSurface> surfaces;  ///< in the order of their largest face, larger first
  std::vector<std::uint32_t> surface_of_face;   ///< `none` for faces without an area
};

struct SurfaceTolerance {
  double angle_rad = 0.0175;  ///< faces of one surface turn no further from its largest face; 1 degree
  double offset_m = 0.002;    ///< and lie no farther from its plane; surveyed models are planar to 1 or 2 mm
};

/// Cuts a mesh into its planes. O(faces log faces). Precondition: validate(mesh).
[[nodiscard]] CharacteristicSurfaces characteristic_surfaces(const Mesh& mesh, const SurfaceTolerance& tolerance = {});

/// What the surfaces of one direction do in a wall: nothing stands out, all of it before or all of it behind the datum
/// plane, or some of it on either side. Figure 1 of the paper.
enum class WallType : std::uint8_t { Flat, UnevenOneSide, UnevenBothSides };

/// Figure 2 of the paper: level; three or more steep planes that meet in one point on top; all others.
enum class RoofType : std::uint8_t { Flat, Spire, Sloped };

/// Parallel surfaces that face the same way, none farther from the next than FacetGraphOptions::family_gap_m: a wall
/// with all that stands out of it or is let into it.
struct FacetFamily {
  SurfaceClass kind = SurfaceClass::Other;  ///< of the datum plane
  WallType wall = WallType::Flat;           ///< meaningful where `kind` is Wall
  std::uint32_t datum = none;               ///< the surface of the largest area
  std::vector<std::uint32_t> surfaces;      ///< innermost first
  std::vector<double> distance_m;           ///< of each from the datum plane, positive outwards
};

/// Two surfaces of one family that are joined by side faces: what a shift closes.
struct FacetStep {
  std::uint32_t lesser = none;       ///< gives way
  std::uint32_t greater = none;      ///< the one of more area
  double height_m = 0.0;             ///< of the lesser over the greater: a bulge if positive, else a depression
  std::vector<std::uint32_t> sides;  ///< surfaces that stand between the two planes and touch both, ascending
};

/// Roof surfaces that hang together by edges.
struct RoofPart {
  RoofType type = RoofType::Sloped;
  double pitch_rad = 0.0;  ///< mean by area, 0 is level
  double area_m2 = 0.0;
  std::vector<std::uint32_t> surfaces;  ///< ascending
};

struct FacetGraphOptions {
  SurfaceTolerance tolerance;
  double least_area_ratio = 1e-4;  ///< of the whole area: smaller surfaces are sides at most
  double family_gap_m = 2.0;       ///< parallel surfaces farther apart belong to different walls
};

/// How the surfaces of a building stand to each other.
struct FacetGraph {
  CharacteristicSurfaces surfaces;
  std::vector<FacetFamily> families;  ///< by the area of their datum, larger first
  std::vector<FacetStep> steps;       ///< by (lesser, greater)
  std::vector<RoofPart> roofs;        ///< by area, larger first
};

/// Finds families, steps and roofs. O(faces log faces + surfaces * directions). Precondition: validate(mesh).
[[nodiscard]] FacetGraph facet_graph(const Mesh& mesh, const FacetGraphOptions& options = {});

/// Share of the area that lies in surfaces of at least `least_ratio` of the whole area, 0..1: near 1 for buildings,
/// near 0 for scans and sculpture. What `build --method auto` goes by. O(faces log faces).
[[nodiscard]] double planar_area_share(const Mesh& mesh, double least_ratio = 1e-4);

/// Whether what cannot be seen from outside goes before anything else.
enum class Interior : std::uint8_t {
  Keep,
  DropFirst,  ///< by sampled visibility, plane by plane; the error counts what can be seen, so these records cost 0
};

/// How a facade coarsens.
enum class ShiftOrder : std::uint8_t {
  OneByOne,  ///< a record a window, a shift: the finest steps
  Together,  ///< what can be done to the windows of one wall, or to planes of one direction, at one price is one record
};

struct FacetShiftOptions {
  SurfaceTolerance tolerance;
  /// Corner points nearer to each other than this count as one, and move as one: so do the twins on both sides of an
  /// edge of three or more faces. The finest level keeps them as they are; every record costs at least this much. 0
  /// takes equal positions only, and is right for most; metres.
  double weld_tolerance_m = 0.0;
  /// T-junctions are closed first: a triangle whose open side passes by a point of its neighbour within this distance
  /// is cut there. Surveyed models do not share the points of such sides, and walls in pieces coarsen badly. 0 leaves
  /// the source as it is; metres.
  double t_junction_tolerance_m = 0.001;
  Interior interior = Interior::Keep;
  ShiftOrder order = ShiftOrder::OneByOne;
  /// Per texture its mean colour (sRGB, 0..1), by which builders tell how different two materials look; see
  /// mean_texture_colors() of texture_colors.h. Empty: those with pixels are looked at, others count as grey.
  std::vector<glm::vec3> texture_colors{};
  /// Stop at so many triangles; 0 goes on until nothing is left to do.
  std::uint32_t target_triangles = 0;
  /// Stop before the error exceeds this; metres.
  double max_error_m = std::numeric_limits<double>::infinity();
};

/// What was done, in records, and what was left.
struct FacetShiftReport {
  std::uint32_t surfaces = 0, walls = 0, roofs = 0, openings = 0;
  std::uint32_t closed_t_junctions = 0;  ///< points put into sides of neighbours
  std::uint32_t interior_faces = 0;      ///< dropped first because they cannot be seen
  std::uint32_t shifts = 0;              ///< planes that moved
  std::uint32_t openings_recessed = 0;   ///< holes of a wall whose bars and frames gave way to a pane behind the wall
  std::uint32_t openings_flattened = 0;  ///< holes of a wall whose window came forward into the wall's plane
  std::uint32_t openings_filled = 0;     ///< flush windows and holes that the wall closed over
  std::uint32_t parts_vanished = 0;      ///< detached parts that went: frames, bars, railings, pipes, antennas
  std::uint32_t parts_sunk = 0;          ///< of these, flat into a plane that they hung on; the others shrank
  std::uint32_t hidden_vanished = 0;     ///< faces that no picture of the building shows
  std::uint32_t scraps_vanished = 0;     ///< ends of mullions and the like, which hung on the rest by points or edges
  std::uint32_t points_merged = 0;       ///< corner points that slid within their planes onto a neighbour
  std::uint32_t tilting_collapses = 0;   ///< the same where some face had to leave its direction
  std::uint32_t last_collapses = 0;      ///< by the engine of edge collapse with planes held, from 3 % of the faces on
  std::string sentence;                  ///< what holds the model above the target, empty if it was reached
  bool reached_block = false;            ///< the base is a closed prism: upright walls, level roof and ground
  std::string block_sentence;            ///< what holds the model from it, empty if it was reached
};

struct FacetShiftResult {
  std::shared_ptr<const ProgressiveModel> model;
  FacetShiftReport report;
};

/// Builds the stack from the source (finest level, bit for bit but for the cuts at T-junctions, see
/// compare_with_source()) down to the target, at last to a closed prism: its sides stand in the main walls, half of the
/// ground it covers is covered up to its roof or higher. Levels are named: "lod3" and "lod2" are the coarsest within
/// 0.5 and 2 m of the source (the positional accuracy that CityGML 2.0 asks of these), "lod1" and "block" are the
/// prism; where it was not reached there is no "block", and "lod1" is the coarsest within 5 m. One thread; the same
/// bytes always. Time about 15 to 40 us per source triangle; memory about 800 bytes per source triangle. Errors:
/// BadData from validate(mesh), Cancelled.
[[nodiscard]] Result<FacetShiftResult> build_by_facet_shift(const Mesh& mesh, const FacetShiftOptions& options = {},
                                                            const Context& context = {});

}  // namespace lodestone
