// SPDX-License-Identifier: MIT
#include <lodestone/mesh.h>

#include <algorithm>
#include <array>
#include <bit>

#include "base/disjoint_sets.h"
#include "base/hash.h"
#include "mesh/edges.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

// Moves the kept elements to the front; returns old index -> new index (`none` for those dropped).
std::vector<std::uint32_t> numbering(const std::vector<std::uint8_t>& keep) {
  std::vector<std::uint32_t> renamed(keep.size(), none);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) renamed[i] = next++;
  }
  return renamed;
}

template <class T>
void compact(std::vector<T>& values, const std::vector<std::uint32_t>& renamed) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < renamed.size(); ++i) {
    if (renamed[i] == none) continue;
    if (renamed[i] != i) values[renamed[i]] = std::move(values[i]);
    ++kept;
  }
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(kept), values.end());
}

void compact_vertices(VertexArrays& vertices, const std::vector<std::uint32_t>& renamed) {
  compact(vertices.positions, renamed);
  compact(vertices.normals, renamed);
  compact(vertices.uvs, renamed);
  compact(vertices.colors, renamed);
}

std::uint32_t count_components(const Mesh& mesh, const Weld& weld, const EdgeTable& edges) {
  DisjointSets faces{mesh.triangle_count()};
  std::uint32_t components = 0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    if (!collapsed(weld, &mesh.indices[3 * std::size_t{f}])) ++components;
  }
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses_of(e);
    for (const EdgeUse& use : uses) {
      if (faces.join(uses.front().corner / 3, use.corner / 3)) --components;
    }
  }
  return components;
}

std::uint32_t count_duplicates(const Mesh& mesh, const Weld& weld) {
  std::vector<std::array<std::uint32_t, 3>> keys(mesh.triangle_count());
  for (std::size_t f = 0; f < keys.size(); ++f) {
    for (std::size_t c = 0; c < 3; ++c) keys[f][c] = weld.point_of[mesh.indices[3 * f + c]];
    std::sort(keys[f].begin(), keys[f].end());
  }
  const UniqueIds unique = unique_ids(
      mesh.triangle_count(),
      [&](std::uint32_t f) { return hash_combine(std::uint64_t{keys[f][0]} << 32U | keys[f][1], keys[f][2]); },
      [&](std::uint32_t f, std::uint32_t g) { return keys[f] == keys[g]; });
  return mesh.triangle_count() - static_cast<std::uint32_t>(unique.first.size());
}

template <class T>
std::array<std::uint32_t, sizeof(T) / sizeof(std::uint32_t)> words_of(const T& value) noexcept {
  return std::bit_cast<std::array<std::uint32_t, sizeof(T) / sizeof(std::uint32_t)>>(value);
}

template <class T>
bool same_bits(const std::vector<T>& values, std::uint32_t i, std::uint32_t j) {
  return values.empty() || words_of(values[i]) == words_of(values[j]);
}

template <class T>
std::uint64_t hash_bits(std::uint64_t seed, const std::vector<T>& values, std::uint32_t i) {
  if (values.empty()) return seed;
  for (const std::uint32_t word : words_of(values[i])) seed = hash_combine(seed, word);
  return seed;
}

}  // namespace

Box bounds(const Mesh& mesh) {
  Box box;
  if (mesh.vertices.positions.empty()) return box;
  glm::vec3 low{mesh.vertices.positions.front()};
  glm::vec3 high{low};
  for (const glm::vec3& p : mesh.vertices.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  box.add(glm::dvec3{low});
  box.add(glm::dvec3{high});
  return box;
}

MeshReport inspect(const Mesh& mesh) {
  MeshReport report;
  const Weld weld = weld_by_position(mesh.vertices.positions);
  const EdgeTable edges = find_edges(mesh, weld);
  report.corner_points = weld.point_count();
  report.components = count_components(mesh, weld, edges);
  report.duplicate_triangles = count_duplicates(mesh, weld);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const std::size_t faces = edges.uses_of(e).size();
    if (faces == 1) ++report.boundary_edges;
    if (faces > 2) ++report.non_manifold_edges;
  }
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const bool flat = area_vector(mesh, f) == glm::dvec3{0.0};
    if (flat || collapsed(weld, &mesh.indices[3 * std::size_t{f}])) ++report.degenerate_triangles;
  }
  report.bounds = bounds(mesh);
  return report;
}

void remove_unused(Mesh& mesh) {
  std::vector<std::uint8_t> keep(mesh.vertex_count(), 0);
  for (const VertexId v : mesh.indices) keep[v] = 1;
  const auto new_vertex = numbering(keep);
  compact_vertices(mesh.vertices, new_vertex);
  for (VertexId& v : mesh.indices) v = new_vertex[v];

  keep.assign(mesh.materials.size(), 0);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) keep[mesh.face_material(f)] = 1;
  const auto new_material = numbering(keep);
  compact(mesh.materials, new_material);
  for (MaterialId& m : mesh.face_materials) m = new_material[m];

  keep.assign(mesh.textures.size(), 0);
  for (const Material& material : mesh.materials) {
    if (material.texture != none) keep[material.texture] = 1;
  }
  const auto new_texture = numbering(keep);
  compact(mesh.textures, new_texture);
  for (Material& material : mesh.materials) {
    if (material.texture != none) material.texture = new_texture[material.texture];
  }
}

std::uint32_t merge_identical_vertices(Mesh& mesh) {
  const VertexArrays& v = mesh.vertices;
  const UniqueIds unique = unique_ids(
      v.size(),
      [&](std::uint32_t i) {
        return hash_bits(hash_bits(hash_bits(hash_bits(0, v.positions, i), v.normals, i), v.uvs, i), v.colors, i);
      },
      [&](std::uint32_t i, std::uint32_t j) {
        return same_bits(v.positions, i, j) && same_bits(v.normals, i, j) && same_bits(v.uvs, i, j) &&
               same_bits(v.colors, i, j);
      });
  const auto removed = static_cast<std::uint32_t>(v.size() - unique.first.size());
  if (removed == 0) return 0;
  std::vector<std::uint8_t> keep(v.size(), 0);
  for (const std::uint32_t first : unique.first) keep[first] = 1;
  compact_vertices(mesh.vertices, numbering(keep));
  for (VertexId& i : mesh.indices) i = unique.id_of[i];
  return removed;
}

}  // namespace lodestone
