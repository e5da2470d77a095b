// SPDX-License-Identifier: MIT
#include "support.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include "shapes.h"

namespace lodestone::test {
namespace {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_vertices(const VertexArrays& a, const VertexArrays& b) {
  return same_bits(a.positions, b.positions) && same_bits(a.normals, b.normals) && same_bits(a.uvs, b.uvs) &&
         same_bits(a.colors, b.colors);
}

}  // namespace

Model build(const Mesh& mesh, Placement placement) {
  auto result = build_by_edge_collapse(mesh, {.placement = placement});
  REQUIRE(result.ok());
  return result->model;
}

Model rich_model() {
  Mesh mesh = seamed_grid(24, 20);
  mesh.origin = {677000.5, 5403000.25, 370.0};
  mesh.crs = "EPSG:25832";
  mesh.features = {{"building", "Building", none}, {"wall", "WallSurface", 0}, {"window", "Window", 1}};
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) mesh.face_features.push_back(f % 7 == 0 ? none : (f / 97) % 3);
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    mesh.vertices.colors.emplace_back(v & 0xFFU, (v * 3) & 0xFFU, 200, 255);
    const glm::vec3 n{0.1F * std::sin(static_cast<float>(v)), 0.05F, 1.0F};
    mesh.vertices.normals.push_back(n / glm::length(n));
  }
  return build(mesh, Placement::Optimal);
}

Bytes slurp(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  return Bytes(std::istreambuf_iterator<char>{stream}, {});
}

void spill(const std::filesystem::path& file, const Bytes& bytes) {
  std::ofstream stream{file, std::ios::binary | std::ios::trunc};
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

Bytes written(const ProgressiveModel& model, const std::filesystem::path& file, const ModelWriteOptions& options) {
  const auto bytes = write_model(model, file, options);
  REQUIRE(bytes.ok());
  REQUIRE(*bytes == std::filesystem::file_size(file));
  return slurp(file);
}

bool same_data(const ModelData& a, const ModelData& b) {
  return same_vertices(a.vertices, b.vertices) && a.base_vertex_count == b.base_vertex_count &&
         a.face_begin == b.face_begin && a.base_face_counts == b.base_face_counts && a.base_indices == b.base_indices &&
         a.face_features == b.face_features && a.shapes == b.shapes && a.corner_bytes == b.corner_bytes &&
         a.fan_corners == b.fan_corners && a.fan_materials == b.fan_materials && a.edits == b.edits &&
         a.value_xor == b.value_xor && a.errors == b.errors && a.method == b.method && a.origin == b.origin &&
         a.crs == b.crs && a.materials.size() == b.materials.size() && a.textures.size() == b.textures.size() &&
         a.features.size() == b.features.size() && a.named_levels.size() == b.named_levels.size();
}

bool same_mesh(const Mesh& a, const Mesh& b) {
  return same_vertices(a.vertices, b.vertices) && a.indices == b.indices && a.face_materials == b.face_materials &&
         a.face_features == b.face_features;
}

}  // namespace lodestone::test
