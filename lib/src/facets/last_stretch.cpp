// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019 (what is left of a building is its walls and main roofs) and the engine of collapse/
// (Lindstrom and Turk 1998). Differs: planes are given up by size: at each error those large beside its square are
// held, the others may turn.
#include "facets/last_stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "collapse/engine.h"
#include "facets/openings.h"
#include "mesh/weld.h"

namespace lodestone::facets {
namespace {

constexpr double first_error_m = 0.02;
constexpr std::size_t few_faces = 1'000;
constexpr double error_step = 1.3;      // from one stage to the next; each looks at all edges,
constexpr double coarse_step = 2.0;     // so where more faces are left there are fewer stages
constexpr double strict_quota = 0.005;  // of the points in a pass: near to strict order, which few can afford
constexpr double upright_sine = 0.1;
constexpr std::size_t most_corners = 8;  // of a window that goes whole
constexpr double window_error_m = 0.05;  // of a stage: from there on the price of windows rises with it
constexpr double held_ratio = 1.333;     // a window that cannot close is held while it is so much larger than that
constexpr double plane_arm_m = 30.0;     // 9 in the loop
constexpr double claim_factor = 2.0;     // the engine's claims times this, added to what was claimed before
constexpr SurfaceTolerance tolerance{.angle_rad = 0.0175, .offset_m = 0.004};

// What is left of the building as a mesh of its own, which follows the engine's records.
class Rest final : public collapse::Sink {
 public:
  Rest(FacetMesh& mesh, const Block& block, Reached reached, progressive::EditLog& log)
      : mesh_(mesh), block_(block), error_m_(reached.error_m), price_(reached.price), log_(log) {
    gather();
    CharacteristicSurfaces found = characteristic_surfaces(rest_, tolerance);
    for (const CharacteristicSurface& s : found.surfaces) planes_.push_back({s.normal, s.offset_m});
    plane_of_face_ = std::move(found.surface_of_face);
  }

  void record(const collapse::Edit& edit) override {
    std::vector<FaceId> gone;
    for (const FaceId f : edit.faces) gone.push_back(face_[f]);
    stopped_ = stopped_ || block_.must_come(mesh_) || block_.needs(mesh_, gone);
    if (stopped_) return;
    log_.begin(static_cast<float>(error_m_ + claim_factor * double{edit.error_m}));
    for (const FaceId f : edit.faces) remove_face(f);
    for (const auto& [corner, to] : edit.corners) repoint(corner, to);
    const std::size_t words = edit.moved.empty() ? 0 : edit.values.size() / edit.moved.size();
    for (std::size_t i = 0; i < edit.moved.size(); ++i) {
      log_.move_vertex(vertex_[edit.moved[i]], edit.values.subspan(i * words, words));
      stray(edit.moved[i], edit.error_m);
    }
    collapse::move_vertices(edit, rest_.vertices);
    for (const RemovedVertex& v : edit.vertices) {
      log_.remove_vertex(vertex_[v.vertex], v.merges_into == none ? none : vertex_[v.merges_into]);
      if (v.merges_into != none) stray(v.merges_into, edit.error_m);
    }
    log_.end();
    ++record_count_;
  }

  std::uint32_t run(const FacetShiftOptions& options, const Context& context) {
    const double most_m = (options.max_error_m - error_m_) / claim_factor;
    const double last_m = std::min(most_m, bounds(rest_).diagonal_m());
    const std::uint32_t target = std::max(options.target_triangles, block_.face_count());
    double limit_m = first_error_m;
    while (limit_m < last_m && !context.cancelled()) {
      if (stopped_ || mesh_.live_faces <= target) break;
      const std::vector<std::uint8_t> frozen = close_windows(options, limit_m);
      drop_dead_faces();
      EdgeCollapseOptions stage = hold_planes(limit_m * limit_m);
      stage.frozen = frozen;
      stage.max_error_m = limit_m;
      stage.target_triangles = target;
      collapse::run(rest_, stage, context, *this,
                    {.deviation_m = strayed_m_,
                     .quota = face_.size() < few_faces ? strict_quota : 0.0,
                     .scruples = collapse::Scruples::None});
      limit_m *= face_.size() < few_faces ? error_step : coarse_step;
    }
    hand_back();
    return record_count_;
  }

 private:
  void gather() {
    id_.assign(mesh_.source->vertex_count(), none);
    rest_.materials = mesh_.source->materials;
    rest_.textures = mesh_.source->textures;
    for (FaceId f = 0; f < mesh_.faces.size(); ++f) {
      if (!mesh_.faces[f].live) continue;
      face_.push_back(f);
      rest_.face_materials.push_back(mesh_.source->face_material(f));
      for (const VertexId v : mesh_.faces[f].vertex) {
        if (id_[v] == none) {
          id_[v] = static_cast<VertexId>(vertex_.size());
          vertex_.push_back(v);
        }
        rest_.indices.push_back(id_[v]);
      }
    }
    take_values();
    strayed_m_.assign(vertex_.size(), 0.0F);
    dead_.assign(face_.size(), 0);
  }

