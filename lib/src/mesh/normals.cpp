// SPDX-License-Identifier: MIT
// Based on: Max 1999, "Weights for computing vertex normals from facet normals" (angle weights); Baerentzen and Aanaes
// 2005 on why angles make the result independent of the triangulation.
// Differs: weights are angle times area; faces join into one normal only across edges below the crease angle.
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <lodestone/mesh.h>

#include "base/disjoint_sets.h"
#include "base/hash.h"
#include "mesh/edges.h"
#include "mesh/vertex_copy.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

double corner_angle_rad(const Mesh& mesh, CornerId c) {
  const auto& p = mesh.vertices.positions;
  const CornerId n = next_corner(c);
  const glm::dvec3 at{p[mesh.indices[c]]};
  const glm::dvec3 a = glm::dvec3{p[mesh.indices[n]]} - at;
  const glm::dvec3 b = glm::dvec3{p[mesh.indices[next_corner(n)]]} - at;
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Corners that share one normal: those at one point whose faces are joined by edges below the crease angle.
DisjointSets smooth_corners(const Mesh& mesh, const Weld& weld, const std::vector<glm::dvec3>& area_vectors,
                            double crease_rad) {
  DisjointSets corners{static_cast<std::uint32_t>(mesh.indices.size())};
  const EdgeTable edges = find_edges(mesh, weld);
  const auto smooth = [&](FaceId f, FaceId g) {
    const glm::dvec3& a = area_vectors[f];
    const glm::dvec3& b = area_vectors[g];
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) < crease_rad;
  };
  // On an edge of many faces each is compared with a few before it only, so that no input is quadratic.
  constexpr std::size_t most_before = 8;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses_of(e);
    for (std::size_t i = 1; i < uses.size(); ++i) {
      for (std::size_t j = i > most_before ? i - most_before : 0; j < i; ++j) {
        if (!smooth(uses[i].corner / 3, uses[j].corner / 3)) continue;
        corners.join(uses[i].corner_at_low(), uses[j].corner_at_low());
        corners.join(uses[i].corner_at_high(), uses[j].corner_at_high());
      }
    }
  }
  return corners;
}

// Unit vector along `v`, or along `otherwise` where v has no direction, or up.
glm::vec3 direction(const glm::dvec3& v, const glm::dvec3& otherwise) {
  for (const glm::dvec3& n : {v, otherwise}) {
    const double length = glm::length(n);
    if (length > 0.0) return glm::vec3{n / length};
  }
  return {0.0F, 0.0F, 1.0F};
}

}  // namespace

void compute_normals(Mesh& mesh, double crease_rad) {
  mesh.vertices.normals.clear();
  const Weld weld = weld_by_position(mesh.vertices.positions);
  std::vector<glm::dvec3> area_vectors(mesh.triangle_count());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) area_vectors[f] = area_vector(mesh, f);
  DisjointSets group = smooth_corners(mesh, weld, area_vectors, crease_rad);

  const auto corners = static_cast<CornerId>(mesh.indices.size());
  std::vector<glm::dvec3> sums(corners, glm::dvec3{0.0});
  std::vector<glm::dvec3> point_sums(weld.point_count(), glm::dvec3{0.0});  // where a group has no direction
  for (CornerId c = 0; c < corners; ++c) {
    const glm::dvec3 term = area_vectors[c / 3] * corner_angle_rad(mesh, c);
    sums[group.find(c)] += term;
    point_sums[weld.point_of[mesh.indices[c]]] += term;
  }

  // One vertex per pair of old vertex and group: the first pair keeps the old one, the others get a copy.
  const UniqueIds pairs = unique_ids(
      corners, [&](CornerId c) { return hash_combine(mesh.indices[c], group.find(c)); },
      [&](CornerId c, CornerId d) { return mesh.indices[c] == mesh.indices[d] && group.find(c) == group.find(d); });
  std::vector<VertexId> vertex_of(pairs.first.size());
  std::vector<glm::vec3> normals(mesh.vertex_count(), glm::vec3{0.0F, 0.0F, 1.0F});
  std::vector<std::uint8_t> taken(mesh.vertex_count(), 0);
  for (std::size_t k = 0; k < vertex_of.size(); ++k) {
    const CornerId c = pairs.first[k];
    const VertexId v = mesh.indices[c];
    const glm::vec3 normal = direction(sums[group.find(c)], point_sums[weld.point_of[v]]);
    if (taken[v] == 0) {
      taken[v] = 1;
      vertex_of[k] = v;
      normals[v] = normal;
      continue;
    }
    vertex_of[k] = append_vertex_copy(mesh.vertices, v);
    normals.push_back(normal);
  }
  for (CornerId c = 0; c < corners; ++c) mesh.indices[c] = vertex_of[pairs.id_of[c]];
  mesh.vertices.normals = std::move(normals);
}

}  // namespace lodestone
