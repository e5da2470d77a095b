// SPDX-License-Identifier: MIT
// What a cut must keep, checked from the finished graph alone: nothing here trusts how it was built.
#include <algorithm>
#include <array>

#include <lodestone/clusters.h>

#include "clusters/face_graph.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

using clusters::EdgeOfFace;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Edges used by one face, ascending.
std::vector<Edge> free_edges(std::span<const std::array<std::uint32_t, 3>> faces, std::uint32_t point_count) {
  const std::vector<EdgeOfFace> edges = clusters::sorted_edges(faces, point_count);
  std::vector<Edge> free;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end == i + 1) free.emplace_back(edges[i].low, edges[i].high);
    i = end;
  }
  return free;
}

void add_faces(const ClusterGraph& graph, const Weld& weld, NodeId node,
               std::vector<std::array<std::uint32_t, 3>>& out) {
  const Cluster& cluster = graph.clusters[node];
  for (std::uint32_t t = cluster.triangles.begin; t != cluster.triangles.end; ++t) {
    std::array<std::uint32_t, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      face[k] = weld.point_of[cluster.vertices.begin + graph.indices[3 * std::size_t{t} + k]];
    }
    out.push_back(face);
  }
}

// Per point of the weld.
std::vector<std::uint8_t> border_points(const ClusterGraph& graph, const Weld& weld) {
  std::vector<std::array<std::uint32_t, 3>> leaves;
  for (const LodLink& link : graph.graph.links) {
    if (link.maker != none) continue;
    for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) add_faces(graph, weld, n, leaves);
  }
  std::vector<std::uint8_t> border(weld.point_count(), 0);
  for (const auto& [a, b] : free_edges(leaves, weld.point_count())) border[a] = border[b] = 1;
  for (auto g = static_cast<GroupId>(graph.graph.groups.size()); g-- > 1;) {
    const Range nodes = graph.graph.groups[g].nodes;
    for (NodeId n = nodes.begin; n != nodes.end; ++n) {
      const Range vertices = graph.clusters[n].vertices;
      for (std::uint32_t v = vertices.begin; v != vertices.end; ++v) {
        if (border[weld.point_of[v]] != 0) border[weld.point_of[graph.morph_targets[v]]] = 1;
      }
    }
  }
  return border;
}

// Edges of the nodes given, those of the true border left out.
struct InnerEdges {
  std::vector<Edge> once;  // used by one face, ascending
  std::vector<Edge> all;   // ascending
};

InnerEdges inner_edges(const ClusterGraph& graph, const Weld& weld, const std::vector<std::uint8_t>& border,
                       std::span<const NodeId> nodes) {
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (const NodeId n : nodes) add_faces(graph, weld, n, faces);
  std::vector<Edge> uses;
  for (const auto& p : faces) {
    if (clusters::is_collapsed(p)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t q = p[(k + 1) % 3];
      if (border[p[k]] == 0 || border[q] == 0) uses.emplace_back(std::min(p[k], q), std::max(p[k], q));
    }
  }
  std::sort(uses.begin(), uses.end());
  InnerEdges edges;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    while (end < uses.size() && uses[end] == uses[i]) ++end;
    if (end == i + 1) edges.once.push_back(uses[i]);
    edges.all.push_back(uses[i]);
    i = end;
  }
  return edges;
}

std::size_t count_missing(const std::vector<Edge>& wanted, const std::vector<Edge>& there) {
  std::vector<Edge> missing;
  std::set_difference(wanted.begin(), wanted.end(), there.begin(), there.end(), std::back_inserter(missing));
  return missing.size();
}

// Whether some end of another crack lies inside the edge a-b.
bool holds_an_end(const glm::dvec3& a, const glm::dvec3& b, const std::vector<glm::dvec3>& ends) {
  const glm::dvec3 d = b - a;
  const double square = glm::dot(d, d);
  return std::any_of(ends.begin(), ends.end(), [&](const glm::dvec3& p) {
    const double t = glm::dot(p - a, d) / square;
    if (!(t > 1e-6 && t < 1.0 - 1e-6)) return false;
    const glm::dvec3 off = p - a - t * d;
    return glm::dot(off, off) < 1e-10 * square;
  });
}

}  // namespace

std::vector<std::uint8_t> true_border(const ClusterGraph& graph) {
  const Weld weld = weld_by_position(graph.vertices.positions);
  const std::vector<std::uint8_t> points = border_points(graph, weld);
  std::vector<std::uint8_t> border(graph.vertices.size());
  for (std::size_t v = 0; v < border.size(); ++v) border[v] = points[weld.point_of[v]];
  return border;
}

CutFaults find_faults(const ClusterGraph& graph, std::span<const NodeId> cut, const Mesh& mesh,
                      std::span<const std::uint8_t> border) {
  const Weld weld = weld_by_position(mesh.vertices.positions);
  std::vector<std::uint8_t> point_border(weld.point_count(), 0);
  std::uint32_t at = 0;
  for (const NodeId n : cut) {
    const Range vertices = graph.clusters[n].vertices;
    for (std::uint32_t v = vertices.begin; v != vertices.end; ++v, ++at) {
      if (border[v] != 0) point_border[weld.point_of[at]] = 1;
    }
  }
  std::vector<std::array<std::uint32_t, 3>> faces(mesh.triangle_count());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) faces[f][k] = weld.point_of[mesh.indices[3 * f + k]];
  }
  std::vector<Edge> cracks = free_edges(faces, weld.point_count());
  std::erase_if(cracks, [&](const Edge& e) { return point_border[e.first] != 0 && point_border[e.second] != 0; });
  CutFaults faults;
  faults.cracks = static_cast<std::uint32_t>(cracks.size());
  const auto place = [&](std::uint32_t p) { return glm::dvec3{mesh.vertices.positions[weld.first_vertex[p]]}; };
  std::vector<glm::dvec3> ends;
  for (const Edge& e : cracks) {
    ends.push_back(place(e.first));
    ends.push_back(place(e.second));
  }
  for (const Edge& e : cracks) faults.t_junctions += holds_an_end(place(e.first), place(e.second), ends) ? 1U : 0U;
  return faults;
}

std::uint64_t changed_border_edges(const ClusterGraph& graph) {
  const Weld weld = weld_by_position(graph.vertices.positions);
  const std::vector<std::uint8_t> border = border_points(graph, weld);
  std::vector<std::vector<NodeId>> made(graph.graph.groups.size());
  for (const LodLink& link : graph.graph.links) {
    if (link.maker == none) continue;
    for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) made[link.maker].push_back(n);
  }
  std::uint64_t changed = 0;
  std::vector<NodeId> fine;
  for (GroupId g = 1; g < graph.graph.groups.size(); ++g) {
    fine.clear();
    const Range nodes = graph.graph.groups[g].nodes;
    for (NodeId n = nodes.begin; n != nodes.end; ++n) fine.push_back(n);
    const InnerEdges before = inner_edges(graph, weld, border, fine);
    const InnerEdges after = inner_edges(graph, weld, border, made[g]);
    changed += count_missing(before.once, after.all) + count_missing(after.once, before.once);
  }
  return changed;
}

}  // namespace lodestone
