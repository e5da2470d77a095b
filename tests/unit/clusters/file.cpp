// SPDX-License-Identifier: MIT
#include <lodestone/cluster_file.h>
#include <lodestone/formats.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "cut_support.h"
#include "data.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

std::vector<char> bytes_of(const std::filesystem::path& file) {
  std::ifstream in{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

void store(const std::filesystem::path& file, const std::vector<char>& bytes) {
  std::ofstream{file, std::ios::binary}.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

ClusterGraph graph_of(const Mesh& mesh) {
  auto graph = build_cluster_graph(mesh);
  REQUIRE(graph.ok());
  return std::move(graph).value();
}

Mesh coloured(Mesh mesh) {
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    mesh.vertices.colors.emplace_back(v % 251, 7 * v % 256, 100, 255);
  }
  return mesh;
}

}  // namespace

TEST_CASE("a graph read back keeps its promises, its borders and its shape") {
  const auto folder = scratch_folder("cluster_file");
  for (const NamedMesh& model :
       {NamedMesh{"closed", sphere(40, 60)}, NamedMesh{"seamed", seamed_grid(60, 60)},
        NamedMesh{"coloured", coloured(grid(50, 50))}, NamedMesh{"unwelded", unwelded(sphere(20, 30))}}) {
    INFO(model.name);
    const ClusterGraph graph = graph_of(model.mesh);
    const auto size = write_cluster_graph(graph, folder / "a.lodg");
    REQUIRE(size.ok());
    REQUIRE(size->page_bytes_max <= 128 * 1024);
    REQUIRE(is_cluster_file(folder / "a.lodg"));
    REQUIRE(size->file_bytes == std::filesystem::file_size(folder / "a.lodg"));
    const auto back = read_cluster_graph(folder / "a.lodg");
    REQUIRE(back.ok());
    REQUIRE(validate(back->graph).ok());
    CHECK(changed_border_edges(*back) == 0);
    const FaultCounts faults = try_cuts(*back, 10, 3);
    CHECK(faults.cracks == 0);
    CHECK(faults.morphed_cracks == 0);
    REQUIRE(back->clusters.size() == graph.clusters.size());
    const double cell_m = bounds(model.mesh).diagonal_m() / 65535.0;
    for (NodeId n = 0; n < graph.clusters.size(); ++n) {
      const Cluster& a = graph.clusters[n];
      const Cluster& b = back->clusters[n];
      REQUIRE(a.vertices.size() == b.vertices.size());
      for (std::uint32_t i = 0; i < a.vertices.size(); ++i) {
        const std::uint32_t va = a.vertices.begin + i;
        const std::uint32_t vb = b.vertices.begin + i;
        const auto near = [&](std::uint32_t x, std::uint32_t y) {
          return glm::length(graph.vertices.positions[x] - back->vertices.positions[y]) < cell_m;
        };
        REQUIRE(near(va, vb));
        REQUIRE(near(graph.morph_targets[va], back->morph_targets[vb]));
        if (!graph.vertices.normals.empty()) {
          REQUIRE(glm::dot(graph.vertices.normals[va], back->vertices.normals[vb]) > 0.999F);
        }
        if (!graph.vertices.uvs.empty()) {
          REQUIRE(glm::length(graph.vertices.uvs[va] - back->vertices.uvs[vb]) < 1e-4F);
        }
        if (!graph.vertices.colors.empty()) REQUIRE(graph.vertices.colors[va] == back->vertices.colors[vb]);
      }
      for (std::uint32_t i = 0; i < 3 * a.triangles.size(); ++i) {
        REQUIRE(graph.indices[3 * a.triangles.begin + i] == back->indices[3 * b.triangles.begin + i]);
      }
    }
  }
}

TEST_CASE("promises hold in the file far from the origin, also for cameras on the line of centres") {
  const auto folder = scratch_folder("cluster_file_far");
  for (const float offset_m : {300.0F, 5'000.0F, 500'000.0F}) {
    Mesh mesh = grid(60, 60);
    for (glm::vec3& p : mesh.vertices.positions) p += glm::vec3{offset_m, 0.5F * offset_m, 0.25F * offset_m};
    REQUIRE(write_cluster_graph(graph_of(mesh), folder / "a.lodg").ok());
    const auto file = ClusterFile::open(folder / "a.lodg");
    INFO(offset_m);
    REQUIRE(file.ok());
    const LodGraph& graph = (*file)->graph();
    for (const LodGroup& group : graph.groups) {
      for (std::uint32_t l = group.links.begin; l != group.links.end; ++l) {
        if (graph.links[l].maker == none || std::isinf(group.error_m)) continue;
        const LodGroup& finer = graph.groups[graph.links[l].maker];
        const glm::dvec3 apart = finer.bounds.center - group.bounds.center;
        const glm::dvec3 line = glm::length(apart) > 0.0 ? glm::normalize(apart) : glm::dvec3{0.0, 0.0, 1.0};
        for (const double reach : {0.5, 1.0, 1.0 + 1e-9, 1.001, 2.0, 1e3}) {
          View view;
          view.eye = finer.bounds.center + line * (reach * finer.bounds.radius_m);
          REQUIRE(error_px(view, group.error_m, group.bounds) > error_px(view, finer.error_m, finer.bounds));
        }
      }
    }
  }
}

TEST_CASE("the same file is written again, byte for byte, also from what was read") {
  const auto folder = scratch_folder("cluster_file_again");
  const ClusterGraph graph = graph_of(grid(60, 60));
  REQUIRE(write_cluster_graph(graph, folder / "a.lodg").ok());
  REQUIRE(write_cluster_graph(graph, folder / "b.lodg").ok());
  REQUIRE(bytes_of(folder / "a.lodg") == bytes_of(folder / "b.lodg"));
  REQUIRE_FALSE(write_cluster_graph(graph, folder / "c.lodg", {.position_bits = 40}).ok());
  REQUIRE_FALSE(std::filesystem::exists(folder / "c.lodg"));
}

TEST_CASE("embedded textures travel along; a .lodg file reads as a mesh: its leaves, welded again") {
  const auto folder = scratch_folder("cluster_file_mesh");
  Mesh mesh = grid(30, 30);
  mesh.materials = {Material{.name = "rock", .texture = 0}};
  const auto bytes = std::make_shared<const std::vector<std::uint8_t>>(1000, std::uint8_t{7});
  mesh.textures.push_back({.name = "rock.png", .mime_type = "image/png", .encoded = bytes});
  REQUIRE(write_cluster_graph(graph_of(mesh), folder / "a.lodg", {.position_bits = 20}).ok());
  const auto loaded = read_mesh(folder / "a.lodg");
  REQUIRE(loaded.ok());
  REQUIRE(loaded->mesh.triangle_count() == mesh.triangle_count());
  REQUIRE(loaded->mesh.vertex_count() == mesh.vertex_count());
  REQUIRE(*loaded->mesh.textures.at(0).encoded == *bytes);
  std::filesystem::resize_file(folder / "a.lodg", std::filesystem::file_size(folder / "a.lodg") - 1);
  REQUIRE_FALSE(read_mesh(folder / "a.lodg").ok());
}

TEST_CASE("every truncation and every flipped byte is an error, never a crash") {
  const auto folder = scratch_folder("cluster_file_broken");
  const ClusterGraph graph = graph_of(grid(24, 24));
  REQUIRE(write_cluster_graph(graph, folder / "good.lodg").ok());
  const std::vector<char> good = bytes_of(folder / "good.lodg");
  for (std::size_t size = 0; size < good.size(); size += 1 + size / 16) {
    store(folder / "bad.lodg", {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)});
    REQUIRE_FALSE(read_cluster_graph(folder / "bad.lodg").ok());
  }
  for (std::size_t at = 0; at < good.size(); at += 1 + at / 24) {
    std::vector<char> bad = good;
    bad[at] = static_cast<char>(bad[at] ^ (1 << (at % 8)));
    store(folder / "bad.lodg", bad);
    INFO("byte " << at);
    REQUIRE_FALSE(read_cluster_graph(folder / "bad.lodg").ok());
  }
  std::vector<char> newer = good;
  newer[8] = 2;
  store(folder / "bad.lodg", newer);
  REQUIRE(read_cluster_graph(folder / "bad.lodg").error().code == ErrorCode::Unsupported);
  REQUIRE(read_cluster_graph(folder / "none.lodg").error().code == ErrorCode::NotFound);
}

