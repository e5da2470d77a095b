// SPDX-License-Identifier: MIT
#include <lodestone/clusters.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "base/rng.h"
#include "cut_support.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

// A third of the faces on vertices of their own, as exporters write them that give each face its own uv.
Mesh partly_cut(Mesh mesh) {
  Rng rng{3};
  const std::uint32_t corners = 3 * mesh.triangle_count();
  for (std::uint32_t c = 0; c < corners; ++c) {
    if (mix64(c / 3) % 3 != 0) continue;
    const VertexId v = mesh.indices[c];
    mesh.indices[c] = mesh.vertices.size();
    mesh.vertices.positions.push_back(glm::vec3{mesh.vertices.positions[v]});
    if (!mesh.vertices.normals.empty()) mesh.vertices.normals.push_back(glm::vec3{mesh.vertices.normals[v]});
    if (!mesh.vertices.uvs.empty()) {
      mesh.vertices.uvs.push_back(mesh.vertices.uvs[v] + glm::vec2{static_cast<float>(rng.uniform(0.0, 0.3)), 0.0F});
    }
  }
  return mesh;
}

// Beside every fifth face one between its first two points, with a vertex of its own: it covers nothing.
Mesh with_collapsed_faces(Mesh mesh) {
  const std::uint32_t count = mesh.triangle_count();
  for (FaceId f = 0; f < count; f += 5) {
    const VertexId a = mesh.indices[3 * f];
    const VertexId b = mesh.indices[3 * f + 1];
    mesh.indices.insert(mesh.indices.end(), {a, b, mesh.vertices.size()});
    mesh.vertices.positions.push_back(glm::vec3{mesh.vertices.positions[b]});
    if (!mesh.vertices.normals.empty()) mesh.vertices.normals.push_back(glm::vec3{mesh.vertices.normals[b]});
    if (!mesh.vertices.uvs.empty()) mesh.vertices.uvs.push_back(glm::vec2{mesh.vertices.uvs[b]});
  }
  return mesh;
}

// Every third face a second time, turned over.
Mesh with_doubled_faces(Mesh mesh) {
  const std::uint32_t count = mesh.triangle_count();
  for (FaceId f = 0; f < count; f += 3) {
    const std::array<VertexId, 3> v{mesh.indices[3 * f], mesh.indices[3 * f + 1], mesh.indices[3 * f + 2]};
    mesh.indices.insert(mesh.indices.end(), {v[1], v[0], v[2]});
  }
  return mesh;
}

std::vector<NamedMesh> models() {
  return {{"closed", sphere(40, 60)},
          {"bordered with uv", grid(70, 70)},
          {"seams and two materials", seamed_grid(60, 60)},
          {"a third of the faces cut loose", partly_cut(grid(60, 60))},
          {"faces between two points", with_collapsed_faces(grid(50, 50))},
          {"faces twice", with_doubled_faces(sphere(40, 60))},
          {"unwelded", unwelded(sphere(30, 40))},
          {"many parts", scattered_cubes(300, 1)}};
}

using Triangle = std::array<std::array<float, 3>, 3>;

std::multimap<Triangle, MaterialId> triangles_of(const Mesh& mesh) {
  std::multimap<Triangle, MaterialId> result;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    Triangle t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& p = mesh.vertices.positions[mesh.indices[3 * f + k]];
      t[k] = {p.x, p.y, p.z};
    }
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    result.emplace(t, mesh.face_material(f));
  }
  return result;
}

}  // namespace

TEST_CASE("any model: valid graph, no crack in any cut, borders of all groups kept, morphed or not") {
  for (const NamedMesh& model : models()) {
    INFO(model.name);
    const auto graph = build_cluster_graph(model.mesh);
    REQUIRE(graph.ok());
    REQUIRE(validate(graph->graph).ok());
    CHECK(changed_border_edges(*graph) == 0);
    const FaultCounts faults = try_cuts(*graph, 20, 7);
    CHECK(faults.cracks == 0);
    CHECK(faults.morphed_cracks == 0);
    CHECK(faults.different_cuts > 3);
  }
}

