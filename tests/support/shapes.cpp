// SPDX-License-Identifier: MIT
#include "shapes.h"

#include <cmath>
#include <numbers>
#include <random>

namespace lodestone::test {
namespace {

Mesh with_material(Mesh mesh) {
  mesh.materials.push_back(Material{.name = "stone"});
  return mesh;
}

void add_face(Mesh& mesh, VertexId a, VertexId b, VertexId c) { mesh.indices.insert(mesh.indices.end(), {a, b, c}); }

}  // namespace

Mesh tetrahedron() {
  Mesh mesh = with_material({});
  mesh.vertices.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  return mesh;
}

Mesh cube() {
  Mesh mesh = with_material({});
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.positions.emplace_back((i & 1) != 0 ? 1.0F : -1.0F, (i & 2) != 0 ? 1.0F : -1.0F,
                                         (i & 4) != 0 ? 1.0F : -1.0F);
  }
  mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return mesh;
}

Mesh sphere(std::uint32_t rings, std::uint32_t segments) {
  Mesh mesh = with_material({});
  auto& p = mesh.vertices.positions;
  p.emplace_back(0.0F, 0.0F, 1.0F);
  for (std::uint32_t r = 1; r < rings; ++r) {
    const double theta = std::numbers::pi * r / rings;
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double phi = 2.0 * std::numbers::pi * s / segments;
      p.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    }
  }
  p.emplace_back(0.0F, 0.0F, -1.0F);
  mesh.vertices.normals = p;
  const auto at = [&](std::uint32_t r, std::uint32_t s) { return 1 + (r - 1) * segments + s % segments; };
  const auto south = static_cast<VertexId>(p.size() - 1);
  for (std::uint32_t s = 0; s < segments; ++s) {
    add_face(mesh, 0, at(1, s), at(1, s + 1));
    for (std::uint32_t r = 1; r + 1 < rings; ++r) {
      add_face(mesh, at(r, s), at(r + 1, s), at(r + 1, s + 1));
      add_face(mesh, at(r, s), at(r + 1, s + 1), at(r, s + 1));
    }
    add_face(mesh, south, at(rings - 1, s + 1), at(rings - 1, s));
  }
  return mesh;
}

Mesh grid(std::uint32_t nx, std::uint32_t ny, float height_m) {
  Mesh mesh = with_material({});
  for (std::uint32_t y = 0; y <= ny; ++y) {
    for (std::uint32_t x = 0; x <= nx; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(nx);
      const float v = static_cast<float>(y) / static_cast<float>(ny);
      mesh.vertices.positions.emplace_back(u, v, height_m * std::sin(9.0F * u) * std::cos(7.0F * v));
      mesh.vertices.uvs.emplace_back(u, v);
    }
  }
  for (std::uint32_t y = 0; y < ny; ++y) {
    for (std::uint32_t x = 0; x < nx; ++x) {
      const VertexId a = y * (nx + 1) + x;
      const VertexId b = a + 1;
      const VertexId c = a + nx + 1;
      const VertexId d = c + 1;
      add_face(mesh, a, b, d);
      add_face(mesh, a, d, c);
    }
  }
  return mesh;
}

Mesh unwelded(const Mesh& mesh) {
  Mesh out = mesh;
  out.vertices = {};
  out.indices.clear();
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const auto& p = mesh.vertices.positions;
    const VertexId* v = &mesh.indices[3 * static_cast<std::size_t>(f)];
    const glm::vec3 n = glm::cross(p[v[1]] - p[v[0]], p[v[2]] - p[v[0]]);
    const float length = glm::length(n);
    for (int c = 0; c < 3; ++c) {
      out.indices.push_back(out.vertices.size());
      out.vertices.positions.push_back(p[v[c]]);
      out.vertices.normals.push_back(length > 0.0F ? n / length : glm::vec3{0.0F, 0.0F, 1.0F});
      if (!mesh.vertices.uvs.empty()) out.vertices.uvs.push_back(mesh.vertices.uvs[v[c]]);
    }
  }
  return out;
}

