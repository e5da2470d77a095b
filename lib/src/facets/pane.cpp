// SPDX-License-Identifier: MIT
#include "facets/pane.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "facets/outline.h"

namespace lodestone::facets {
namespace {

constexpr double facing_cosine = 0.9;
constexpr double other_part_m = 10.0;  // so much farther off counts a vertex of something else than the pane

class PaneMaker {
 public:
  explicit PaneMaker(const Site& site) : site_(site), mesh_(site.mesh) {}

  [[nodiscard]] std::optional<Patch> whole(double depth_m, double& look_cost) {
    auto ring = outer_ring(depth_m);
    if (!ring) return std::nullopt;
    Sheet pane;
    pane.corners = std::move(*ring);
    if (!cut(pane, {pane.corners}, site_.opening.area_m2)) return std::nullopt;
    look_cost = std::numeric_limits<double>::infinity();
    for (MaterialId m = 0; m < mesh_.source->materials.size(); ++m) {
      if (site_.view.face_count(m) < pane.triangles.size()) continue;
      const double cost = site_.view.cost(m, site_.opening.area_m2);
      if (cost >= look_cost) continue;
      look_cost = cost;
      pane.material = m;
    }
    sheets_.push_back(std::move(pane));
    return sheets_[0].material == none ? std::nullopt : draw(depth_m);
  }

  [[nodiscard]] std::optional<Patch> framed(double depth_m, double& look_cost) {
    const std::size_t frame_faces = site_.opening.loop.size() + 4;
    if (site_.content.size() <= frame_faces + 2) return std::nullopt;
    const auto found = site_.view.best_frame(site_.opening.area_m2, frame_faces, 2);
    if (!found) return std::nullopt;
    auto ring = outer_ring(depth_m);
    if (!ring) return std::nullopt;
    std::vector<glm::dvec3> corners{found->corners.begin(), found->corners.end()};
    for (glm::dvec3& c : corners) c -= depth_m * site_.normal;
    const auto hole = take_points(corners);
    if (hole.empty()) return std::nullopt;
    look_cost = found->cost;
    Sheet frame{.material = found->frame};
    Sheet pane{.material = found->pane};
    pane.corners.assign(hole.rbegin(), hole.rend());
    frame.corners = std::move(*ring);
    const double pane_m2 = 0.5 * glm::length(glm::cross(hole[2].at - hole[0].at, hole[3].at - hole[1].at));
    if (!cut(pane, {pane.corners}, pane_m2) || !cut(frame, {frame.corners, hole}, site_.opening.area_m2 - pane_m2))
      return std::nullopt;
    frame.corners.insert(frame.corners.end(), hole.begin(), hole.end());
    sheets_ = {std::move(frame), std::move(pane)};
    return draw(depth_m);
  }

 private:
  // Faces of one material.
  struct Sheet {
    MaterialId material = none;
    std::vector<Corner> corners{};
    std::vector<std::array<std::uint32_t, 3>> triangles{};
    std::vector<FaceId> faces{};
    FaceId look = none;  // whose texture goes on
    std::vector<VertexId> vertices{};
  };
  struct Free {
    VertexId vertex;
    std::uint32_t uses;
    MaterialId facing;  // of a face with it that looks out of the wall
    glm::dvec3 at;
    bool taken;
  };

  // Along the opening: its own corners, or others behind them.
  [[nodiscard]] std::optional<std::vector<Corner>> outer_ring(double depth_m) {
    std::vector<Corner> ring;
    std::transform(site_.opening.loop.rbegin(), site_.opening.loop.rend(), std::back_inserter(ring),
                   [&](std::uint32_t p) {
                     return Corner{p, mesh_.at(p)};
                   });
    if (depth_m == 0.0) return ring;
    std::vector<glm::dvec3> corners;
    corners.reserve(ring.size());
    for (const Corner& c : ring) corners.push_back(c.at - depth_m * site_.normal);
    ring = take_points(corners);
    return ring.empty() ? std::nullopt : std::optional{std::move(ring)};
  }

  [[nodiscard]] bool cut(Sheet& sheet, const std::vector<std::vector<Corner>>& rings, double area_m2) const {
    auto triangles = triangulate(rings, site_.normal, area_m2);
    if (triangles) sheet.triangles = std::move(*triangles);
    return triangles.has_value();
  }

  [[nodiscard]] bool is_content(FaceId f) const {
    return std::binary_search(site_.content.begin(), site_.content.end(), f);
  }
  [[nodiscard]] double facing(FaceId f) const { return std::abs(glm::dot(mesh_.faces[f].normal, site_.normal)); }

