// SPDX-License-Identifier: MIT
// Based on: Barequet and Sharir 1995, "Filling gaps in the boundary of a polyhedron" (match pieces of open border).
// Differs: nothing is moved. A triangle takes in the points that its open sides pass by and is triangulated anew.
#include <lodestone/polygon.h>
#include <algorithm>
#include <array>
#include <utility>

#include "geometry/bvh.h"
#include "mesh/edges.h"
#include "mesh/repair.h"
#include "mesh/vertex_copy.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

// A point that lies on the side of a face that begins at `corner`, at share t of its length.
struct Insertion {
  CornerId corner = 0;
  double t = 0.0;
  std::uint32_t point = 0;
};

struct OpenSides {
  std::vector<CornerId> corners;
  std::vector<std::uint32_t> points;  // their ends, ascending, each once
};

OpenSides open_sides(const Mesh& mesh, const Weld& weld) {
  OpenSides open;
  const EdgeTable edges = find_edges(mesh, weld);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses_of(e);
    if (uses.size() != 1) continue;
    open.corners.push_back(uses[0].corner);
    open.points.push_back(edges.low[e]);
    open.points.push_back(uses[0].high);
  }
  std::sort(open.points.begin(), open.points.end());
  open.points.erase(std::unique(open.points.begin(), open.points.end()), open.points.end());
  return open;
}

// Ordered by corner, then along the side.
std::vector<Insertion> find_insertions(const Mesh& mesh, const Weld& weld, double tolerance_m) {
  const OpenSides open = open_sides(mesh, weld);
  std::vector<VertexId> segments;  // as triangles without area
  for (const CornerId c : open.corners) {
    const VertexId end = mesh.indices[next_corner(c)];
    segments.insert(segments.end(), {mesh.indices[c], end, end});
  }
  const auto at = [&](VertexId v) { return glm::dvec3{mesh.vertices.positions[v]}; };
  const TriangleBvh tree{mesh.vertices.positions, segments};
  std::vector<Insertion> insertions;
  for (const std::uint32_t point : open.points) {
    const glm::dvec3 p = at(weld.first_vertex[point]);
    const auto inner = [&](FaceId side) {  // away from both ends, which are for welding
      const glm::dvec3 a = at(segments[3 * std::size_t{side}]);
      const glm::dvec3 b = at(segments[3 * std::size_t{side} + 1]);
      return std::min(glm::distance(p, a), glm::distance(p, b)) > tolerance_m;
    };
    tree.within(p, tolerance_m, inner, [&](FaceId side) {
      const CornerId corner = open.corners[side];
      const VertexId* face = &mesh.indices[corner - corner % 3];
      const bool own = std::any_of(face, face + 3, [&](VertexId v) { return weld.point_of[v] == point; });
      if (own) return true;  // a sliver: its tip lies near its base
      const glm::dvec3 a = at(segments[3 * std::size_t{side}]);
      const glm::dvec3 b = at(segments[3 * std::size_t{side} + 1]);
      insertions.push_back({corner, nearest_on_segment(p - a, b - a), point});
      return true;
    });
  }
  std::sort(insertions.begin(), insertions.end(), [](const Insertion& a, const Insertion& b) {
    if (a.corner != b.corner) return a.corner < b.corner;
    return a.t != b.t ? a.t < b.t : a.point < b.point;
  });
  return insertions;
}

struct Faces {
  std::vector<VertexId> indices;
  std::vector<FaceId> source;  // the face each was cut from

  void append(FaceId from, const std::array<VertexId, 3>& vertices) {
    indices.insert(indices.end(), vertices.begin(), vertices.end());
    source.push_back(from);
  }
};

// Appends face f, cut so that its sides use the inserted points. Returns how many were used.
std::uint32_t append_face(Mesh& mesh, const Weld& weld, FaceId f, std::span<const Insertion> insertions, Faces& out) {
  constexpr const Insertion* corner_itself = nullptr;
  std::vector<std::pair<CornerId, const Insertion*>> outline;
  std::vector<glm::dvec3> points;
  auto next = insertions.begin();
  for (CornerId c = 3 * f; c < 3 * f + 3; ++c) {
    outline.emplace_back(c, corner_itself);
    points.emplace_back(mesh.vertices.positions[mesh.indices[c]]);
    for (; next != insertions.end() && next->corner == c; ++next) {
      outline.emplace_back(c, &*next);
      points.emplace_back(mesh.vertices.positions[weld.first_vertex[next->point]]);
    }
  }
  const auto count = static_cast<std::uint32_t>(points.size());
  const auto triangles = triangulate_polygon(points, std::span{&count, 1});
  const bool whole = triangles.size() + 2 == count;
  if (!whole) {  // a sliver that the points would turn inside out
    out.append(f, {mesh.indices[3 * std::size_t{f}], mesh.indices[3 * std::size_t{f} + 1],
                   mesh.indices[3 * std::size_t{f} + 2]});
    return 0;
  }
  std::vector<VertexId> vertices;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto [c, insertion] = outline[i];
    const VertexId a = mesh.indices[c];
    const VertexId b = mesh.indices[next_corner(c)];
    vertices.push_back(insertion == corner_itself ? a
                                                  : append_vertex_between(mesh.vertices, glm::vec3{points[i]}, a, b,
                                                                          static_cast<float>(insertion->t)));
  }
  for (const auto& [a, b, c] : triangles) out.append(f, {vertices[a], vertices[b], vertices[c]});
  return count - 3;
}

template <class T>
void gather(std::vector<T>& values, const std::vector<FaceId>& source) {
  if (values.empty()) return;
  std::vector<T> gathered;
  gathered.reserve(source.size());
  for (const FaceId f : source) gathered.push_back(values[f]);
  values = std::move(gathered);
}

}  // namespace

std::uint32_t close_t_junctions(Mesh& mesh, double tolerance_m) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  const std::vector<Insertion> insertions = find_insertions(mesh, weld, tolerance_m);
  if (insertions.empty()) return 0;
  Faces faces;
  faces.indices.reserve(mesh.indices.size() + 3 * insertions.size());
  std::uint32_t closed = 0;
  std::size_t next = 0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const std::size_t begin = next;
    while (next < insertions.size() && insertions[next].corner / 3 == f) ++next;
    closed += append_face(mesh, weld, f, std::span{insertions}.subspan(begin, next - begin), faces);
  }
  mesh.indices = std::move(faces.indices);
  gather(mesh.face_materials, faces.source);
  gather(mesh.face_features, faces.source);
  merge_identical_vertices(mesh);
  return closed;
}

}  // namespace lodestone
