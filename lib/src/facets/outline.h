// SPDX-License-Identifier: MIT
// Outlines of faces that lie in one plane.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // between points, the faces to the left

[[nodiscard]] bool lies_in(const FacetMesh& mesh, const Face& face, const glm::dvec3& normal, double offset_m);

// The edges of the faces that have none of them on the other side, ascending.
[[nodiscard]] std::vector<Edge> outline(const FacetMesh& mesh, const std::vector<FaceId>& faces);

// Closed chains of the edges; where several pass one point they are kept apart. Edges of open chains are left out.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> chain(const FacetMesh& mesh, std::vector<Edge> edges,
                                                            const glm::dvec3& normal);

// Positive where the loop runs counter-clockwise as seen against the normal.
[[nodiscard]] double signed_area(const FacetMesh& mesh, const std::vector<std::uint32_t>& loop,
                                 const glm::dvec3& normal);

}  // namespace lodestone::facets
