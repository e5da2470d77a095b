// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019, section 3.1 (pretreatment of characteristic surfaces).
// Differs: equation 4 is garbled in print, the angle between normals is meant; growth compares with the largest face of
// the surface instead of face with face, so that a fine cylinder does not become one surface.
#include <lodestone/facet_shift.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include "mesh/edges.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

constexpr double vertical_sine = 0.0872;  // walls lean up to 5 degrees

SurfaceClass kind_by_direction(const glm::dvec3& normal) {
  if (std::abs(normal.z) < vertical_sine) return SurfaceClass::Wall;
  return normal.z > 0.0 ? SurfaceClass::Roof : SurfaceClass::Ground;
}

SurfaceClass kind_by_name(std::string_view name) {
  if (name == "WallSurface" || name == "InteriorWallSurface") return SurfaceClass::Wall;
  if (name == "RoofSurface" || name == "OuterCeilingSurface") return SurfaceClass::Roof;
  if (name == "GroundSurface" || name == "OuterFloorSurface" || name == "FloorSurface") return SurfaceClass::Ground;
  if (name == "Window" || name == "Door") return SurfaceClass::Opening;
  if (name == "BuildingInstallation") return SurfaceClass::Installation;
  return SurfaceClass::Other;
}

// Of the words of IFC only those whose every face is of one class: slabs and roofs have all directions.
SurfaceClass kind_by_ifc_name(std::string_view name) {
  if (name.starts_with("IfcWindow") || name.starts_with("IfcDoor")) return SurfaceClass::Opening;
  for (const char* installation : {"IfcRailing", "IfcStair", "IfcBeam", "IfcColumn", "IfcMember", "IfcFurnishing"}) {
    if (name.starts_with(installation)) return SurfaceClass::Installation;
  }
  return SurfaceClass::Other;
}

// The innermost feature around the face that has a class we know; else the direction.
SurfaceClass kind_of(const Mesh& mesh, FaceId f, const glm::dvec3& normal) {
  std::uint32_t steps = 0;
  for (FeatureId i = mesh.face_feature(f); i != none && steps < 16; i = mesh.features[i].parent, ++steps) {
    const std::string_view name = mesh.features[i].semantic_class;
    const SurfaceClass kind = name.starts_with("Ifc") ? kind_by_ifc_name(name) : kind_by_name(name);
    if (kind != SurfaceClass::Other) return kind;
  }
  return kind_by_direction(normal);
}

struct Grower {
  const Mesh& mesh;
  const SurfaceTolerance& tolerance;
  std::vector<glm::dvec3> normals;  // unit, or zero
  std::vector<double> areas;
  std::vector<std::uint32_t> edge_of_corner;
  EdgeTable edges;
  CharacteristicSurfaces found;

  Grower(const Mesh& m, const SurfaceTolerance& t) : mesh(m), tolerance(t) {
    const Weld weld = weld_by_position(mesh.vertices.positions);
    edges = find_edges(mesh, weld);
    edge_of_corner.assign(mesh.indices.size(), none);
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      for (const EdgeUse& use : edges.uses_of(e)) edge_of_corner[use.corner] = e;
    }
    normals.resize(mesh.triangle_count(), glm::dvec3{0.0});
    areas.resize(mesh.triangle_count(), 0.0);
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
      const glm::dvec3 n = area_vector(mesh, f);
      const double length = glm::length(n);
      if (!(length > 0.0) || !std::isfinite(length)) continue;
      normals[f] = n / length;
      areas[f] = 0.5 * length;
    }
    found.surface_of_face.assign(mesh.triangle_count(), none);
  }

  [[nodiscard]] bool belongs(FaceId f, const CharacteristicSurface& s, double least_cosine) const {
    if (found.surface_of_face[f] != none || glm::dot(normals[f], s.normal) < least_cosine) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 p{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
      if (std::abs(glm::dot(s.normal, p) - s.offset_m) > tolerance.offset_m) return false;
    }
    return true;
  }

  void grow(FaceId seed) {
    const auto id = static_cast<std::uint32_t>(found.surfaces.size());
    CharacteristicSurface s;
    s.normal = normals[seed];
    s.offset_m = glm::dot(s.normal, glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{seed}]]});
    s.kind = kind_of(mesh, seed, s.normal);
    const double least_cosine = std::cos(tolerance.angle_rad);
    std::vector<FaceId> front{seed};
    found.surface_of_face[seed] = id;
    while (!front.empty()) {
      const FaceId f = front.back();
      front.pop_back();
      s.area_m2 += areas[f];
      ++s.face_count;
      for (CornerId c = 3 * f; c != 3 * f + 3; ++c) {
        if (edge_of_corner[c] == none) continue;
        for (const EdgeUse& use : edges.uses_of(edge_of_corner[c])) {
          const FaceId other = use.corner / 3;
          if (!belongs(other, s, least_cosine)) continue;
          found.surface_of_face[other] = id;
          front.push_back(other);
        }
      }
    }
    found.surfaces.push_back(s);
  }
};

}  // namespace

CharacteristicSurfaces characteristic_surfaces(const Mesh& mesh, const SurfaceTolerance& tolerance) {
  Grower grower{mesh, tolerance};
  std::vector<FaceId> order(mesh.triangle_count());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](FaceId a, FaceId b) { return grower.areas[a] > grower.areas[b]; });
  for (const FaceId f : order) {
    if (grower.found.surface_of_face[f] == none && grower.areas[f] > 0.0) grower.grow(f);
  }
  return std::move(grower.found);
}

double planar_area_share(const Mesh& mesh, double least_ratio) {
  double whole = 0.0;
  double planar = 0.0;
  const CharacteristicSurfaces found = characteristic_surfaces(mesh);
  for (const CharacteristicSurface& s : found.surfaces) whole += s.area_m2;
  for (const CharacteristicSurface& s : found.surfaces) {
    if (s.area_m2 >= least_ratio * whole) planar += s.area_m2;
  }
  return whole > 0.0 ? planar / whole : 0.0;
}

}  // namespace lodestone
