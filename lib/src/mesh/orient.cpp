// SPDX-License-Identifier: MIT
// Turning triangles so that neighbours agree: spread over edges of two faces, then decide each part as a whole.
#include <algorithm>
#include <utility>
#include <vector>

#include "mesh/edges.h"
#include "mesh/repair.h"
#include "mesh/vertex_copy.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

struct Neighbour {
  FaceId face = none;  // none: open, or an edge of three and more
  bool agrees = true;
};

std::vector<Neighbour> find_neighbours(const Mesh& mesh, const EdgeTable& edges) {
  std::vector<Neighbour> neighbours(mesh.indices.size());
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses_of(e);
    if (uses.size() != 2) continue;
    const bool agrees = uses[0].ascending != uses[1].ascending;
    neighbours[uses[0].corner] = {uses[1].corner / 3, agrees};
    neighbours[uses[1].corner] = {uses[0].corner / 3, agrees};
  }
  return neighbours;
}

// Faces that hang together over edges of two, with which of them to turn so that all agree with the first.
struct Part {
  std::vector<FaceId> faces;
  bool closed = true;
};

Part collect(FaceId first, const std::vector<Neighbour>& neighbours, std::vector<std::uint8_t>& seen,
             std::vector<std::uint8_t>& turn) {
  Part part{.faces = {first}};
  seen[first] = 1;
  for (std::size_t i = 0; i < part.faces.size(); ++i) {
    const FaceId f = part.faces[i];
    for (CornerId c = 3 * f; c < 3 * f + 3; ++c) {
      const Neighbour& n = neighbours[c];
      if (n.face == none) {
        part.closed = false;
      } else if (seen[n.face] == 0) {
        seen[n.face] = 1;
        turn[n.face] = n.agrees ? turn[f] : static_cast<std::uint8_t>(1 - turn[f]);
        part.faces.push_back(n.face);
      }
    }
  }
  return part;
}

// Whether the part as marked is inside out (closed), or against the larger share of its area (open).
bool turned_wrong(const Mesh& mesh, const Part& part, const std::vector<std::uint8_t>& turn) {
  double score = 0.0;
  const auto& p = mesh.vertices.positions;
  const glm::dvec3 middle{p[mesh.indices[3 * std::size_t{part.faces[0]}]]};
  for (const FaceId f : part.faces) {
    const glm::dvec3 n = area_vector(mesh, f);
    const double sign = turn[f] != 0 ? -1.0 : 1.0;
    score += sign * (part.closed ? glm::dot(n, glm::dvec3{p[mesh.indices[3 * std::size_t{f}]]} - middle) : 0.0);
    if (!part.closed) score += sign * glm::length(n);
  }
  return score < 0.0;
}

// Turns the marked faces; their vertices get the opposite normal, as copies where others use them too.
void turn_faces(Mesh& mesh, const std::vector<std::uint8_t>& turn) {
  std::vector<std::uint8_t> kept_use(mesh.vertex_count(), 0);
  for (CornerId c = 0; c < mesh.indices.size(); ++c) {
    if (turn[c / 3] == 0) kept_use[mesh.indices[c]] = 1;
  }
  std::vector<VertexId> turned(mesh.vertex_count(), none);
  for (FaceId f = 0; f < turn.size(); ++f) {
    if (turn[f] == 0) continue;
    VertexId* v = &mesh.indices[3 * std::size_t{f}];
    std::swap(v[1], v[2]);
    if (mesh.vertices.normals.empty()) continue;
    for (VertexId* corner = v; corner != v + 3; ++corner) {
      VertexId& copy = turned[*corner];
      if (copy == none) {
        copy = kept_use[*corner] != 0 ? append_vertex_copy(mesh.vertices, *corner) : *corner;
        mesh.vertices.normals[copy] = -mesh.vertices.normals[copy];
      }
      *corner = copy;
    }
  }
}

}  // namespace

std::uint32_t orient_faces(Mesh& mesh) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  const std::vector<Neighbour> neighbours = find_neighbours(mesh, find_edges(mesh, weld));
  std::vector<std::uint8_t> seen(mesh.triangle_count(), 0);
  std::vector<std::uint8_t> turn(mesh.triangle_count(), 0);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    if (seen[f] != 0) continue;
    const Part part = collect(f, neighbours, seen, turn);
    if (!turned_wrong(mesh, part, turn)) continue;
    for (const FaceId g : part.faces) turn[g] = static_cast<std::uint8_t>(1 - turn[g]);
  }
  turn_faces(mesh, turn);
  return static_cast<std::uint32_t>(std::count(turn.begin(), turn.end(), std::uint8_t{1}));
}

}  // namespace lodestone
