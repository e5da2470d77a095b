// SPDX-License-Identifier: MIT
// Based on: Ulrich 2002, "Rendering massive terrains using chunked level of detail control" (skirts).
// Differs: borders of rock differ sideways as well as in depth, so a skirt that hangs straight down would leave the gap
// open to who looks straight in. The coarser tile's slopes outwards under the finer one and meets its skirt there.
#include <lodestone/outcrop.h>

#include <algorithm>
#include <map>

#include "mesh/vertex_copy.h"
#include "mesh/weld.h"
#include "outcrop/borders.h"

namespace lodestone {

class SkirtMaker {
 public:
  SkirtMaker(const OutcropPyramid& pyramid, std::uint32_t tile, Mesh& mesh)
      : mesh_(mesh),
        info_(pyramid.tiles_[tile]),
        level_(pyramid.meshes_[info_.level]),
        borders_(&level_.face_borders[level_.first_face[tile - pyramid.first_tile_[info_.level]]]),
        faces_(mesh.triangle_count()),
        weld_(weld_by_position(mesh.vertices.positions)),
        ends_(weld_.point_count()) {}

  void make() {
    for_each_edge([&](FaceId f, VertexId a, VertexId b) { measure(f, a, b); });
    for_each_edge([&](FaceId f, VertexId a, VertexId b) { sew(f, a, b); });
  }

 private:
  // Of a point on the border.
  struct End {
    glm::dvec3 outwards{0.0};
    int edges = 0;
  };

  template <class Visit>
  void for_each_edge(Visit visit) {
    for (FaceId f = 0; f < faces_; ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        if ((borders_[f] >> k & 1U) == 0) continue;
        visit(f, mesh_.indices[3 * std::size_t{f} + k], mesh_.indices[3 * std::size_t{f} + (k + 1) % 3]);
      }
    }
  }

  void measure(FaceId f, VertexId a, VertexId b) {
    const glm::dvec3 along{mesh_.vertices.positions[b] - mesh_.vertices.positions[a]};
    const glm::dvec3 out = glm::cross(along, area_vector(mesh_, f));
    const double size = glm::length(out);
    if (!(size > 0.0)) return;
    for (const VertexId v : {a, b}) {
      ends_[weld_.point_of[v]].outwards += out / size;
      ++ends_[weld_.point_of[v]].edges;
    }
  }

  [[nodiscard]] const OutcropPyramid::BorderPoint* border_point(const glm::vec3& position) const {
    const auto at =
        std::lower_bound(level_.border_points.begin(), level_.border_points.end(), position,
                         [](const auto& p, const glm::vec3& x) { return outcrop::is_before(p.position, x); });
    return at != level_.border_points.end() && at->position == position ? &*at : nullptr;
  }

  // Towards the rim of the outcrop itself a skirt becomes smaller, so that it does not stick out beyond.
  [[nodiscard]] glm::vec3 shift_of(VertexId v) const {
    const glm::vec3& position = mesh_.vertices.positions[v];
    const auto* at = border_point(position);
    const double normal_size = at != nullptr ? double{glm::length(at->normal)} : 0.0;
    if (!(normal_size > 0.0)) return glm::vec3{0.0F};
    constexpr double share_of_way = 0.25;
    const double most_m = share_of_way * double{at->rim_m};
    const double gap_m = std::min(info_.gap_m, most_m);
    const double depth_m = std::min(info_.skirt_m, most_m);
    const glm::dvec3 normal = glm::dvec3{at->normal} / normal_size;
    const End& end = ends_[weld_.point_of[v]];
    // Along the mean plane: on a ridge the tile's own would lead out of the rock.
    const glm::dvec3 outwards = end.outwards - normal * glm::dot(normal, end.outwards);
    const double size = glm::length(outwards);
    const double miter = size > 0.0 ? std::min(2.0, end.edges / size) / size : 0.0;  // keeps its width around a corner
    return glm::vec3{gap_m * miter * outwards - depth_m * normal};
  }

  VertexId outer(VertexId v) {
    const auto [at, is_new] = outer_.try_emplace(v, none);
    if (is_new) {
      at->second = append_vertex_copy(mesh_.vertices, v);
      mesh_.vertices.positions[at->second] += shift_of(v);
    }
    return at->second;
  }

  void sew(FaceId f, VertexId a, VertexId b) {
    const VertexId a_out = outer(a);
    const VertexId b_out = outer(b);
    const MaterialId of_face = mesh_.face_materials[f];
    const auto [material, is_new] = materials_.try_emplace(of_face, static_cast<MaterialId>(mesh_.materials.size()));
    if (is_new) {
      mesh_.materials.push_back(mesh_.materials[of_face]);
      mesh_.materials.back().name = skirt_name;
    }
    mesh_.indices.insert(mesh_.indices.end(), {b, a, a_out, b, a_out, b_out});
    mesh_.face_materials.insert(mesh_.face_materials.end(), 2, material->second);
    if (!mesh_.face_features.empty()) mesh_.face_features.insert(mesh_.face_features.end(), 2, mesh_.face_features[f]);
  }

  Mesh& mesh_;
  const OutcropTile& info_;
  const OutcropPyramid::LevelMesh& level_;
  const std::uint8_t* borders_;  // of the tile's first face
  FaceId faces_;
  Weld weld_;
  std::vector<End> ends_;  // per point
  std::map<VertexId, VertexId> outer_;
  std::map<MaterialId, MaterialId> materials_;
};

void OutcropPyramid::add_skirt(std::uint32_t tile, Mesh& mesh) const {
  if (tiles_[tile].skirt_m > 0.0) SkirtMaker{*this, tile, mesh}.make();
}

std::uint32_t surface_triangle_count(const Mesh& mesh) noexcept {
  std::uint32_t count = 0;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) count += is_skirt(mesh, f) ? 0U : 1U;
  return count;
}

}  // namespace lodestone
