// SPDX-License-Identifier: MIT
#include "facets/facet_mesh.h"

#include <algorithm>
#include <cmath>

#include <lodestone/repair.h>

#include "mesh/weld.h"
#include "progressive/values.h"

namespace lodestone::facets {
namespace {

constexpr float same_uv = 1e-3F;
constexpr float same_normal_cosine = 0.999F;

// A vertex's values at its new place, and where its corners go.
struct Heir {
  VertexId vertex = none;
  VertexId onto = none;  // an equal vertex at the new place, else the vertex itself moves
  bool moves = false;
  glm::vec3 to{0.0F};
  glm::vec2 uv{0.0F};
  double weight = -1.0;  // area of the face that uv was taken from
};

bool same_values(const VertexArrays& values, const Heir& heir, VertexId b) {
  if (!values.uvs.empty() && glm::length(values.uvs[b] - heir.uv) > same_uv) return false;
  if (!values.normals.empty() && glm::dot(values.normals[b], values.normals[heir.vertex]) < same_normal_cosine) {
    return false;
  }
  return values.colors.empty() || values.colors[b] == values.colors[heir.vertex];
}

// One record in the making.
class Editor {
 public:
  Editor(FacetMesh& mesh, Moved& moved, progressive::EditLog& log) : mesh_(mesh), moved_(moved), log_(log) {}

  void run(double error_m) {
    sort_faces();
    find_heirs();
    log_.begin(static_cast<float>(error_m));
    for (const FaceId f : dead_) kill(f);
    move_corners();
    remove_unused();
    log_.end();
    relink(static_cast<float>(error_m));
  }

 private:
  // Which faces die: two corners became one, or on top of another one. A face with three
  // corners in a line stays: it ties its neighbours together until one of the corners slides onto another.
  void sort_faces() {
    for (const FaceId f : moved_.faces()) {
      const Triple q = after(f);
      const bool flat = q[0] == q[1] || q[1] == q[2] || q[2] == q[0];
      const bool twin = !flat && std::any_of(alive_.begin(), alive_.end(), [&](FaceId g) { return same(after(g), q); });
      if (flat || twin) {
        dead_.push_back(f);
        continue;
      }
      alive_.push_back(f);
      // What lay there before is covered by the face that came from outside.
      for (const FaceId g : mesh_.faces_of[q[0]]) {
        const auto& r = mesh_.faces[g].point;
        const bool at_rest = !moved_.moves(r[0]) && !moved_.moves(r[1]) && !moved_.moves(r[2]);
        if (at_rest && same(r, q) && std::find(dead_.begin(), dead_.end(), g) == dead_.end()) dead_.push_back(g);
      }
    }
  }

  using Triple = std::array<std::uint32_t, 3>;
  [[nodiscard]] Triple after(FaceId f) const {
    const Triple& p = mesh_.faces[f].point;
    return {moved_.point(p[0]), moved_.point(p[1]), moved_.point(p[2])};
  }
  // The same corners, turning the same way: the other way it is the back of a thin sheet, and both are needed to keep
  // a closed part closed.
  static bool same(const Triple& a, const Triple& b) {
    return (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) || (a[0] == b[1] && a[1] == b[2] && a[2] == b[0]) ||
           (a[0] == b[2] && a[1] == b[0] && a[2] == b[1]);
  }

  void find_heirs() {
    std::size_t next_alive = 0;  // alive_ is in the order of moved_.faces()
    for (const FaceId f : moved_.faces()) {
      const Face& face = mesh_.faces[f];
      const bool lives = next_alive < alive_.size() && alive_[next_alive] == f;
      next_alive += lives ? 1 : 0;
      const double area = lives ? glm::length(mesh_.area_vector(face)) : 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!moved_.moves(face.point[k])) continue;
        Heir& heir = heir_of(face.vertex[k]);
        heir.to = glm::vec3{moved_.at(face.point[k])};
        if (area <= heir.weight) continue;
        heir.weight = area;
        if (!mesh_.values.uvs.empty()) {
          heir.uv = area > 0.0 ? extrapolate_uv(mesh_, face, glm::dvec3{heir.to}) : mesh_.values.uvs[heir.vertex];
          if (!std::isfinite(heir.uv.x) || !std::isfinite(heir.uv.y)) heir.uv = mesh_.values.uvs[heir.vertex];
        }
      }
    }
    for (const Move& move : moved_.moves()) {
      if (move.onto == none || moved_.moves(move.onto)) continue;
      for (const FaceId f : mesh_.faces_of[move.point]) {
        const Face& face = mesh_.faces[f];
        for (std::size_t k = 0; k < 3; ++k) {
          if (face.point[k] == move.point) find_equal(heir_of(face.vertex[k]), move.onto);
        }
      }
    }
  }

