// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <lodestone/metrics.h>

#include "base/parallel.h"
#include "geometry/bvh.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

constexpr double most_radius_m = 0.1;
constexpr double most_radius_ratio = 0.01;  // of the diagonal
constexpr std::size_t chunk = 512;

// Only faces with an area: the others have no normal.
struct PlanarFaces {
  std::vector<VertexId> indices;
  std::vector<glm::dvec3> normals;
  std::vector<double> areas;

  explicit PlanarFaces(const Mesh& mesh) {
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
      const glm::dvec3 n = area_vector(mesh, f);
      const double length = glm::length(n);
      if (!(length > 0.0)) continue;
      for (std::size_t c = 0; c < 3; ++c) indices.push_back(mesh.indices[3 * std::size_t{f} + c]);
      normals.push_back(n / length);
      areas.push_back(0.5 * length);
    }
  }
};

double angle_between_planes_rad(const glm::dvec3& n, const glm::dvec3& m) {
  return std::atan2(glm::length(glm::cross(n, m)), std::abs(glm::dot(n, m)));
}

// The normal nearest in direction to n among the faces of `surface` around p.
glm::dvec3 most_parallel(const TriangleBvh& surface, const std::vector<glm::dvec3>& normals, const glm::dvec3& p,
                         double radius, const glm::dvec3& n) {
  constexpr double parallel = 1.0 - 1e-15;  // as parallel as double can tell
  double best = -1.0;
  FaceId best_face = none;
  // The angle is cheaper than the distance, and most faces around are no better than the best so far.
  const auto better = [&](FaceId f) { return std::abs(glm::dot(normals[f], n)) > best; };
  surface.within(p, radius, better, [&](FaceId f) {
    best = std::abs(glm::dot(normals[f], n));
    best_face = f;
    return best < parallel;
  });
  return normals[best_face != none ? best_face : surface.nearest(p).face];
}

}  // namespace

double normal_deviation_rad(const Mesh& a, const Mesh& b, const Context& context) {
  const PlanarFaces source{a};
  const PlanarFaces faces{b};
  if (faces.normals.empty()) return 0.0;
  if (source.normals.empty()) return 0.5 * std::numbers::pi;
  const TriangleBvh surface{a.vertices.positions, source.indices};
  const double radius = std::min(most_radius_m, most_radius_ratio * bounds(a).diagonal_m());
  const glm::dvec3 offset = a.origin - b.origin;

  std::vector<double> angles_rad(faces.normals.size(), 0.0);
  parallel_for_each(angles_rad.size(), chunk, context, [&](std::size_t f) {
    glm::dvec3 center{0.0};
    for (std::size_t c = 0; c < 3; ++c) center += glm::dvec3{b.vertices.positions[faces.indices[3 * f + c]]} / 3.0;
    const glm::dvec3 n = faces.normals[f];
    angles_rad[f] = angle_between_planes_rad(n, most_parallel(surface, source.normals, center - offset, radius, n));
  });
  double sum = 0.0;
  double area = 0.0;
  for (std::size_t f = 0; f < angles_rad.size(); ++f) {
    sum += faces.areas[f] * angles_rad[f];
    area += faces.areas[f];
  }
  return sum / area;
}

}  // namespace lodestone
