// SPDX-License-Identifier: MIT
// From triangles in memory to a progressive model and a file: makes a round tower, builds its levels, prints them.
//
//     build_tower tower.lode
#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

using namespace lodestone;

// One turn of vertices; the wall bulges a little at every course of stone.
void add_ring(Mesh& mesh, std::uint32_t segments, double radius_m, double height_m) {
  for (std::uint32_t i = 0; i < segments; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / segments;
    mesh.vertices.positions.emplace_back(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), height_m);
  }
}

// A mesh needs positions, indices and one material; everything else is optional.
Mesh make_tower(std::uint32_t segments, std::uint32_t courses) {
  Mesh mesh;
  mesh.materials.push_back({.name = "stone", .base_color = {0.8F, 0.75F, 0.65F, 1.0F}});
  const double course_m = 0.25;
  for (std::uint32_t ring = 0; ring <= courses; ++ring) {
    const double bulge_m = ring % 2 == 0 ? 0.0 : 0.04;
    add_ring(mesh, segments, 3.0 + bulge_m, course_m * ring);
  }
  for (std::uint32_t ring = 0; ring < courses; ++ring) {
    for (std::uint32_t i = 0; i < segments; ++i) {
      const VertexId a = ring * segments + i;
      const VertexId b = ring * segments + (i + 1) % segments;
      mesh.indices.insert(mesh.indices.end(), {a, b, b + segments, a, b + segments, a + segments});
    }
  }
  const VertexId top = mesh.vertex_count();
  const VertexId rim = courses * segments;
  mesh.vertices.positions.emplace_back(0.0F, 0.0F, course_m * courses + 4.0);
  for (std::uint32_t i = 0; i < segments; ++i) {
    mesh.indices.insert(mesh.indices.end(), {rim + i, rim + (i + 1) % segments, top});
  }
  compute_normals(mesh);
  return mesh;
}

int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", to_line(error).c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: build_tower OUT.lode\n", stderr);
    return 1;
  }
  const Mesh tower = make_tower(96, 48);
  const auto built = build_by_edge_collapse(tower);
  if (!built) return fail(built.error());
  const ProgressiveModel& model = *built->model;

  for (const double ratio : {1.0, 0.3, 0.1, 0.03, 0.01}) {
    const LevelInfo level =
        model.info(model.level_of_triangles(static_cast<std::uint32_t>(ratio * tower.triangle_count())));
    std::printf("level %6u: %6u triangles, at most %.3f m from the source\n", level.level, level.triangles,
                level.error_m);
  }
  const auto bytes = write_model(model, argv[1]);
  if (!bytes) return fail(bytes.error());
  std::printf("%s: %llu bytes\n", argv[1], static_cast<unsigned long long>(*bytes));
  return 0;
}
