// SPDX-License-Identifier: MIT
#include "tidy.h"

#include <algorithm>
#include <cmath>

#include <lodestone/repair.h>

#include "strays.h"

namespace lodestone {
namespace {

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

template <class Keep>
void keep_faces(Mesh& mesh, const Keep& keep) {
  std::size_t to = 0;
  const std::size_t count = mesh.triangle_count();
  for (std::size_t f = 0; f < count; ++f) {
    if (!keep(f)) continue;
    std::copy_n(&mesh.indices[3 * f], 3, &mesh.indices[3 * to]);
    if (!mesh.face_materials.empty()) mesh.face_materials[to] = mesh.face_materials[f];
    if (!mesh.face_features.empty()) mesh.face_features[to] = mesh.face_features[f];
    ++to;
  }
  mesh.indices.resize(3 * to);
  if (!mesh.face_materials.empty()) mesh.face_materials.resize(to);
  if (!mesh.face_features.empty()) mesh.face_features.resize(to);
}

void drop_bad_indices(Mesh& mesh, Warnings& warnings) {
  const std::uint32_t count = mesh.vertex_count();
  const std::uint32_t before = mesh.triangle_count();
  mesh.indices.resize(3 * std::size_t{before});
  keep_faces(mesh, [&](std::size_t f) {
    return mesh.indices[3 * f] < count && mesh.indices[3 * f + 1] < count && mesh.indices[3 * f + 2] < count;
  });
  if (mesh.triangle_count() < before) {
    warnings.add("faces that name a vertex that does not exist were left out: " +
                 std::to_string(before - mesh.triangle_count()));
  }
}

void drop_bad_positions(Mesh& mesh, Warnings& warnings) {
  const auto& p = mesh.vertices.positions;
  if (std::all_of(p.begin(), p.end(), finite)) return;
  const std::uint32_t before = mesh.triangle_count();
  keep_faces(mesh, [&](std::size_t f) {
    return finite(p[mesh.indices[3 * f]]) && finite(p[mesh.indices[3 * f + 1]]) && finite(p[mesh.indices[3 * f + 2]]);
  });
  if (mesh.triangle_count() < before) {
    warnings.add("faces with a corner that is not a finite number were left out: " +
                 std::to_string(before - mesh.triangle_count()));
  }
  for (auto& v : mesh.vertices.positions) {
    if (!finite(v)) v = glm::vec3{0.0F};  // no face uses it any more
  }
}

// One number like 1e30 would be all that boxes, errors and cameras see.
void drop_strays(Mesh& mesh, Warnings& warnings) {
  const auto reaches_far = [](const glm::vec3& v) {
    return glm::any(glm::greaterThan(glm::abs(glm::dvec3{v}), glm::dvec3{near_enough}));
  };
  auto& p = mesh.vertices.positions;
  if (std::none_of(p.begin(), p.end(), reaches_far)) return;
  const Whereabouts whereabouts = whereabouts_of({p.begin(), p.end()});
  const auto holds = [&](VertexId v) { return whereabouts.hold(glm::dvec3{p[v]}); };
  const std::uint32_t before = mesh.triangle_count();
  keep_faces(mesh, [&](std::size_t f) {
    return holds(mesh.indices[3 * f]) && holds(mesh.indices[3 * f + 1]) && holds(mesh.indices[3 * f + 2]);
  });
  if (mesh.triangle_count() < before) {
    warnings.add("faces with a corner more than 10,000 km from most others were left out: " +
                 std::to_string(before - mesh.triangle_count()));
  }
  for (auto& v : p) {
    if (!whereabouts.hold(glm::dvec3{v})) v = glm::vec3{whereabouts.middle};  // no face uses it any more
  }
}

// Area-weighted over the faces of the vertex; those of length 0 only. Sums are in double, in face order.
void fill_normals(Mesh& mesh, const std::vector<bool>& missing) {
  std::vector<glm::dvec3> sums(mesh.vertex_count(), glm::dvec3{0.0});
  const auto& p = mesh.vertices.positions;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const VertexId* v = &mesh.indices[i];
    if (!missing[v[0]] && !missing[v[1]] && !missing[v[2]]) continue;
    const glm::dvec3 n =
        glm::cross(glm::dvec3{p[v[1]]} - glm::dvec3{p[v[0]]}, glm::dvec3{p[v[2]]} - glm::dvec3{p[v[0]]});
    for (int c = 0; c < 3; ++c) sums[v[c]] += n;
  }
  for (std::size_t v = 0; v < missing.size(); ++v) {
    if (!missing[v]) continue;
    const double length = glm::length(sums[v]);
    mesh.vertices.normals[v] = length > 0.0 ? glm::vec3{sums[v] / length} : glm::vec3{0.0F, 0.0F, 1.0F};
  }
}

void tidy_normals(Mesh& mesh) {
  std::vector<bool> missing(mesh.vertices.normals.size(), false);
  bool any_missing = false;
  for (std::size_t v = 0; v < missing.size(); ++v) {
    glm::vec3& n = mesh.vertices.normals[v];
    const float length = finite(n) ? glm::length(n) : 0.0F;
    if (!std::isfinite(length) || !(length > 1e-12F)) {
      missing[v] = true;
      any_missing = true;
    } else if (std::abs(length - 1.0F) > 1e-3F) {  // rounded text stays as it is, bit for bit
      n = glm::vec3{glm::normalize(glm::dvec3{n})};
    }
  }
  if (any_missing) fill_normals(mesh, missing);
}

// A face with a corner that has no place in its image would be a smear of it.
void plain_faces_without_uv(Mesh& mesh, Warnings& warnings) {
  std::vector<bool> bad(mesh.vertices.uvs.size(), false);
  bool any = false;
  for (std::size_t v = 0; v < bad.size(); ++v) {
    glm::vec2& uv = mesh.vertices.uvs[v];
    if (std::isfinite(uv.x) && std::isfinite(uv.y)) continue;
    uv = glm::vec2{0.0F};
    bad[v] = any = true;
    warnings.add("a texture coordinate is not a finite number, its faces stay plain");
  }
  if (!any) return;
  std::vector<bool> faces(mesh.triangle_count());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    faces[f] = bad[mesh.indices[3 * f]] || bad[mesh.indices[3 * f + 1]] || bad[mesh.indices[3 * f + 2]];
  }
  leave_plain(mesh, faces);
}

}  // namespace

void tidy(Mesh& mesh, Warnings& warnings) {
  drop_bad_indices(mesh, warnings);
  drop_bad_positions(mesh, warnings);
  drop_strays(mesh, warnings);
  tidy_normals(mesh);
  if (mesh.materials.empty()) {
    Material material;
    material.name = "default";
    mesh.materials.push_back(std::move(material));
  }
  plain_faces_without_uv(mesh, warnings);
}

}  // namespace lodestone