TEST_CASE("a thousand cameras and a hundred random labellings find no crack, pages missing or not, morphed or not") {
  const auto graph = build_cluster_graph(partly_cut(grid(50, 50)), {.max_triangles = 32, .group_clusters = 12});
  REQUIRE(graph.ok());
  REQUIRE(graph->levels.size() >= 6);
  const FaultCounts seen = try_cuts(*graph, 1000, 17);
  CHECK(seen.cracks == 0);
  CHECK(seen.morphed_cracks == 0);
  CHECK(seen.different_cuts > 50);
  const FaultCounts labelled = try_labellings(*graph, 100, 18);
  CHECK(labelled.cracks == 0);
  CHECK(labelled.morphed_cracks == 0);
  CHECK(labelled.different_cuts > 20);
}

TEST_CASE("the leaves are the source, triangle for triangle") {
  for (const NamedMesh& model : models()) {
    INFO(model.name);
    const auto graph = build_cluster_graph(model.mesh);
    REQUIRE(graph.ok());
    const Mesh finest = extract(*graph, leaves(*graph));
    REQUIRE(triangles_of(finest) == triangles_of(model.mesh));
  }
}

TEST_CASE("clusters are nearly full, halve from level to level and end in one root") {
  for (const NamedMesh& model : models()) {
    INFO(model.name);
    const auto graph = build_cluster_graph(model.mesh);
    REQUIRE(graph.ok());
    REQUIRE(graph->roots.size() == 1);
    CHECK(graph->roots[0].cause.empty());
    for (const Cluster& c : graph->clusters) {
      REQUIRE(c.triangles.size() <= 128);
      REQUIRE(!c.triangles.empty());
      REQUIRE(c.vertices.size() <= 255);
    }
    for (std::size_t i = 1; i < graph->levels.size(); ++i) {
      CHECK(graph->levels[i].triangles <= graph->levels[i - 1].triangles / 2 + 8);
      // Where every face has three vertices of its own, 255 vertices hold fewer.
      if (graph->levels[i].clusters >= 8)
        CHECK(graph->levels[i].mean_fill >= (model.name == "unwelded" ? 75.0 : 116.0));
      CHECK(graph->levels[i].error_m >= graph->levels[i - 1].error_m);
    }
    CHECK(graph->levels.back().clusters == 1);
  }
}

TEST_CASE("a group at the end of its morph lies where what it made lies") {
  const auto graph = build_cluster_graph(grid(60, 60));
  REQUIRE(graph.ok());
  std::vector<std::vector<NodeId>> made(graph->graph.groups.size());
  for (const LodLink& link : graph->graph.links) {
    for (NodeId n = link.nodes.begin; link.maker != none && n != link.nodes.end; ++n) made[link.maker].push_back(n);
  }
  for (GroupId g = 1; g < graph->graph.groups.size(); ++g) {
    std::vector<NodeId> fine;
    for (NodeId n = graph->graph.groups[g].nodes.begin; n != graph->graph.groups[g].nodes.end; ++n) fine.push_back(n);
    const std::vector<double> weights(graph->graph.groups.size(), 1.0);
    Mesh moved = extract_morphed(*graph, fine, weights);
    auto there = triangles_of(extract(*graph, made[g]));
    std::size_t found = 0;
    for (const auto& [triangle, material] : triangles_of(moved)) {
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      found += there.contains(triangle) ? 1U : 0U;
    }
    REQUIRE(found >= there.size());
  }
}

TEST_CASE("faces that cover nothing hold no group back") {
  const auto graph =
      build_cluster_graph(with_collapsed_faces(grid(60, 60)), {.max_triangles = 16, .group_clusters = 8});
  REQUIRE(graph.ok());
  REQUIRE(graph->roots.size() == 1);
  for (std::size_t i = 1; i < graph->levels.size(); ++i) {
    CHECK(graph->levels[i].triangles <= graph->levels[i - 1].triangles / 2 + 8);
  }
}