  Heir& heir_of(VertexId v) {
    for (Heir& h : heirs_) {
      if (h.vertex == v) return h;
    }
    heirs_.push_back({.vertex = v});
    return heirs_.back();
  }

  void find_equal(Heir& heir, std::uint32_t point) const {
    for (const FaceId f : mesh_.faces_of[point]) {
      const Face& face = mesh_.faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        if (face.point[k] == point && same_values(mesh_.values, heir, face.vertex[k]) &&
            (heir.onto == none || face.vertex[k] < heir.onto)) {
          heir.onto = face.vertex[k];
        }
      }
    }
  }

  void kill(FaceId f) {
    Face& face = mesh_.faces[f];
    face.live = false;
    --mesh_.live_faces;
    --mesh_.live_of_material[mesh_.source->face_material(f)];
    log_.remove_face(f);
    for (const VertexId v : face.vertex) {
      --mesh_.uses[v];
      orphans_.push_back(v);
    }
  }

  void move_corners() {
    for (const FaceId f : alive_) {
      Face& face = mesh_.faces[f];
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (!moved_.moves(face.point[k])) continue;
        Heir& heir = heir_of(face.vertex[k]);
        if (heir.onto == none || heir.onto == face.vertex[k]) {
          heir.moves = true;
          continue;
        }
        log_.repoint(3 * f + k, heir.onto);
        --mesh_.uses[heir.vertex];
        ++mesh_.uses[heir.onto];
        orphans_.push_back(heir.vertex);
        face.vertex[k] = heir.onto;
      }
    }
    std::array<std::uint32_t, 12> words{};
    const std::uint32_t count = progressive::value_words(mesh_.values);
    for (const Heir& heir : heirs_) {
      if (!heir.moves) continue;
      mesh_.values.positions[heir.vertex] = heir.to;
      if (!mesh_.values.uvs.empty()) mesh_.values.uvs[heir.vertex] = heir.uv;
      progressive::get_value(progressive::pointers(mesh_.values), heir.vertex, words.data());
      log_.move_vertex(heir.vertex, {words.data(), count});
    }
  }

  void remove_unused() {
    std::sort(orphans_.begin(), orphans_.end());
    orphans_.erase(std::unique(orphans_.begin(), orphans_.end()), orphans_.end());
    std::erase_if(orphans_, [&](VertexId v) { return mesh_.uses[v] != 0; });
    for (const VertexId v : orphans_) log_.remove_vertex(v, resting_place(v));
  }

  // A vertex in use where this one ends.
  [[nodiscard]] VertexId resting_place(VertexId v) const {
    for (const Heir& heir : heirs_) {
      if (heir.vertex != v) continue;
      if (heir.onto != none && mesh_.uses[heir.onto] != 0) return heir.onto;
      for (const Move& move : moved_.moves()) {
        if (move.onto == none || move.to != heir.to) continue;
        for (const FaceId f : mesh_.faces_of[move.onto]) {
          const Face& face = mesh_.faces[f];
          for (std::size_t k = 0; k < 3 && face.live; ++k) {
            if (face.point[k] == move.onto) return face.vertex[k];
          }
        }
      }
    }
    return none;
  }

  void relink(float error_m) {
    ++mesh_.edits;
    mesh_.touched.insert(mesh_.touched.end(), dead_.begin(), dead_.end());
    mesh_.touched.insert(mesh_.touched.end(), alive_.begin(), alive_.end());
    for (const FaceId f : dead_) {
      for (const std::uint32_t p : mesh_.faces[f].point) {
        mesh_.faces_of[p].erase(f);
        ++mesh_.version[p];
      }
    }
    for (const FaceId f : alive_) {
      Face& face = mesh_.faces[f];
      for (std::uint32_t& p : face.point) {
        const std::uint32_t q = moved_.point(p);
        ++mesh_.version[q];
        if (q == p) continue;
        mesh_.faces_of[q].push_back(f);
        p = q;
      }
    }
    for (const Move& move : moved_.moves()) {
      const std::uint32_t q = moved_.point(move.point);
      mesh_.deviation_m[q] = std::max({mesh_.deviation_m[q], mesh_.deviation_m[move.point], error_m});
      if (q == move.point) {
        mesh_.place[q] = move.to;
      } else {
        mesh_.faces_of[move.point].clear();
        ++mesh_.version[move.point];
      }
    }
  }

  FacetMesh& mesh_;
  Moved& moved_;
  progressive::EditLog& log_;
  std::vector<FaceId> dead_, alive_;
  std::vector<Heir> heirs_;
  std::vector<VertexId> orphans_;
};

}  // namespace

