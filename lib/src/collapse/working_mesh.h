// SPDX-License-Identifier: MIT
// The mesh while it shrinks: faces between corner points in flat arrays that are compacted between passes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <lodestone/edge_collapse.h>

namespace lodestone::collapse {

// A live face; `id` names it in the source, `none` once it is gone. Corner k is corner 3 * id + k of the source.
struct Face {
  std::array<std::uint32_t, 3> point{};
  FaceId id = none;
};

// Flags of points.
inline constexpr std::uint8_t point_border = 1;   // on edges with one face only, otherwise manifold
inline constexpr std::uint8_t point_complex = 2;  // non-manifold, or two sheets touch
inline constexpr std::uint8_t point_line = 4;     // on a seam or material border
inline constexpr std::uint8_t point_frozen = 8;   // never moves, never goes
inline constexpr std::uint8_t point_locked = 16;  // taken part in a collapse of this pass
inline constexpr std::uint8_t point_sharp = 32;   // on a sharp edge that passes through: may only go along it
inline constexpr std::uint8_t point_corner = 64;  // where sharp edges end or meet: stays
inline constexpr std::uint8_t point_outer = 128;  // a neighbour lies outside the region of this pass

// The corner that follows corner k of a face, and the one before it. Tables, because k is as good as random and a
// branch on it would be guessed wrong.
inline constexpr std::array<std::uint32_t, 4> corner_after{1, 2, 0, 0};
inline constexpr std::array<std::uint32_t, 4> corner_before{2, 0, 1, 0};

[[nodiscard]] inline std::uint32_t corner_at(const Face& f, std::uint32_t point) noexcept {
  return f.point[0] == point ? 0 : f.point[1] == point ? 1 : 2;
}

struct WorkingMesh {
  std::vector<Face> faces;
  std::vector<glm::vec3> position;     // per point
  std::vector<float> deviation_m;      // per point: of the surface around it from the source
  std::vector<std::uint8_t> flags;     // per point: point_border and others
  std::vector<float> sharpness;        // per point, to the wanted power; empty if it does not count
  std::vector<std::uint32_t> part;     // per point: connected part; empty if there is one
  std::vector<VertexId> wedge;         // per point: the vertex there; empty if some point has several
  std::vector<std::uint32_t> first;    // per point, and one past the end: where its corners begin in `corners`
  std::vector<std::uint32_t> corners;  // 4 * position in faces + 0..2, ascending

  // Where points have several vertices (seams):
  std::vector<VertexId> corner_vertex;     // per corner of the source
  std::vector<std::uint32_t> vertex_uses;  // per vertex: live corners that name it
  VertexArrays values;                     // current normals, uvs and colours of the source's vertices; no positions

  std::uint32_t part_count = 1;

  [[nodiscard]] std::uint32_t point_count() const noexcept { return static_cast<std::uint32_t>(position.size()); }
  [[nodiscard]] double weight_at(std::uint32_t point) const noexcept {
    return sharpness.empty() ? 1.0 : double{sharpness[point]};
  }
  [[nodiscard]] bool has_seams() const noexcept { return wedge.empty(); }
  [[nodiscard]] VertexId vertex_of(const Face& f, std::uint32_t k) const noexcept {
    return wedge.empty() ? corner_vertex[3 * std::size_t{f.id} + k] : wedge[f.point[k]];
  }
};

// Points in Morton order, so that neighbours in space are neighbours in memory; faces by their first point. Faces with
// two corners on one point are left out: their ids are returned.
struct WorkingMeshStart {
  WorkingMesh mesh;
  std::vector<FaceId> degenerate;
};
[[nodiscard]] WorkingMeshStart make_working_mesh(const Mesh& source, const EdgeCollapseOptions& options,
                                                 const Context& context);

// Names the connected parts.
void find_parts(WorkingMesh& mesh);

// Drops dead faces and, when many are gone, unused points; rebuilds `first` and `corners`.
void compact(WorkingMesh& mesh, const Context& context);

}  // namespace lodestone::collapse