  // Points that only the content uses become these corners; none if there are too few.
  std::vector<Corner> take_points(const std::vector<glm::dvec3>& corners) {
    std::vector<std::uint32_t> points;
    for (const FaceId f : site_.content)
      points.insert(points.end(), mesh_.faces[f].point.begin(), mesh_.faces[f].point.end());
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::erase_if(points, [&](std::uint32_t p) {
      const auto& around = mesh_.faces_of[p];
      return std::find(site_.opening.loop.begin(), site_.opening.loop.end(), p) != site_.opening.loop.end() ||
             std::any_of(patch_.moved.begin(), patch_.moved.end(), [p](const auto& m) { return m.first == p; }) ||
             !std::all_of(around.begin(), around.end(), [&](FaceId g) { return is_content(g); });
    });
    if (points.size() < corners.size()) return {};
    std::vector<Corner> taken;
    for (const glm::dvec3& corner : corners) {
      const auto nearest = std::min_element(points.begin(), points.end(), [&](std::uint32_t a, std::uint32_t b) {
        return glm::length(mesh_.at(a) - corner) < glm::length(mesh_.at(b) - corner);
      });
      patch_.moved.emplace_back(*nearest, glm::vec3{corner});
      taken.push_back({*nearest, glm::dvec3{glm::vec3{corner}}});
      points.erase(nearest);
    }
    return taken;
  }

  [[nodiscard]] std::optional<Patch> draw(double depth_m) {
    find_free();
    for (Sheet& sheet : sheets_) {
      if (!choose_faces(sheet)) return std::nullopt;
    }
    for (Sheet& sheet : sheets_) {
      if (!choose_vertices(sheet)) return std::nullopt;
    }
    patch_.surface = mesh_.faces[depth_m == 0.0 ? site_.opening.wall : sheets_.back().look].surface;
    patch_.normal = site_.normal;
    std::vector<FaceId> used;
    for (const Sheet& sheet : sheets_) {
      for (std::size_t i = 0; i < sheet.triangles.size(); ++i) {
        Redrawn r{sheet.faces[i], sheet.triangles[i], {}};
        for (std::size_t k = 0; k < 3; ++k) r.vertex[k] = vertex_at(sheet, r.point[k]);
        patch_.redrawn.push_back(r);
      }
      used.insert(used.end(), sheet.faces.begin(), sheet.faces.end());
    }
    std::sort(used.begin(), used.end());
    std::set_difference(site_.content.begin(), site_.content.end(), used.begin(), used.end(),
                        std::back_inserter(patch_.gone));
    return std::move(patch_);
  }

  // Largest first.
  bool choose_faces(Sheet& sheet) const {
    for (const FaceId f : site_.content) {
      if (mesh_.source->face_material(f) == sheet.material) sheet.faces.push_back(f);
    }
    if (sheet.faces.size() < sheet.triangles.size()) return false;
    const auto shown = [&](FaceId f) { return glm::length(mesh_.area_vector(mesh_.faces[f])) * facing(f); };
    std::stable_sort(sheet.faces.begin(), sheet.faces.end(), [&](FaceId a, FaceId b) { return shown(a) > shown(b); });
    sheet.look = sheet.faces.front();
    sheet.faces.resize(sheet.triangles.size());
    return true;
  }

  // Vertices that no face outside uses.
  void find_free() {
    for (const FaceId f : site_.content) {
      const Face& face = mesh_.faces[f];
      const MaterialId material = facing(f) > facing_cosine ? mesh_.source->face_material(f) : none;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at =
            std::find_if(free_.begin(), free_.end(), [&](const Free& v) { return v.vertex == face.vertex[k]; });
        if (at == free_.end()) {
          free_.push_back({face.vertex[k], 1, material, mesh_.at(face.point[k]), false});
        } else {
          ++at->uses;
          if (material != none) at->facing = material;
        }
      }
    }
    std::erase_if(free_, [&](const Free& v) { return v.uses != mesh_.uses[v.vertex]; });
  }

  // One for each corner: the nearest.
  bool choose_vertices(Sheet& sheet) {
    const Face& look = mesh_.faces[sheet.look];
    for (const Corner& corner : sheet.corners) {
      Free* best = nullptr;
      double least = std::numeric_limits<double>::infinity();
      for (Free& v : free_) {
        if (v.taken) continue;
        const double away = glm::length(v.at - corner.at) + (v.facing == sheet.material ? 0.0 : other_part_m);
        if (away < least) {
          least = away;
          best = &v;
        }
      }
      if (best == nullptr) return false;
      best->taken = true;
      Placed placed{best->vertex, corner.point, {}, {}};
      if (!mesh_.values.uvs.empty()) placed.uv = extrapolate_uv(mesh_, look, corner.at);
      if (!std::isfinite(placed.uv.x) || !std::isfinite(placed.uv.y)) return false;
      if (!mesh_.values.normals.empty()) placed.normal = glm::vec3{site_.normal};
      patch_.placed.push_back(placed);
      sheet.vertices.push_back(best->vertex);
    }
    return true;
  }

  static VertexId vertex_at(const Sheet& sheet, std::uint32_t point) {
    const auto at =
        std::find_if(sheet.corners.begin(), sheet.corners.end(), [&](const Corner& c) { return c.point == point; });
    return sheet.vertices[static_cast<std::size_t>(at - sheet.corners.begin())];
  }

  const Site& site_;
  const FacetMesh& mesh_;
  Patch patch_;
  std::vector<Sheet> sheets_;
  std::vector<Free> free_;
};

}  // namespace

std::optional<Patch> draw_pane(const Site& site, double depth_m, double& look_cost) {
  return PaneMaker{site}.whole(depth_m, look_cost);
}

std::optional<Patch> draw_framed_pane(const Site& site, double depth_m, double& look_cost) {
  return PaneMaker{site}.framed(depth_m, look_cost);
}

}  // namespace lodestone::facets
