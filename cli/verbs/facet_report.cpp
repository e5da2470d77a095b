// SPDX-License-Identifier: MIT
#include "facet_report.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone::cli {
namespace {

constexpr std::size_t most_listed = 24;  // families and roofs: the rest is ornament

constexpr std::array<const char*, 6> class_names{"wall", "roof", "ground", "opening", "installation", "other"};
constexpr std::array<const char*, 3> wall_names{"flat", "uneven on one side", "uneven on both sides"};
constexpr std::array<const char*, 3> roof_names{"flat", "spire", "sloped"};

template <class Enum>
const char* name_of(const auto& names, Enum value) {
  return names[static_cast<std::size_t>(value)];
}

double to_mm(double length_m) { return std::round(1000.0 * length_m) / 1000.0 + 0.0; }

void add_family(const FacetGraph& graph, const FacetFamily& family, Report& facets) {
  Report entry;
  entry.set("class", name_of(class_names, family.kind));
  if (family.kind == SurfaceClass::Wall) entry.set("type", name_of(wall_names, family.wall));
  const CharacteristicSurface& datum = graph.surfaces.surfaces[family.datum];
  entry.set("normal", datum.normal);
  entry.set("datum_area_m2", datum.area_m2);
  entry.set("surfaces", static_cast<std::uint32_t>(family.surfaces.size()));
  std::vector<double> distances;  // each once, to the millimetre
  for (const double d : family.distance_m) {
    if (distances.empty() || to_mm(d) != distances.back()) distances.push_back(to_mm(d));
  }
  entry.set("distances_m", distances);
  facets.add("families", entry);
}

std::uint32_t bulge_count(const FacetGraph& graph) {
  return static_cast<std::uint32_t>(
      std::count_if(graph.steps.begin(), graph.steps.end(), [](const FacetStep& s) { return s.height_m > 0.0; }));
}

using ClassCounts = std::array<std::uint32_t, class_names.size()>;
using ClassAreas = std::array<double, class_names.size()>;
using WallCounts = std::array<std::uint32_t, wall_names.size()>;

std::string lines_for_people(const FacetGraph& graph, const ClassCounts& counts, const ClassAreas& areas_m2,
                             const WallCounts& walls) {
  std::string lines;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    lines += std::string{class_names[i]} + ": " + std::to_string(counts[i]) + " planes, " +
             std::to_string(std::lround(areas_m2[i])) + " m2\n";
  }
  for (std::size_t i = 0; i < walls.size(); ++i) {
    if (walls[i] != 0) lines += "walls " + std::string{wall_names[i]} + ": " + std::to_string(walls[i]) + "\n";
  }
  if (!graph.roofs.empty()) lines += "main roof: " + std::string{name_of(roof_names, graph.roofs[0].type)} + "\n";
  const std::uint32_t bulges = bulge_count(graph);
  lines += "bulges: " + std::to_string(bulges) + ", depressions: " + std::to_string(graph.steps.size() - bulges) + "\n";
  return lines;
}

}  // namespace

void PlaneTolerance::declare(Arguments& arguments) {
  arguments.number("--plane-angle", angle_deg_, 0.01, 30.0, "Faces of one plane turn no further than this, in degrees");
  arguments.length_m("--plane-offset", offset_m_, "Points of one plane lie no farther from it, 2mm if not given");
}

SurfaceTolerance PlaneTolerance::value() const {
  SurfaceTolerance tolerance;
  tolerance.angle_rad = glm::radians(angle_deg_);
  if (offset_m_) tolerance.offset_m = *offset_m_;
  return tolerance;
}

void report_facets(const FacetGraph& graph, Report& report) {
  Report facets;
  ClassCounts counts{};
  ClassAreas areas_m2{};
  for (const CharacteristicSurface& s : graph.surfaces.surfaces) {
    ++counts[static_cast<std::size_t>(s.kind)];
    areas_m2[static_cast<std::size_t>(s.kind)] += s.area_m2;
  }
  facets.set("surfaces", static_cast<std::uint32_t>(graph.surfaces.surfaces.size()));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    Report entry;
    entry.set("surfaces", counts[i]);
    entry.set("area_m2", areas_m2[i]);
    facets.set(class_names[i], entry);
  }
  WallCounts walls{};
  for (const FacetFamily& family : graph.families) {
    if (family.kind == SurfaceClass::Wall) ++walls[static_cast<std::size_t>(family.wall)];
  }
  Report wall_types;
  for (std::size_t i = 0; i < walls.size(); ++i) wall_types.set(wall_names[i], walls[i]);
  facets.set("wall_types", wall_types);
  for (std::size_t i = 0; i < std::min(graph.families.size(), most_listed); ++i) {
    add_family(graph, graph.families[i], facets);
  }
  const std::uint32_t bulges = bulge_count(graph);
  facets.set("bulges", bulges);
  facets.set("depressions", static_cast<std::uint32_t>(graph.steps.size()) - bulges);
  for (std::size_t i = 0; i < std::min(graph.roofs.size(), most_listed); ++i) {
    const RoofPart& roof = graph.roofs[i];
    Report entry;
    entry.set("type", name_of(roof_names, roof.type));
    entry.set("pitch_deg", glm::degrees(roof.pitch_rad));
    entry.set("area_m2", roof.area_m2);
    entry.set("surfaces", static_cast<std::uint32_t>(roof.surfaces.size()));
    facets.add("roofs", entry);
  }
  report.set("facets", facets);
  report.show(lines_for_people(graph, counts, areas_m2, walls));
}

void report_shifts(const FacetShiftReport& done, Report& report) {
  Report shifts;
  shifts.set("surfaces", done.surfaces);
  shifts.set("walls", done.walls);
  shifts.set("roofs", done.roofs);
  shifts.set("openings", done.openings);
  shifts.set("closed_t_junctions", done.closed_t_junctions);
  shifts.set("interior_faces", done.interior_faces);
  shifts.set("shifts", done.shifts);
  shifts.set("openings_recessed", done.openings_recessed);
  shifts.set("openings_flattened", done.openings_flattened);
  shifts.set("openings_filled", done.openings_filled);
  shifts.set("parts_vanished", done.parts_vanished);
  shifts.set("scraps_vanished", done.scraps_vanished);
  shifts.set("hidden_vanished", done.hidden_vanished);
  shifts.set("parts_sunk", done.parts_sunk);
  shifts.set("points_merged", done.points_merged);
  shifts.set("tilting_collapses", done.tilting_collapses);
  shifts.set("reached_block", done.reached_block);
  if (!done.reached_block) shifts.set("held_because", done.block_sentence);
  report.set("facet_shift", shifts);
}

}  // namespace lodestone::cli