  void take_values() {
    const auto take = [&](auto& to, const auto& from) {
      to.clear();
      if (from.empty()) return;
      for (const VertexId v : vertex_) to.push_back(from[v]);
    };
    take(rest_.vertices.positions, mesh_.values.positions);
    take(rest_.vertices.normals, mesh_.values.normals);
    take(rest_.vertices.uvs, mesh_.values.uvs);
    take(rest_.vertices.colors, mesh_.values.colors);
  }

  void remove_face(FaceId f) {
    Face& face = mesh_.faces[face_[f]];
    dead_[f] = 1;
    face.live = false;
    --mesh_.live_faces;
    --mesh_.live_of_material[mesh_.source->face_material(face_[f])];
    log_.remove_face(face_[f]);
    for (const VertexId v : face.vertex) --mesh_.uses[v];
  }

  void repoint(CornerId corner, VertexId to) {
    const FaceId f = face_[corner / 3];
    VertexId& vertex = mesh_.faces[f].vertex[corner % 3];
    log_.repoint(3 * f + corner % 3, vertex_[to]);
    rest_.indices[corner] = to;
    --mesh_.uses[vertex];
    vertex = vertex_[to];
    ++mesh_.uses[vertex];
  }

  void stray(VertexId v, float error_m) { strayed_m_[v] = std::max(strayed_m_[v], error_m); }

  void drop_dead_faces() {
    std::size_t kept = 0;
    for (std::size_t f = 0; f < dead_.size(); ++f) {
      if (dead_[f] != 0) continue;
      for (std::size_t k = 0; k < 3; ++k) rest_.indices[3 * kept + k] = rest_.indices[3 * f + k];
      rest_.face_materials[kept] = rest_.face_materials[f];
      face_[kept] = face_[f];
      plane_of_face_[kept++] = plane_of_face_[f];
    }
    rest_.indices.resize(3 * kept);
    rest_.face_materials.resize(kept);
    face_.resize(kept);
    plane_of_face_.resize(kept);
    dead_.assign(kept, 0);
  }

  // Larger planes first; from `least_m2` on they are firm.
  [[nodiscard]] EdgeCollapseOptions hold_planes(double least_m2) const {
    EdgeCollapseOptions options;
    std::vector<double> area_m2(planes_.size(), 0.0);
    for (FaceId f = 0; f < plane_of_face_.size(); ++f) {
      if (plane_of_face_[f] != none) area_m2[plane_of_face_[f]] += 0.5 * glm::length(area_vector(rest_, f));
    }
    std::vector<std::uint32_t> order(planes_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return area_m2[a] > area_m2[b]; });
    std::vector<std::uint32_t> place(order.size(), none);
    for (const std::uint32_t s : order) {
      place[s] = static_cast<std::uint32_t>(options.planes.size());
      options.planes.push_back({planes_[s].normal, planes_[s].offset_m, area_m2[s] >= least_m2});
    }
    for (const std::uint32_t s : plane_of_face_) options.face_planes.push_back(s == none ? none : place[s]);
    options.plane_tolerance_m = tolerance.offset_m;
    options.plane_arm_m = plane_arm_m;
    return options;
  }

  // Windows and doors go whole: those worth the price close, the outlines of the dearer ones stay where they are, and
  // of those that cannot close until they are small. Returns for each vertex whether it is on such an outline.
  [[nodiscard]] std::vector<std::uint8_t> close_windows(const FacetShiftOptions& options, double limit_m) {
    hand_back();
    const double price = price_ * std::max(1.0, limit_m / window_error_m);
    Openings openings{mesh_, false};
    const auto job_of = [&](const Opening& opening, double most) -> std::optional<OpeningJob> {
      if (!is_window(opening)) return std::nullopt;
      auto job = openings.job(opening, most, options.max_error_m);
      if (job && job->patch.gone.empty()) return std::nullopt;
      return job;
    };
    for (bool any = true; any;) {
      any = false;
      openings.update();
      for (const Opening& opening : openings.all()) {
        const auto job = job_of(opening, price);
        if (!job || leaves_too_few(job->patch.gone, options)) continue;
        apply(mesh_, job->patch, job->error_m, log_);
        take_back(*job, opening.wall);
        ++record_count_;
        any = true;
      }
    }
    take_values();
    std::vector<std::uint8_t> held(mesh_.point_count(), 0);
    for (const Opening& opening : openings.all()) {
      if (!is_window(opening)) continue;
      const bool small = opening.size_m() < held_ratio * limit_m;
      if (small && !job_of(opening, std::numeric_limits<double>::infinity())) continue;
      for (const std::uint32_t p : opening.loop) held[p] = 1;
    }
    std::vector<std::uint8_t> frozen(vertex_.size(), 0);
    for (std::size_t i = 0; i < face_.size(); ++i) {
      if (!mesh_.faces[face_[i]].live) continue;
      for (std::size_t k = 0; k < 3; ++k) frozen[rest_.indices[3 * i + k]] = held[mesh_.faces[face_[i]].point[k]];
    }
    return frozen;
  }