glm::vec2 extrapolate_uv(const FacetMesh& mesh, const Face& f, const glm::dvec3& to) {
  const glm::dvec3 a = mesh.at(f.point[0]);
  const glm::dvec3 ab = mesh.at(f.point[1]) - a;
  const glm::dvec3 ac = mesh.at(f.point[2]) - a;
  const glm::dvec3 n = glm::cross(ab, ac);
  const double n2 = glm::dot(n, n);
  const double s = glm::dot(glm::cross(to - a, ac), n) / n2;
  const double t = glm::dot(glm::cross(ab, to - a), n) / n2;
  const auto uv = [&](std::size_t k) { return glm::dvec2{mesh.values.uvs[f.vertex[k]]}; };
  return glm::vec2{uv(0) + s * (uv(1) - uv(0)) + t * (uv(2) - uv(0))};
}

bool same_looks(const VertexArrays& values, VertexId a, VertexId b) {
  if (!values.uvs.empty() && glm::length(values.uvs[b] - values.uvs[a]) > same_uv) return false;
  if (!values.normals.empty() && glm::dot(values.normals[b], values.normals[a]) < same_normal_cosine) return false;
  return values.colors.empty() || values.colors[b] == values.colors[a];
}

double height_m(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double longest2 = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  return longest2 > 0.0 ? glm::length(glm::cross(b - a, c - a)) / std::sqrt(longest2) : 0.0;
}

void Moved::set(std::span<const Move> moves) {
  moves_ = moves;
  ++now_;
  faces_.clear();
  for (std::uint32_t i = 0; i < moves.size(); ++i) {
    stamp_[moves[i].point] = now_;
    index_[moves[i].point] = i;
  }
  for (const Move& move : moves) {
    for (const FaceId f : mesh_.faces_of[move.point]) {
      if (face_stamp_[f] == now_) continue;
      face_stamp_[f] = now_;
      faces_.push_back(f);
    }
  }
}

