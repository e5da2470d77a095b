// SPDX-License-Identifier: MIT
// OpenMesh: the half-edge structure for what needs walking along borders and around vertices.
#include <lodestone/openmesh.h>
#include <lodestone/topology.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "mesh/edges.h"
#include "mesh/import_manifold.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

using Half = OpenMesh::TriMesh;
using FaceProperty = OpenMesh::FPropHandleT<unsigned int>;

struct Connectivity {
  Half mesh;
  std::vector<std::uint32_t> point_of_vertex;
  std::vector<FaceId> face_of;
};

Half::Point to_point(const glm::vec3& p) { return {p.x, p.y, p.z}; }

Connectivity connect(const Mesh& mesh, const Weld& weld, const EdgeTable& edges) {
  ManifoldCut cut = cut_to_manifold(mesh, weld, edges);
  Connectivity result;
  const auto position = [&](std::uint32_t point) {
    return to_point(mesh.vertices.positions[weld.first_vertex[point]]);
  };
  for (const std::uint32_t point : cut.point_of_vertex) result.mesh.add_vertex(position(point));
  result.point_of_vertex = std::move(cut.point_of_vertex);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const std::uint32_t* v = &cut.vertex_of_corner[3 * std::size_t{f}];
    if (v[0] == none) continue;
    const auto handle = [](std::uint32_t i) { return OpenMesh::VertexHandle{static_cast<int>(i)}; };
    if (!result.mesh.add_face(handle(v[0]), handle(v[1]), handle(v[2])).is_valid()) {
      // Never seen after the cut; but if OpenMesh cannot link the face here, it gets vertices of its own.
      std::array<OpenMesh::VertexHandle, 3> own;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t point = result.point_of_vertex[v[c]];
        own[c] = result.mesh.add_vertex(position(point));
        result.point_of_vertex.push_back(point);
      }
      result.mesh.add_face(own[0], own[1], own[2]);
    }
    result.face_of.push_back(f);
  }
  return result;
}

// The side that a half-edge inside a face runs along. The first half-edge of a face points to its first corner.
CornerId side_of(const Connectivity& half, OpenMesh::HalfedgeHandle h) {
  const auto face = half.mesh.face_handle(h);
  const FaceId f = half.face_of[static_cast<std::size_t>(face.idx())];
  const auto first = half.mesh.halfedge_handle(face);
  if (h == first) return 3 * f + 2;
  return h == half.mesh.next_halfedge_handle(first) ? 3 * f : 3 * f + 1;
}

// Follows every border; open(side) tells a true border from a cut. Returns the number of loops, cuts included.
template <class Open>
std::uint32_t walk_borders(const Connectivity& half, Open open, Topology& topology) {
  std::uint32_t loops = 0;
  std::vector<std::uint8_t> seen(half.mesh.n_halfedges(), 0);
  for (const auto start : half.mesh.halfedges()) {
    if (!half.mesh.is_boundary(start) || seen[static_cast<std::size_t>(start.idx())] != 0) continue;
    ++loops;
    std::vector<CornerId> sides;
    for (OpenMesh::HalfedgeHandle h = start; seen[static_cast<std::size_t>(h.idx())] == 0;
         h = half.mesh.next_halfedge_handle(h)) {
      seen[static_cast<std::size_t>(h.idx())] = 1;
      const CornerId side = side_of(half, half.mesh.opposite_halfedge_handle(h));
      if (open(side)) sides.push_back(side);
    }
    if (!sides.empty()) topology.boundary_loops.push_back(std::move(sides));
  }
  return loops;
}

void count_pieces(const Half& mesh, std::uint32_t loops, Topology& topology) {
  DisjointSets sets{static_cast<std::uint32_t>(mesh.n_vertices())};
  std::vector<std::uint8_t> bordered(mesh.n_vertices(), 0);
  for (const auto e : mesh.edges()) {
    const auto h = mesh.halfedge_handle(e, 0);
    sets.join(static_cast<std::uint32_t>(mesh.from_vertex_handle(h).idx()),
              static_cast<std::uint32_t>(mesh.to_vertex_handle(h).idx()));
  }
  for (const auto e : mesh.edges()) {
    if (!mesh.is_boundary(e)) continue;
    bordered[sets.find(static_cast<std::uint32_t>(mesh.to_vertex_handle(mesh.halfedge_handle(e, 0)).idx()))] = 1;
  }
  for (std::uint32_t v = 0; v < mesh.n_vertices(); ++v) {
    if (sets.find(v) != v) continue;
    ++topology.pieces;
    if (bordered[v] == 0) ++topology.closed_pieces;
  }
  // Euler and Poincare: V - E + F = 2 (pieces - handles) - loops.
  const std::int64_t euler = static_cast<std::int64_t>(mesh.n_vertices()) - static_cast<std::int64_t>(mesh.n_edges()) +
                             static_cast<std::int64_t>(mesh.n_faces());
  topology.handles = static_cast<std::uint32_t>((2 * std::int64_t{topology.pieces} - euler - std::int64_t{loops}) / 2);
}

template <class T>
unsigned char to_byte(T share) {
  return static_cast<unsigned char>(std::lround(255.0F * std::clamp(static_cast<float>(share), 0.0F, 1.0F)));
}

glm::u8vec4 to_color(const Half::Color& c) { return {to_byte(c[0]), to_byte(c[1]), to_byte(c[2]), to_byte(c[3])}; }