TEST_CASE("what two groups use stays as it is: place, normal and uv") {
  for (const Mesh& mesh : {sphere(60, 80), grid(60, 60)}) {
    const auto graph = build_cluster_graph(mesh, {.max_triangles = 32, .group_clusters = 8});
    REQUIRE(graph.ok());
    const std::vector<GroupId> group_of = groups_of_nodes(graph->graph);
    const VertexArrays& of = graph->vertices;
    std::map<std::array<float, 4>, std::set<GroupId>> groups_at;  // by level and place
    const auto key = [&](NodeId n, std::uint32_t v) {
      const glm::vec3& p = of.positions[v];
      return std::array<float, 4>{static_cast<float>(graph->clusters[n].level), p.x, p.y, p.z};
    };
    const auto for_each_vertex = [&](auto&& visit) {
      for (NodeId n = 0; n < graph->clusters.size(); ++n) {
        for (std::uint32_t v = graph->clusters[n].vertices.begin; v != graph->clusters[n].vertices.end; ++v)
          visit(n, v);
      }
    };
    for_each_vertex([&](NodeId n, std::uint32_t v) { groups_at[key(n, v)].insert(group_of[n]); });
    std::size_t shared = 0;
    std::size_t changed = 0;
    for_each_vertex([&](NodeId n, std::uint32_t v) {
      if (groups_at[key(n, v)].size() == 1) return;
      const VertexId to = graph->morph_targets[v];
      const bool same = of.positions[to] == of.positions[v] &&
                        (of.normals.empty() || of.normals[to] == of.normals[v]) &&
                        (of.uvs.empty() || of.uvs[to] == of.uvs[v]);
      ++shared;
      changed += same ? 0U : 1U;
    });
    CHECK(shared > 500);
    CHECK(changed == 0);
  }
}

TEST_CASE("locked borders do not move, and a morph of nothing changes nothing") {
  const auto graph = build_cluster_graph(sphere(40, 60));
  REQUIRE(graph.ok());
  for (NodeId n = 0; n < graph->clusters.size(); n += 7) {
    VertexArrays at_rest;
    VertexArrays half;
    morph(*graph, n, 0.0, at_rest);
    morph(*graph, n, 0.5, half);
    const Range range = graph->clusters[n].vertices;
    for (std::uint32_t i = 0; i < range.size(); ++i) {
      REQUIRE(at_rest.positions[i] == graph->vertices.positions[range.begin + i]);
      if (graph->morph_targets[range.begin + i] == range.begin + i) REQUIRE(half.positions[i] == at_rest.positions[i]);
      REQUIRE(std::abs(glm::length(half.normals[i]) - 1.0F) < 1e-3F);
    }
  }
}

TEST_CASE("the same graph comes out for 1, 2 and 8 threads") {
  const Mesh mesh = seamed_grid(80, 80);
  Context context;
  context.max_workers = 1;
  const auto one = build_cluster_graph(mesh, {}, context);
  REQUIRE(one.ok());
  for (const unsigned workers : {2U, 8U}) {
    context.max_workers = workers;
    const auto other = build_cluster_graph(mesh, {}, context);
    REQUIRE(other.ok());
    REQUIRE(other->vertices == one->vertices);
    REQUIRE(other->indices == one->indices);
    REQUIRE(other->morph_targets == one->morph_targets);
    REQUIRE(other->graph.groups.size() == one->graph.groups.size());
    for (std::size_t g = 0; g < one->graph.groups.size(); ++g) {
      REQUIRE(other->graph.groups[g].error_m == one->graph.groups[g].error_m);
    }
  }
}

TEST_CASE("families of odd meshes give a graph or one clear error") {
  for (const NamedMesh& family : mesh_families()) {
    INFO(family.name);
    const auto graph = build_cluster_graph(family.mesh);
    REQUIRE(graph.ok());
    REQUIRE(validate(graph->graph).ok());
    REQUIRE(extract(*graph, leaves(*graph)).triangle_count() == family.mesh.triangle_count());
    if (!family.mesh.indices.empty()) CHECK(try_cuts(*graph, 4, 1).cracks == 0);
  }
}

TEST_CASE("the paper's area error grows with the triangles") {
  const auto graph = build_cluster_graph(sphere(40, 60), {.error = ErrorMeasure::Area});
  REQUIRE(graph.ok());
  const double first = graph->levels[1].error_m;
  REQUIRE(graph->levels.back().error_m > 3.0 * first);
}

TEST_CASE("wrong options are refused and a raised flag cancels") {
  const Mesh mesh = grid(60, 60);
  REQUIRE_FALSE(build_cluster_graph(mesh, {.max_triangles = 300}).ok());
  REQUIRE_FALSE(build_cluster_graph(mesh, {.group_clusters = 2}).ok());
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  const auto cancelled = build_cluster_graph(mesh, {}, context);
  REQUIRE_FALSE(cancelled.ok());
  REQUIRE(cancelled.error().code == ErrorCode::Cancelled);
}

}  // namespace lodestone::test
