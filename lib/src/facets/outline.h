// SPDX-License-Identifier: MIT
// Outlines of faces that lie in one plane.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // between points, the faces to the left

// So flat that it has no direction: drawn to tie a side to the points it passes by.
[[nodiscard]] bool is_sliver(const FacetMesh& mesh, const Face& face);

[[nodiscard]] bool is_parallel(const Face& face, const glm::dvec3& normal);
// All of its points.
[[nodiscard]] bool is_near(const FacetMesh& mesh, const Face& face, const glm::dvec3& normal, double offset_m);
// Both; but slivers lie in any plane of their points.
[[nodiscard]] bool lies_in(const FacetMesh& mesh, const Face& face, const glm::dvec3& normal, double offset_m);

// The edges of the faces that have none of them on the other side, ascending.
[[nodiscard]] std::vector<Edge> outline(const FacetMesh& mesh, const std::vector<FaceId>& faces);

// Whether every edge of a live face has one on the other side.
[[nodiscard]] bool is_closed(const FacetMesh& mesh);

// Closed chains of the edges; where several pass one point they are kept apart. Edges of open chains are left out.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> chain(const FacetMesh& mesh, std::vector<Edge> edges,
                                                            const glm::dvec3& normal);

// Positive where the loop runs counter-clockwise as seen against the normal.
[[nodiscard]] double signed_area(const FacetMesh& mesh, const std::vector<std::uint32_t>& loop,
                                 const glm::dvec3& normal);

// A point as a corner of what is drawn, where it is or is to be.
struct Corner {
  std::uint32_t point = none;
  glm::dvec3 at{0.0};
};

// Triangles between the corners, the first ring around the others. Empty if they do not cover just so much, all turning
// with the normal.
[[nodiscard]] std::optional<std::vector<std::array<std::uint32_t, 3>>> triangulate(
    const std::vector<std::vector<Corner>>& rings, const glm::dvec3& normal, double area_m2);

}  // namespace lodestone::facets
