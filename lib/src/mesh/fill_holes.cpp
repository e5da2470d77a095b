// SPDX-License-Identifier: MIT
// Closing holes with a cap over each border loop that the half-edge structure finds.
#include <lodestone/polygon.h>
#include <lodestone/topology.h>

#include "mesh/edges.h"
#include "mesh/repair.h"
#include "mesh/vertex_copy.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

glm::dvec3 position(const Mesh& mesh, CornerId c) { return glm::dvec3{mesh.vertices.positions[mesh.indices[c]]}; }

// Sides follow each other against the turn of their triangles, as those of a cap have to run.
bool is_closed(const Mesh& mesh, const std::vector<CornerId>& loop) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const CornerId following = loop[(i + 1) % loop.size()];
    if (position(mesh, loop[i]) != position(mesh, next_corner(following))) return false;
  }
  return true;
}

double perimeter(const Mesh& mesh, const std::vector<CornerId>& loop) {
  double sum = 0.0;
  for (const CornerId c : loop) sum += glm::distance(position(mesh, c), position(mesh, next_corner(c)));
  return sum;
}

// The outline of a sheet is a border too: a cap there would be its back, facing away from the triangles around it.
bool is_outline(const Mesh& mesh, const std::vector<CornerId>& loop, const glm::dvec3& cap_normal) {
  double sum = 0.0;
  for (const CornerId c : loop) {
    const glm::dvec3 n = area_vector(mesh, c / 3);
    const double length = glm::length(n);
    if (length > 0.0) sum += glm::dot(n / length, cap_normal);
  }
  return sum < -0.5 * static_cast<double>(loop.size());
}

bool fill(Mesh& mesh, const std::vector<CornerId>& loop) {
  std::vector<glm::dvec3> points;
  glm::dvec3 normal{0.0};
  for (const CornerId c : loop) {
    points.push_back(position(mesh, c));
    normal += glm::cross(position(mesh, next_corner(c)) - points.front(), points.back() - points.front());
  }
  const double length = glm::length(normal);
  if (!(length > 0.0) || is_outline(mesh, loop, normal / length)) return false;
  const auto count = static_cast<std::uint32_t>(points.size());
  const auto triangles = triangulate_polygon(points, std::span{&count, 1});
  if (triangles.size() + 2 != points.size()) return false;

  const VertexId first = mesh.vertex_count();
  for (const CornerId c : loop) {
    const VertexId v = append_vertex_copy(mesh.vertices, mesh.indices[c]);
    if (!mesh.vertices.normals.empty()) mesh.vertices.normals[v] = glm::vec3{normal / length};
  }
  const FaceId beside = loop.front() / 3;
  for (const auto& triangle : triangles) {
    for (const std::uint32_t i : triangle) mesh.indices.push_back(first + i);
    if (!mesh.face_materials.empty()) mesh.face_materials.push_back(MaterialId{mesh.face_materials[beside]});
    if (!mesh.face_features.empty()) mesh.face_features.push_back(FeatureId{mesh.face_features[beside]});
  }
  return true;
}

}  // namespace

std::uint32_t fill_holes(Mesh& mesh, double perimeter_m) {
  std::uint32_t filled = 0;
  for (const auto& loop : analyse_topology(mesh).boundary_loops) {
    if (loop.size() < 3 || perimeter(mesh, loop) > perimeter_m || !is_closed(mesh, loop)) continue;
    if (fill(mesh, loop)) ++filled;
  }
  return filled;
}

}  // namespace lodestone