Mesh seamed_grid(std::uint32_t nx, std::uint32_t ny) {
  Mesh mesh = grid(nx, ny);
  mesh.materials.push_back(Material{.name = "lichen"});
  // Faces right of the middle get their own vertices along the middle column, with a shifted uv.
  std::vector<VertexId> twin(mesh.vertex_count(), none);
  const float middle = 0.5F;
  mesh.face_materials.assign(mesh.triangle_count(), 0);
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    float x = 0.0F;
    for (int c = 0; c < 3; ++c) x += mesh.vertices.positions[mesh.indices[3 * f + c]].x / 3.0F;
    if (x < middle) continue;
    mesh.face_materials[f] = mesh.vertices.positions[mesh.indices[3 * f]].y > 0.5F ? 1 : 0;
    for (int c = 0; c < 3; ++c) {
      const VertexId v = mesh.indices[3 * f + c];
      if (twin[v] == none) {
        twin[v] = mesh.vertex_count();
        mesh.vertices.positions.push_back(glm::vec3{mesh.vertices.positions[v]});
        mesh.vertices.uvs.push_back(mesh.vertices.uvs[v] + glm::vec2{3.0F, -2.0F});
      }
      mesh.indices[3 * f + c] = twin[v];
    }
  }
  remove_unused(mesh);
  return mesh;
}

Mesh fins(std::uint32_t fins) {
  Mesh mesh = with_material({});
  constexpr std::uint32_t steps = 8;
  for (std::uint32_t z = 0; z <= steps; ++z)
    mesh.vertices.positions.emplace_back(0.0F, 0.0F, 0.25F * static_cast<float>(z));
  for (std::uint32_t i = 0; i < fins; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / fins;
    const VertexId first = mesh.vertex_count();
    for (std::uint32_t z = 0; z <= steps; ++z) {
      mesh.vertices.positions.emplace_back(std::cos(angle), std::sin(angle), 0.25 * z + 0.05 * std::sin(3.0 * z + i));
    }
    for (std::uint32_t z = 0; z < steps; ++z) {
      add_face(mesh, z, first + z, first + z + 1);
      add_face(mesh, z, first + z + 1, z + 1);
    }
  }
  return mesh;
}

Mesh scattered_cubes(std::uint32_t count, std::uint64_t seed) {
  Mesh mesh = with_material({});
  std::mt19937_64 random{seed};
  const auto unit = [&] { return static_cast<float>(random() >> 11) * 0x1p-53F; };
  const Mesh one = cube();
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 at{100.0F * unit(), 100.0F * unit(), 10.0F * unit()};
    const float scale = 0.05F + unit();
    const VertexId first = mesh.vertex_count();
    for (const auto& p : one.vertices.positions) mesh.vertices.positions.push_back(at + scale * p);
    for (const VertexId v : one.indices) mesh.indices.push_back(first + v);
  }
  return mesh;
}

std::vector<NamedMesh> mesh_families() {
  std::vector<NamedMesh> all;
  all.push_back({"empty", with_material({})});
  Mesh single = with_material({});
  single.vertices.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  single.indices = {0, 1, 2};
  all.push_back({"single triangle", single});
  all.push_back({"tetrahedron", tetrahedron()});
  all.push_back({"cube", cube()});
  all.push_back({"sphere", sphere(24, 48)});
  all.push_back({"bordered grid", grid(24, 20)});
  all.push_back({"flat grid", grid(16, 16, 0.0F)});
  all.push_back({"seamed grid", seamed_grid(24, 20)});
  all.push_back({"unwelded sphere", unwelded(sphere(12, 20))});
  all.push_back({"unwelded grid", unwelded(grid(12, 12))});
  all.push_back({"fins", fins(5)});
  all.push_back({"scattered cubes", scattered_cubes(40, 7)});
  Mesh degenerate = grid(10, 10);
  for (FaceId f = 0; f < 20; ++f) degenerate.indices[3 * f + 1] = degenerate.indices[3 * f];
  for (FaceId f = 20; f < 30; ++f) {
    const VertexId a = degenerate.indices[3 * f];
    degenerate.vertices.positions[degenerate.indices[3 * f + 1]] = glm::vec3{degenerate.vertices.positions[a]};
  }
  all.push_back({"degenerate", degenerate});
  Mesh duplicate = sphere(10, 14);
  const auto faces = duplicate.indices;
  duplicate.indices.insert(duplicate.indices.end(), faces.begin(), faces.begin() + 60);
  for (std::size_t i = 60; i < 90; i += 3)
    duplicate.indices.insert(duplicate.indices.end(), {faces[i], faces[i + 2], faces[i + 1]});
  all.push_back({"duplicate faces", duplicate});
  return all;
}

}  // namespace lodestone::test