FacetMesh make_facet_mesh(const Mesh& source, const FacetShiftOptions& options, std::vector<FaceId>& degenerate) {
  FacetMesh mesh;
  mesh.source = &source;
  mesh.looks = Looks{source, options.texture_colors};
  // What counts as one point is seen on a copy: the finest level is the source as it is.
  Mesh copy;
  if (options.weld_tolerance_m > 0.0) {
    copy = source;
    repair(copy,
           {.weld_tolerance_m = options.weld_tolerance_m, .remove_degenerate = false, .remove_duplicates = false});
  }
  const Mesh& welded = options.weld_tolerance_m > 0.0 ? copy : source;
  mesh.surfaces = characteristic_surfaces(welded, options.tolerance);
  mesh.surface_faces.resize(mesh.surfaces.surfaces.size());
  const Weld weld = weld_by_position(welded.vertices.positions);
  mesh.place.resize(weld.point_count());
  for (std::uint32_t p = 0; p < weld.point_count(); ++p) {
    mesh.place[p] = welded.vertices.positions[weld.first_vertex[p]];
  }
  mesh.faces_of.resize(weld.point_count());
  mesh.deviation_m.assign(weld.point_count(), static_cast<float>(options.weld_tolerance_m));
  mesh.version.assign(weld.point_count(), 0);
  mesh.values = source.vertices;
  mesh.uses.assign(source.vertex_count(), 0);
  mesh.faces.resize(source.triangle_count());
  mesh.material_area_m2.assign(source.materials.size(), 0.0);
  mesh.live_of_material.assign(source.materials.size(), 0);
  for (FaceId f = 0; f < source.triangle_count(); ++f) {
    Face& face = mesh.faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      face.vertex[k] = source.indices[3 * std::size_t{f} + k];
      face.point[k] = weld.point_of[face.vertex[k]];
    }
    face.surface = mesh.surfaces.surface_of_face[f];
    if (face.surface == none || collapsed(weld, face.vertex.data())) {
      degenerate.push_back(f);
      continue;
    }
    face.live = true;
    mesh.material_area_m2[source.face_material(f)] += mesh.area_m2(face);
    ++mesh.live_faces;
    ++mesh.live_of_material[source.face_material(f)];
    face.normal = glm::normalize(mesh.area_vector(face));
    mesh.surface_faces[face.surface].push_back(f);
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.faces_of[face.point[k]].push_back(f);
      ++mesh.uses[face.vertex[k]];
    }
  }
  return mesh;
}

void apply(FacetMesh& mesh, Moved& moved, double error_m, progressive::EditLog& log) {
  Editor{mesh, moved, log}.run(error_m);
}

namespace {

// The vertex nearest to the middle of all.
VertexId middle_one(const FacetMesh& mesh, std::span<const VertexId> vertices) {
  glm::dvec3 middle{0.0};
  for (const VertexId v : vertices) middle += glm::dvec3{mesh.values.positions[v]};
  middle /= static_cast<double>(vertices.size());
  const auto away = [&](VertexId v) {
    const glm::dvec3 d = glm::dvec3{mesh.values.positions[v]} - middle;
    return glm::dot(d, d);
  };
  return *std::min_element(vertices.begin(), vertices.end(), [&](VertexId a, VertexId b) { return away(a) < away(b); });
}

// Takes the faces away; returns the vertices that nothing uses any more, ascending.
std::vector<VertexId> take_away(FacetMesh& mesh, std::span<const FaceId> faces, progressive::EditLog& log) {
  std::vector<VertexId> vertices;
  ++mesh.edits;
  mesh.touched.insert(mesh.touched.end(), faces.begin(), faces.end());
  for (const FaceId f : faces) {
    Face& face = mesh.faces[f];
    face.live = false;
    --mesh.live_faces;
    --mesh.live_of_material[mesh.source->face_material(f)];
    log.remove_face(f);
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.faces_of[face.point[k]].erase(f);
      ++mesh.version[face.point[k]];
      if (--mesh.uses[face.vertex[k]] == 0) vertices.push_back(face.vertex[k]);
    }
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

}  // namespace

void vanish(FacetMesh& mesh, std::span<const FaceId> faces, Going going, double error_m, progressive::EditLog& log) {
  log.begin(static_cast<float>(error_m));
  const std::vector<VertexId> vertices = take_away(mesh, faces, log);
  const VertexId onto = going == Going::Shrinking && !vertices.empty() ? middle_one(mesh, vertices) : none;
  for (const VertexId v : vertices) log.remove_vertex(v, onto);
  log.end();
}

void vanish(FacetMesh& mesh, std::span<const FaceId> faces, std::span<const std::pair<VertexId, VertexId>> onto,
            double error_m, progressive::EditLog& log) {
  log.begin(static_cast<float>(error_m));
  for (const VertexId v : take_away(mesh, faces, log)) {
    const auto at = std::lower_bound(onto.begin(), onto.end(), std::pair{v, VertexId{0}});
    log.remove_vertex(v, at != onto.end() && at->first == v ? at->second : none);
  }
  log.end();
}

}  // namespace lodestone::facets