TEST_CASE("whatever has been streamed in, cuts stay whole, and they end at the wanted detail") {
  const auto folder = scratch_folder("cluster_stream");
  REQUIRE(write_cluster_graph(graph_of(grid(130, 130)), folder / "a.lodg").ok());
  const auto file = ClusterFile::open(folder / "a.lodg");
  REQUIRE(file.ok());
  const auto whole = read_cluster_graph(folder / "a.lodg");
  REQUIRE(whole.ok());
  const std::vector<std::uint8_t> border = true_border(*whole);
  REQUIRE((*file)->graph().page_count >= 3);
  ClusterStreamer streamer{*file, {.budget_bytes = 300'000}};
  CutScratch scratch;
  std::vector<NodeId> cut;
  Rng rng{5};
  for (int camera = 0; camera < 6; ++camera) {
    const View view = random_view(rng, (*file)->graph().groups[0].bounds);
    for (int frame = 0; frame < 12; ++frame) {
      const CutOptions options{.error_px = 0.25, .culling = Culling::None, .resident = streamer.resident()};
      select_cut((*file)->graph(), view, options, scratch, cut);
      for (const NodeId n : cut) REQUIRE(streamer.page((*file)->page_of(n)) != nullptr);
      streamer.update(scratch);
      // What is drawn stays, however small the budget.
      for (const NodeId n : cut) REQUIRE(streamer.page((*file)->page_of(n)) != nullptr);
      if (frame % 3 != 2) streamer.wait();
    }
    REQUIRE(find_faults(*whole, cut, extract(*whole, cut), border).cracks == 0);
  }
  ClusterStreamer roomy{*file};
  const View near = random_view(rng, (*file)->graph().groups[0].bounds);
  for (int frame = 0; frame < 30; ++frame) {
    const CutOptions options{.error_px = 0.01, .culling = Culling::None, .resident = roomy.resident()};
    select_cut((*file)->graph(), near, options, scratch, cut);
    roomy.update(scratch);
    roomy.wait();
  }
  REQUIRE(scratch.missing().empty());
}

TEST_CASE("a broken page is asked for once, and coarser nodes stand in for it") {
  const auto folder = scratch_folder("cluster_stream_broken");
  REQUIRE(write_cluster_graph(graph_of(grid(130, 130)), folder / "a.lodg").ok());
  std::vector<char> bytes = bytes_of(folder / "a.lodg");
  bytes[bytes.size() - 10] = static_cast<char>(bytes[bytes.size() - 10] ^ 1);
  store(folder / "bad.lodg", bytes);
  const auto file = ClusterFile::open(folder / "bad.lodg");
  REQUIRE(file.ok());
  ClusterStreamer streamer{*file};
  CutScratch scratch;
  std::vector<NodeId> cut;
  Rng rng{5};
  const View view = random_view(rng, (*file)->graph().groups[0].bounds);
  for (int frame = 0; frame < 30; ++frame) {
    const CutOptions options{.error_px = 0.001, .culling = Culling::None, .resident = streamer.resident()};
    select_cut((*file)->graph(), view, options, scratch, cut);
    streamer.update(scratch);
    streamer.wait();
  }
  REQUIRE(streamer.broken_pages() == 1);
  REQUIRE_FALSE(scratch.missing().empty());
  for (const NodeId n : cut) REQUIRE(streamer.page((*file)->page_of(n)) != nullptr);
}

}  // namespace lodestone::test