  // What has more corners frays, or nothing would be left to go.
  [[nodiscard]] bool is_window(const Opening& opening) const {
    return opening.loop.size() <= most_corners && mesh_.faces[opening.wall].live &&
           std::abs(mesh_.faces[opening.wall].normal.z) < upright_sine;
  }

  [[nodiscard]] bool leaves_too_few(const std::vector<FaceId>& gone, const FacetShiftOptions& options) const {
    return mesh_.live_faces < std::max(options.target_triangles, block_.face_count()) + gone.size() ||
           block_.needs(mesh_, gone);
  }

  void take_back(const OpeningJob& job, FaceId wall) {
    const auto index_of = [&](FaceId f) {
      return static_cast<std::size_t>(std::lower_bound(face_.begin(), face_.end(), f) - face_.begin());
    };
    const std::uint32_t plane = job.kind == OpeningJob::Kind::Recess ? none : plane_of_face_[index_of(wall)];
    const auto strayed_m = static_cast<float>((job.error_m - error_m_) / claim_factor);
    for (const FaceId f : job.patch.gone) dead_[index_of(f)] = 1;
    for (const Redrawn& r : job.patch.redrawn) {
      const std::size_t i = index_of(r.face);
      plane_of_face_[i] = plane;
      for (std::size_t k = 0; k < 3; ++k) {
        rest_.indices[3 * i + k] = id_[r.vertex[k]];
        stray(id_[r.vertex[k]], strayed_m);
      }
    }
  }

  // Gives the values back, and new points where they now lie.
  void hand_back() {
    const auto give = [&](auto& to, const auto& from) {
      for (std::size_t i = 0; i < from.size(); ++i) to[vertex_[i]] = from[i];
    };
    give(mesh_.values.positions, rest_.vertices.positions);
    give(mesh_.values.normals, rest_.vertices.normals);
    give(mesh_.values.uvs, rest_.vertices.uvs);
    give(mesh_.values.colors, rest_.vertices.colors);
    const Weld weld = weld_by_position(rest_.vertices.positions);
    const std::size_t points = std::max<std::size_t>(weld.point_count(), mesh_.place.size());
    mesh_.place.resize(points, glm::vec3{0.0F});
    mesh_.version.resize(points, 0);
    mesh_.deviation_m.assign(points, static_cast<float>(error_m_));
    mesh_.faces_of.assign(points, {});
    for (FaceId f = 0; f < dead_.size(); ++f) {
      if (dead_[f] != 0) continue;
      Face& face = mesh_.faces[face_[f]];
      for (std::size_t k = 0; k < 3; ++k) {
        face.point[k] = weld.point_of[rest_.indices[3 * std::size_t{f} + k]];
        const double strayed_m = strayed_m_[rest_.indices[3 * std::size_t{f} + k]];
        float& deviation_m = mesh_.deviation_m[face.point[k]];
        deviation_m = std::max(deviation_m, static_cast<float>(error_m_ + claim_factor * strayed_m));
        mesh_.place[face.point[k]] = mesh_.values.positions[face.vertex[k]];
        auto& around = mesh_.faces_of[face.point[k]];
        if (around.empty() || around.back() != face_[f]) around.push_back(face_[f]);
      }
      const glm::dvec3 n = mesh_.area_vector(face);
      if (glm::dot(n, n) > 0.0) face.normal = glm::normalize(n);
    }
  }

  FacetMesh& mesh_;
  const Block& block_;
  double error_m_;
  double price_;
  progressive::EditLog& log_;
  Mesh rest_;
  std::vector<FaceId> face_;      // of rest_: in the source
  std::vector<VertexId> vertex_;  // the same
  std::vector<VertexId> id_;      // of the source: in rest_
  std::vector<float> strayed_m_;  // per vertex: since the engine took over, by its claims
  std::vector<std::uint8_t> dead_;
  std::vector<HeldPlane> planes_;
  std::vector<std::uint32_t> plane_of_face_;
  std::uint32_t record_count_ = 0;
  bool stopped_ = false;
};

}  // namespace

std::uint32_t collapse_the_rest(FacetMesh& mesh, const FacetShiftOptions& options, const Block& block, Reached reached,
                                const Context& context, progressive::EditLog& log) {
  return Rest{mesh, block, reached, log}.run(options, context);
}

}  // namespace lodestone::facets
