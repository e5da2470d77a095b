// SPDX-License-Identifier: MIT
#include "clusters/output.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lodestone::clusters {
namespace {

Sphere sphere_around(std::span<const glm::vec3> places) {
  Box box;
  for (const glm::vec3& p : places) box.add(glm::dvec3{p});
  Sphere sphere{box.center(), 0.0};
  for (const glm::vec3& p : places) {
    sphere.radius_m = std::max(sphere.radius_m, glm::length(glm::dvec3{p} - sphere.center));
  }
  return sphere;
}

}  // namespace

std::uint32_t Output::add_cluster(std::span<const LiveFace> faces, const VertexArrays& values, std::uint32_t level,
                                  GroupId maker) {
  if (place_.empty()) place_.assign(values.size(), none);
  VertexArrays& out = result_.vertices;
  Cluster cluster;
  cluster.level = level;
  cluster.vertices.begin = out.size();
  cluster.triangles.begin = static_cast<std::uint32_t>(result_.indices.size() / 3);
  cluster.sections.begin = static_cast<std::uint32_t>(result_.sections.size());
  for (const LiveFace& f : faces) {
    const auto triangle = static_cast<std::uint32_t>(result_.indices.size() / 3);
    const MaterialId material = source_.face_material(f.id);
    if (triangle == cluster.triangles.begin || result_.sections.back().material != material) {
      result_.sections.push_back({material, {triangle, triangle}});
    }
    result_.sections.back().triangles.end = triangle + 1;
    if (!source_.face_features.empty()) result_.face_features.push_back(source_.face_features[f.id]);
    for (const VertexId v : f.vertex) {
      if (place_[v] == none) {
        place_[v] = out.size();
        vertex_of_.push_back(v);
        result_.morph_targets.push_back(out.size());
        out.positions.push_back(values.positions[v]);
        if (!values.normals.empty()) out.normals.push_back(values.normals[v]);
        if (!values.uvs.empty()) out.uvs.push_back(values.uvs[v]);
        if (!values.colors.empty()) out.colors.push_back(values.colors[v]);
      }
      assert(place_[v] - cluster.vertices.begin <= 255);
      result_.indices.push_back(static_cast<std::uint8_t>(place_[v] - cluster.vertices.begin));
    }
  }
  cluster.vertices.end = out.size();
  cluster.triangles.end = static_cast<std::uint32_t>(result_.indices.size() / 3);
  cluster.sections.end = static_cast<std::uint32_t>(result_.sections.size());
  for (std::uint32_t i = cluster.vertices.begin; i != cluster.vertices.end; ++i) place_[vertex_of_[i]] = none;
  const Sphere bounds = sphere_around({out.positions.data() + cluster.vertices.begin, cluster.vertices.size()});
  nodes_.push_back({bounds, cluster.triangles.size(), none, maker});
  clusters_.push_back(cluster);
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

void Output::set_bounds(GroupId group, double error_m, const std::vector<std::uint32_t>& members,
                        const std::vector<std::uint32_t>& made) {
  Box box;
  for (const auto* list : {&members, &made}) {
    for (const std::uint32_t m : *list) {
      box.add(nodes_[m].bounds.center - nodes_[m].bounds.radius_m);
      box.add(nodes_[m].bounds.center + nodes_[m].bounds.radius_m);
    }
  }
  groups_[group] = {{box.center(), 0.0}, error_m};
}

Result<ClusterGraph> Output::finish() {
  auto assembled = assemble_graph(groups_, nodes_);
  if (!assembled.ok()) return assembled.error();
  static_cast<Surroundings&>(result_) = source_;
  result_.graph = std::move(assembled->graph);
  std::vector<NodeId> node_of(nodes_.size());
  for (NodeId n = 0; n < node_of.size(); ++n) {
    const std::uint32_t draft = assembled->node_draft[n];
    node_of[draft] = n;
    result_.clusters.push_back(clusters_[draft]);
  }
  for (const auto& [draft, cause] : causes_) result_.roots.push_back({node_of[draft], cause});
  std::sort(result_.roots.begin(), result_.roots.end(),
            [](const ClusterRoot& a, const ClusterRoot& b) { return a.node < b.node; });
  return std::move(result_);
}

}  // namespace lodestone::clusters
