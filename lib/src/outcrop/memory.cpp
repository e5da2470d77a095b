// SPDX-License-Identifier: MIT
// What a pyramid takes while it is built, from the sizes of the arrays that live at the same time.
#include <algorithm>

#include <lodestone/outcrop.h>

#include "mesh/weld.h"
#include "outcrop/ratio.h"

namespace lodestone {
namespace {

// Bytes a triangle and a vertex; what depends on the attributes comes on top.
constexpr double mesh_triangle = 20.0;   // indices, material, leaf
constexpr double level_triangle = 21.0;  // indices, material, feature, which edges are borders
constexpr double collapse_triangle = 41.0;
constexpr double collapse_vertex = 143.0;    // quadrics, candidates, then logs
constexpr double bvh_triangle = 62.0;        // nodes, corners, numbers
constexpr double bvh_build_triangle = 80.0;  // the boxes that are sorted
constexpr double leaf_triangle = 4.0;
constexpr double weld_vertex = 8.0;
constexpr double distance_vertex = 12.0;
// Border points, pages that are half full, arrays that grow, as measured against all of the above.
constexpr double slack = 1.18;

// Of triangles from one level to the next, the most that may come.
double first_ratio(const OutcropOptions& options) noexcept {
  return options.ratio > 0.0 ? options.ratio : outcrop::followed_ratio(options).first;
}
double later_ratio(const OutcropOptions& options) noexcept {
  return options.ratio > 0.0 ? options.ratio : outcrop::followed_ratio(options).most;
}

constexpr int most_levels = 96;
constexpr double least_share = 1e-4;  // of the source: below, levels count for nothing

double level_bytes(const OutcropSize& size) noexcept {
  return level_triangle * static_cast<double>(size.triangles) +
         static_cast<double>(size.vertex_bytes) * static_cast<double>(size.vertices);
}

}  // namespace

OutcropSize outcrop_size(const Mesh& mesh) noexcept {
  const VertexArrays& v = mesh.vertices;
  const auto bytes = static_cast<std::uint32_t>(sizeof(glm::vec3) + (v.normals.empty() ? 0 : sizeof(glm::vec3)) +
                                                (v.uvs.empty() ? 0 : sizeof(glm::vec2)) +
                                                (v.colors.empty() ? 0 : sizeof(glm::u8vec4)));
  return {mesh.triangle_count(), mesh.vertex_count(), bytes};
}

std::uint32_t degenerate_triangle_count(const Mesh& mesh) noexcept {
  std::uint32_t count = 0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) count += area_vector(mesh, f) == glm::dvec3{0.0} ? 1U : 0U;
  return count;
}

std::uint64_t outcrop_levels_bytes(const OutcropSize& size, const OutcropOptions& options) noexcept {
  double shares = 0.0;
  double share = 1.0;
  for (int level = 0; level < most_levels && share > least_share; ++level) {
    shares += share;
    share *= level == 0 ? first_ratio(options) : later_ratio(options);
  }
  return static_cast<std::uint64_t>(slack * shares * level_bytes(size));
}

std::uint64_t outcrop_build_bytes(const OutcropSize& size, const OutcropOptions& options, unsigned workers) noexcept {
  const auto triangles = static_cast<double>(size.triangles);
  const auto vertices = static_cast<double>(size.vertices);
  const auto attributes = static_cast<double>(size.vertex_bytes);
  const double mesh = mesh_triangle * triangles + attributes * vertices;
  const double collapse = collapse_triangle * triangles + (collapse_vertex + attributes) * vertices;
  double most = 0.0;
  double levels = 0.0;
  double share = 1.0;  // of the source's triangles, in the level at hand
  for (int level = 0; level < most_levels && share > least_share; ++level) {
    const double next = share * (level == 0 ? first_ratio(options) : later_ratio(options));
    levels += share * level_bytes(size);
    const double kept =
        levels + leaf_triangle * triangles + (level == 0 ? 0.0 : bvh_triangle * triangles + weld_vertex * vertices);
    const double simplifying = share * (mesh + collapse);
    const double measuring = distance_vertex * vertices + bvh_build_triangle * share * triangles;
    // One after the other, either has the mesh of the level at hand or of the next one beside it.
    const bool waits_for_measure = options.ratio <= 0.0 && level > 0;
    const double after = measuring + (waits_for_measure ? share : next) * mesh;
    most = std::max(most, kept + (workers > 1 ? simplifying + measuring : std::max(simplifying, after)));
    share = next;
  }
  return static_cast<std::uint64_t>(slack * most);
}

}  // namespace lodestone
