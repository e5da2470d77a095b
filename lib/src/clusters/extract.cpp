// SPDX-License-Identifier: MIT
// Based on: Hoppe 1996 (geomorphs), Ulrich 2002 and Sander and Mitchell 2005 (each vertex knows its coarser place).
// Differs: the coarser place is a vertex of what the group made, so it costs an index; groups have locked borders, so
// one weight for a group cannot open anything.
#include <algorithm>
#include <cassert>
#include <cmath>

#include <lodestone/clusters.h>

namespace lodestone {
namespace {

template <class Vector>
Vector between(const Vector& a, const Vector& b, float t) {
  return a + (b - a) * t;
}

glm::vec3 turned(const glm::vec3& a, const glm::vec3& b, float t) {
  const glm::vec3 n = between(a, b, t);
  const float length = glm::length(n);
  return length > 1e-6F ? n / length : b;
}

glm::u8vec4 mixed(const glm::u8vec4& a, const glm::u8vec4& b, float t) {
  const glm::vec4 c = between(glm::vec4{a}, glm::vec4{b}, t) + 0.5F;
  return glm::u8vec4{c};
}

void append_triangles(const ClusterGraph& graph, NodeId node, std::uint32_t first_vertex, Mesh& mesh) {
  const Cluster& cluster = graph.clusters[node];
  for (std::uint32_t i = 3 * cluster.triangles.begin; i != 3 * cluster.triangles.end; ++i) {
    mesh.indices.push_back(first_vertex + graph.indices[i]);
  }
  for (std::uint32_t s = cluster.sections.begin; s != cluster.sections.end; ++s) {
    const ClusterSection& section = graph.sections[s];
    mesh.face_materials.insert(mesh.face_materials.end(), section.triangles.size(), section.material);
  }
  if (graph.face_features.empty()) return;
  mesh.face_features.insert(mesh.face_features.end(), graph.face_features.begin() + cluster.triangles.begin,
                            graph.face_features.begin() + cluster.triangles.end);
}

}  // namespace

void morph(const ClusterGraph& graph, NodeId node, double weight, VertexArrays& out) {
  const VertexArrays& from = graph.vertices;
  const auto t = static_cast<float>(weight);
  const Range range = graph.clusters[node].vertices;
  for (std::uint32_t v = range.begin; v != range.end; ++v) {
    const std::uint32_t to = t == 0.0F ? v : graph.morph_targets[v];
    // Exact at the end as well, where a + (b - a) may miss b by a rounding.
    const auto at = [&](const auto& list, auto&& mix) { return t == 1.0F ? list[to] : mix(list[v], list[to], t); };
    const auto straight = [](const auto& a, const auto& b, float s) { return between(a, b, s); };
    out.positions.push_back(at(from.positions, straight));
    if (!from.normals.empty()) out.normals.push_back(at(from.normals, turned));
    if (!from.uvs.empty()) out.uvs.push_back(at(from.uvs, straight));
    if (!from.colors.empty()) out.colors.push_back(at(from.colors, mixed));
  }
}

Mesh extract_morphed(const ClusterGraph& graph, std::span<const NodeId> cut, std::span<const double> weights) {
  Mesh mesh;
  static_cast<Surroundings&>(mesh) = graph;
  const std::vector<GroupId> group_of = weights.empty() ? std::vector<GroupId>{} : groups_of_nodes(graph.graph);
  for (const NodeId n : cut) {
    append_triangles(graph, n, mesh.vertices.size(), mesh);
    morph(graph, n, weights.empty() ? 0.0 : weights[group_of[n]], mesh.vertices);
  }
  return mesh;
}

Mesh extract(const ClusterGraph& graph, std::span<const NodeId> cut) { return extract_morphed(graph, cut, {}); }

std::vector<GroupId> groups_of_nodes(const LodGraph& graph) {
  std::vector<GroupId> group_of(graph.nodes.size(), 0);
  for (GroupId g = 0; g < graph.groups.size(); ++g) {
    const Range nodes = graph.groups[g].nodes;
    std::fill(group_of.begin() + nodes.begin, group_of.begin() + nodes.end, g);
  }
  return group_of;
}

}  // namespace lodestone
