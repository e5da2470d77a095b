// SPDX-License-Identifier: MIT
#include "mesh/repair.h"

#include <lodestone/repair.h>

#include <algorithm>
#include <array>
#include <vector>

#include "base/hash.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

template <class T>
void keep_marked(std::vector<T>& values, const std::vector<std::uint8_t>& keep, std::size_t group) {
  if (values.empty()) return;
  std::size_t out = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (keep[i / group] != 0) values[out++] = values[i];
  }
  values.resize(out);
}

// Returns how many triangles went.
std::uint32_t keep_faces(Mesh& mesh, const std::vector<std::uint8_t>& keep) {
  const std::uint32_t before = mesh.triangle_count();
  keep_marked(mesh.indices, keep, 3);
  keep_marked(mesh.face_materials, keep, 1);
  keep_marked(mesh.face_features, keep, 1);
  return before - mesh.triangle_count();
}

std::uint32_t remove_degenerate(Mesh& mesh) {
  std::vector<std::uint8_t> keep(mesh.triangle_count());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) keep[f] = area_vector(mesh, f) != glm::dvec3{0.0} ? 1 : 0;
  return keep_faces(mesh, keep);
}

// The points of a face, smallest first in the face's own turn; where both sides are one, the smaller of both turns.
std::array<std::uint32_t, 3> face_key(const Mesh& mesh, const Weld& weld, FaceId f) {
  std::array<std::uint32_t, 3> key{};
  for (std::size_t c = 0; c < 3; ++c) key[c] = weld.point_of[mesh.indices[3 * std::size_t{f} + c]];
  std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
  if (mesh.materials[mesh.face_material(f)].double_sided && key[1] > key[2]) std::swap(key[1], key[2]);
  return key;
}

std::uint32_t remove_duplicates(Mesh& mesh) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  std::vector<std::array<std::uint32_t, 3>> keys(mesh.triangle_count());
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) keys[f] = face_key(mesh, weld, f);
  const UniqueIds unique = unique_ids(
      mesh.triangle_count(),
      [&](FaceId f) { return hash_combine(std::uint64_t{keys[f][0]} << 32U | keys[f][1], keys[f][2]); },
      [&](FaceId f, FaceId g) { return keys[f] == keys[g]; });
  std::vector<std::uint8_t> keep(mesh.triangle_count(), 0);
  for (const FaceId f : unique.first) keep[f] = 1;
  return keep_faces(mesh, keep);
}

}  // namespace

RepairReport repair(Mesh& mesh, const RepairOptions& options) {
  RepairReport report;
  if (options.weld_tolerance_m > 0.0) report.welded_points = weld_near_points(mesh, options.weld_tolerance_m);
  if (options.remove_degenerate) report.degenerate_triangles = remove_degenerate(mesh);
  if (options.remove_duplicates) report.duplicate_triangles = remove_duplicates(mesh);
  if (options.t_junction_tolerance_m > 0.0) {
    report.closed_t_junctions = close_t_junctions(mesh, options.t_junction_tolerance_m);
  }
  if (options.fill_holes_perimeter_m > 0.0) report.filled_holes = fill_holes(mesh, options.fill_holes_perimeter_m);
  if (options.orient) report.flipped_triangles = orient_faces(mesh);
  return report;
}

void leave_plain(Mesh& mesh, const std::vector<bool>& faces) {
  std::vector<MaterialId> plain(mesh.materials.size(), none);  // per material: its copy
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const MaterialId m = mesh.face_material(f);
    if (!faces[f] || mesh.materials[m].texture == none) continue;
    if (plain[m] == none) {
      plain[m] = static_cast<MaterialId>(mesh.materials.size());
      mesh.materials.push_back(Material{mesh.materials[m]});
      mesh.materials.back().texture = none;
    }
    if (mesh.face_materials.empty()) mesh.face_materials.assign(mesh.triangle_count(), 0);
    mesh.face_materials[f] = plain[m];
  }
}

}  // namespace lodestone
