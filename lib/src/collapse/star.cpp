// SPDX-License-Identifier: MIT
#include "collapse/star.h"

namespace lodestone::collapse {
namespace {

// Most of the time here is waiting for faces, so all are asked for before the first is looked at. Inlined because a
// compiler may take a call that only fetches for one without effect.
[[gnu::always_inline]] inline void fetch_faces(const WorkingMesh& mesh, std::uint32_t point) {
  for (std::uint32_t i = mesh.first[point]; i != mesh.first[point + 1]; ++i) {
    __builtin_prefetch(&mesh.faces[mesh.corners[i] >> 2U]);
  }
}

// Adds the faces at one end; those on the edge only when seen from u.
void add_faces(const WorkingMesh& mesh, std::uint32_t near, bool is_u, Star& star) {
  const glm::dvec3 origin{mesh.position[star.u]};
  const std::uint32_t far = is_u ? star.v : star.u;
  const glm::dvec3 at_near = is_u ? glm::dvec3{0.0} : star.e;
  for (std::uint32_t i = mesh.first[near]; i != mesh.first[near + 1]; ++i) {
    const std::uint32_t index = mesh.corners[i] >> 2U;
    const std::uint32_t k = mesh.corners[i] & 3U;
    const Face& f = mesh.faces[index];
    if (f.id == none) continue;
    if (mesh.has_seams()) __builtin_prefetch(&mesh.corner_vertex[3 * std::size_t{f.id}]);
    const std::uint32_t a = f.point[corner_after[k]];
    const std::uint32_t b = f.point[corner_before[k]];
    const bool shared = a == far || b == far;
    if (shared && !is_u) continue;
    star.shared += shared ? 1U : 0U;
    const glm::dvec3 at_a = glm::dvec3{mesh.position[a]} - origin;
    const glm::dvec3 at_b = glm::dvec3{mesh.position[b]} - origin;
    const Side side = shared ? Side::Both : is_u ? Side::U : Side::V;
    star.faces.emplace_back(index, k, a, b, side, at_a, at_b, glm::cross(at_a - at_near, at_b - at_near));
  }
}

}  // namespace

void gather_star(const WorkingMesh& mesh, std::uint32_t u, std::uint32_t v, Star& star) {
  star.u = u;
  star.v = v;
  star.e = glm::dvec3{mesh.position[v]} - glm::dvec3{mesh.position[u]};
  star.faces.clear();
  star.lines.clear();
  star.shared = 0;
  star.plain = ((mesh.flags[u] | mesh.flags[v]) & (point_border | point_complex | point_line)) == 0;
  fetch_faces(mesh, u);
  fetch_faces(mesh, v);
  add_faces(mesh, u, true, star);
  star.faces_of_u = static_cast<std::uint32_t>(star.faces.size());
  add_faces(mesh, v, false, star);
  star.faces_of_v = static_cast<std::uint32_t>(star.faces.size()) - star.faces_of_u + star.shared;
}

}  // namespace lodestone::collapse
