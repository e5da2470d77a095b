// SPDX-License-Identifier: MIT
#include "facets/patch.h"

#include <algorithm>

#include "progressive/values.h"

namespace lodestone::facets {
namespace {

class Painter {
 public:
  Painter(FacetMesh& mesh, const Patch& patch, progressive::EditLog& log) : mesh_(mesh), patch_(patch), log_(log) {}

  void run(double error_m) {
    log_.begin(static_cast<float>(error_m));
    for (const auto& [point, to] : patch_.moved) mesh_.place[point] = to;
    for (const FaceId f : patch_.gone) remove(f);
    for (const Redrawn& r : patch_.redrawn) redraw(r);
    for (const Placed& p : patch_.placed) place(p);
    remove_unused();
    log_.end();
    ++mesh_.edits;
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    for (const std::uint32_t p : touched_) {
      ++mesh_.version[p];
      mesh_.deviation_m[p] = std::max(mesh_.deviation_m[p], static_cast<float>(error_m));
    }
  }

 private:
  void unlink(FaceId f) {
    mesh_.touched.push_back(f);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = mesh_.faces[f].point[k];
      mesh_.faces_of[p].erase(f);
      touched_.push_back(p);
    }
  }

  void drop(VertexId v) {
    if (--mesh_.uses[v] == 0) orphans_.push_back(v);
  }

  void remove(FaceId f) {
    unlink(f);
    Face& face = mesh_.faces[f];
    face.live = false;
    --mesh_.live_faces;
    --mesh_.live_of_material[mesh_.source->face_material(f)];
    log_.remove_face(f);
    for (const VertexId v : face.vertex) drop(v);
  }

  void redraw(const Redrawn& r) {
    unlink(r.face);
    Face& face = mesh_.faces[r.face];
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (face.vertex[k] != r.vertex[k]) {
        log_.repoint(3 * r.face + k, r.vertex[k]);
        ++mesh_.uses[r.vertex[k]];
        drop(face.vertex[k]);
        face.vertex[k] = r.vertex[k];
      }
      face.point[k] = r.point[k];
      mesh_.faces_of[r.point[k]].push_back(r.face);
      touched_.push_back(r.point[k]);
    }
    if (face.surface != patch_.surface) mesh_.surface_faces[patch_.surface].push_back(r.face);
    face.surface = patch_.surface;
    face.normal = patch_.normal;
  }

  void place(const Placed& p) {
    VertexArrays& values = mesh_.values;
    values.positions[p.vertex] = mesh_.place[p.point];
    if (!values.uvs.empty()) values.uvs[p.vertex] = p.uv;
    if (!values.normals.empty() && p.normal != glm::vec3{0.0F}) values.normals[p.vertex] = p.normal;
    std::array<std::uint32_t, 12> words{};
    progressive::get_value(progressive::pointers(values), p.vertex, words.data());
    log_.move_vertex(p.vertex, {words.data(), progressive::value_words(values)});
  }

  void remove_unused() {
    std::sort(orphans_.begin(), orphans_.end());
    orphans_.erase(std::unique(orphans_.begin(), orphans_.end()), orphans_.end());
    for (const VertexId v : orphans_) {
      if (mesh_.uses[v] != 0) continue;
      const auto at =
          std::find_if(patch_.merged.begin(), patch_.merged.end(), [&](const Merged& m) { return m.vertex == v; });
      log_.remove_vertex(v, at == patch_.merged.end() ? none : at->onto);
    }
  }

  FacetMesh& mesh_;
  const Patch& patch_;
  progressive::EditLog& log_;
  std::vector<VertexId> orphans_;
  std::vector<std::uint32_t> touched_;
};

}  // namespace

void apply(FacetMesh& mesh, const Patch& patch, double error_m, progressive::EditLog& log) {
  Painter{mesh, patch, log}.run(error_m);
}

}  // namespace lodestone::facets