glm::vec3 to_vec3(const Half::Point& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

// Appends the wedge at the end of h.
void append_wedge(const Half& mesh, OpenMesh::HalfedgeHandle h, VertexArrays& out) {
  const auto v = mesh.to_vertex_handle(h);
  out.positions.push_back(to_vec3(mesh.point(v)));
  if (mesh.has_halfedge_normals()) {
    out.normals.push_back(to_vec3(mesh.normal(h)));
  } else if (mesh.has_vertex_normals()) {
    out.normals.push_back(to_vec3(mesh.normal(v)));
  }
  if (mesh.has_halfedge_texcoords2D() || mesh.has_vertex_texcoords2D()) {
    const auto uv = mesh.has_halfedge_texcoords2D() ? mesh.texcoord2D(h) : mesh.texcoord2D(v);
    out.uvs.emplace_back(uv[0], uv[1]);
  }
  if (mesh.has_halfedge_colors()) {
    out.colors.push_back(to_color(mesh.color(h)));
  } else if (mesh.has_vertex_colors()) {
    out.colors.push_back(to_color(mesh.color(v)));
  }
}

void copy_attributes(const Mesh& source, VertexId v, OpenMesh::HalfedgeHandle h, Half& mesh) {
  const VertexArrays& from = source.vertices;
  if (!from.normals.empty()) mesh.set_normal(h, to_point(from.normals[v]));
  if (!from.uvs.empty()) mesh.set_texcoord2D(h, {from.uvs[v].x, from.uvs[v].y});
  if (!from.colors.empty()) {
    const glm::vec4 c = glm::vec4{from.colors[v]} / 255.0F;
    mesh.set_color(h, {c.r, c.g, c.b, c.a});
  }
}

// Reads an optional property of faces.
std::vector<std::uint32_t> read_property(const Half& mesh, const char* name) {
  std::vector<std::uint32_t> values;
  FaceProperty property;
  if (!mesh.get_property_handle(property, name)) return values;
  for (const auto f : mesh.faces()) values.push_back(mesh.property(property, f));
  return values;
}

}  // namespace

Topology analyse_topology(const Mesh& mesh) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  const EdgeTable edges = find_edges(mesh, weld);
  Topology topology;
  topology.edges = edges.size();
  std::vector<std::uint8_t> open(mesh.indices.size(), 0);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses_of(e);
    if (uses.size() == 1) open[uses[0].corner] = 1;
    if (uses.size() > 2) ++topology.non_manifold_edges;
    if (uses.size() == 2 && uses[0].ascending == uses[1].ascending) ++topology.inconsistent_edges;
  }
  const Connectivity half = connect(mesh, weld, edges);
  topology.faces = static_cast<std::uint32_t>(half.mesh.n_faces());
  std::vector<std::uint32_t> fans(weld.point_count(), 0);
  for (const std::uint32_t point : half.point_of_vertex) ++fans[point];
  for (const std::uint32_t count : fans) {
    if (count > 0) ++topology.corner_points;
    if (count > 1) ++topology.non_manifold_points;
  }
  const std::uint32_t loops = walk_borders(
      half, [&](CornerId side) { return open[side] != 0; }, topology);
  count_pieces(half.mesh, loops, topology);
  return topology;
}

OpenMeshCopy to_openmesh(const Mesh& mesh) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  Connectivity half = connect(mesh, weld, find_edges(mesh, weld));
  OpenMeshCopy copy{.mesh = std::move(half.mesh),
                    .point_of_vertex = std::move(half.point_of_vertex),
                    .face_of = std::move(half.face_of)};
  if (!mesh.vertices.normals.empty()) copy.mesh.request_halfedge_normals();
  if (!mesh.vertices.uvs.empty()) copy.mesh.request_halfedge_texcoords2D();
  if (!mesh.vertices.colors.empty()) copy.mesh.request_halfedge_colors();
  FaceProperty material;
  FaceProperty feature;
  copy.mesh.add_property(material, openmesh_material);
  copy.mesh.add_property(feature, openmesh_feature);
  for (const auto face : copy.mesh.faces()) {
    const FaceId f = copy.face_of[static_cast<std::size_t>(face.idx())];
    copy.mesh.property(material, face) = mesh.face_material(f);
    copy.mesh.property(feature, face) = mesh.face_feature(f);
    OpenMesh::HalfedgeHandle h = copy.mesh.halfedge_handle(face);
    for (CornerId c = 3 * f; c < 3 * f + 3; ++c, h = copy.mesh.next_halfedge_handle(h)) {
      copy_attributes(mesh, mesh.indices[c], h, copy.mesh);
    }
  }
  return copy;
}

Mesh from_openmesh(const OpenMesh::TriMesh& mesh, const Surroundings& surroundings) {
  Mesh result;
  static_cast<Surroundings&>(result) = surroundings;
  if (result.materials.empty()) result.materials.emplace_back();
  for (const auto face : mesh.faces()) {
    OpenMesh::HalfedgeHandle h = mesh.halfedge_handle(face);
    for (int c = 0; c < 3; ++c, h = mesh.next_halfedge_handle(h)) {
      result.indices.push_back(result.vertices.size());
      append_wedge(mesh, h, result.vertices);
    }
  }
  result.face_materials = read_property(mesh, openmesh_material);
  if (!result.features.empty()) result.face_features = read_property(mesh, openmesh_feature);
  merge_identical_vertices(result);
  return result;
}

}  // namespace lodestone
