// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019, section 3.2 (the outermost plane of a depression comes to the next one).
// Differs: real windows are loose boxes that stand in a hole of the wall and share no point with it. So the hole itself
// is found, and what stands in it comes to the plane of the wall as one pane that is sewn to the hole's corners; a pane
// that is flush goes whole and the wall closes over it.
#include "facets/openings.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/disjoint_sets.h"
#include "facets/outline.h"
#include "facets/pane.h"

namespace lodestone::facets {
namespace {

constexpr double facing_cosine = 0.9;
constexpr double plane_m = 0.012;  // planes of surveyed walls differ by millimetres
constexpr std::size_t most_corners = 64;
constexpr double most_depth_m = 1.5;   // behind the wall
constexpr double most_height_m = 0.4;  // before it
constexpr double margin_m = 0.1;       // frames may reach so far under the wall
constexpr double covered = 0.6;        // of the hole: where less is, one saw through it, and that has a price
constexpr double look_ahead = 4.0;     // times the price
constexpr double side_cosine = 0.1;    // what goes straight back from the outline
constexpr double least_depth_m = 0.02;
constexpr double sheet_m = 0.05;         // so near to a pane behind the wall
constexpr double sheet_share = 0.8;      // lies at least so much of it
constexpr std::size_t fewest_saved = 4;  // faces that a pane behind the wall saves at least
constexpr double look_weight = 0.2;      // of a window that goes, beside a hole that closes

struct Plane {
  glm::dvec3 normal;
  double offset_m;
  [[nodiscard]] double height(const glm::dvec3& p) const { return glm::dot(normal, p) - offset_m; }
};

Plane plane_of(const FacetMesh& mesh, const Opening& opening) {
  const Face& face = mesh.faces[opening.wall];
  return {face.normal, glm::dot(face.normal, mesh.at(face.point[0]))};
}

// The loop as a polygon in the plane.
class Shape {
 public:
  Shape(const FacetMesh& mesh, const Opening& opening, const glm::dvec3& normal) {
    const glm::dvec3 helper = std::abs(normal.z) < 0.9 ? glm::dvec3{0, 0, 1} : glm::dvec3{1, 0, 0};
    u_ = glm::normalize(glm::cross(helper, normal));
    v_ = glm::cross(normal, u_);
    for (const std::uint32_t p : opening.loop) {
      corners_.push_back(flat(mesh.at(p)));
      low_ = glm::min(low_, corners_.back());
      high_ = glm::max(high_, corners_.back());
    }
  }

  [[nodiscard]] bool contains(const glm::dvec3& at, double margin) const {
    const glm::dvec2 p = flat(at);
    if (p.x < low_.x - margin || p.y < low_.y - margin || p.x > high_.x + margin || p.y > high_.y + margin)
      return false;
    return outside_m(at) <= margin;
  }
  // How far it is from the polygon, 0 inside.
  [[nodiscard]] double outside_m(const glm::dvec3& at) const {
    const glm::dvec2 p = flat(at);
    bool inside = false;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
      const glm::dvec2 a = corners_[i];
      const glm::dvec2 b = corners_[j];
      if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) inside = !inside;
      const double length2 = glm::dot(b - a, b - a);
      const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, b - a) / length2, 0.0, 1.0) : 0.0;
      nearest = std::min(nearest, glm::length(p - a - t * (b - a)));
    }
    return inside ? 0.0 : nearest;
  }

 private:
  [[nodiscard]] glm::dvec2 flat(const glm::dvec3& p) const { return {glm::dot(u_, p), glm::dot(v_, p)}; }
  glm::dvec3 u_, v_;
  std::vector<glm::dvec2> corners_;
  glm::dvec2 low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
};

double area(const FacetMesh& mesh, FaceId f) { return mesh.area_m2(mesh.faces[f]); }

double most_deviation(const FacetMesh& mesh, const std::vector<FaceId>& faces) {
  double most = 0.0;
  for (const FaceId f : faces) {
    for (const std::uint32_t p : mesh.faces[f].point) most = std::max(most, double{mesh.deviation_m[p]});
  }
  return most;
}

bool contains(const std::vector<FaceId>& sorted, FaceId f) {
  return std::binary_search(sorted.begin(), sorted.end(), f);
}

bool has_edge(const Face& face, std::uint32_t a, std::uint32_t b) {
  const auto& p = face.point;
  return (p[0] == a && p[1] == b) || (p[1] == a && p[2] == b) || (p[2] == a && p[0] == b);
}

bool is_side(const Opening& opening, std::uint32_t a, std::uint32_t b) {
  for (std::size_t i = 0; i < opening.loop.size(); ++i) {
    if (opening.loop[i] == a && opening.loop[(i + 1) % opening.loop.size()] == b) return true;
  }
  return false;
}

bool is_edge_of(const Opening& opening, std::uint32_t a, std::uint32_t b) {
  return is_side(opening, a, b) || is_side(opening, b, a);
}

bool is_behind(const FacetMesh& mesh, const Face& face, const Plane& plane) {
  return std::all_of(face.point.begin(), face.point.end(),
                     [&](std::uint32_t p) { return plane.height(mesh.at(p)) < plane_m; });
}

// Whether the faces run between the corners of the hole already.
bool is_sewn(const FacetMesh& mesh, const Opening& opening, const std::vector<FaceId>& faces) {
  return faces.size() + 2 == opening.loop.size() && std::all_of(faces.begin(), faces.end(), [&](FaceId f) {
           const auto& p = mesh.faces[f].point;
           return std::all_of(p.begin(), p.end(), [&](std::uint32_t q) {
             return std::find(opening.loop.begin(), opening.loop.end(), q) != opening.loop.end();
           });
         });
}

// Draws the wall anew where the hole was.
class WallMaker {
 public:
  WallMaker(const FacetMesh& mesh, const Opening& opening, const std::vector<FaceId>& around)
      : mesh_(mesh), opening_(opening), around_(around), normal_(mesh.faces[opening.wall].normal) {}

  bool run(Patch& patch) {
    std::vector<Edge> edges = outline(mesh_, around_);
    std::erase_if(edges, [&](const Edge& e) { return is_side(opening_, e.first, e.second); });
    if (opening_.is_notch) {
      const Edge foot{opening_.loop.front(), opening_.loop.back()};
      edges.insert(std::lower_bound(edges.begin(), edges.end(), foot), foot);
    }
    auto rings = chain(mesh_, edges, normal_);
    double whole = 0.0;
    std::size_t outer = 0;
    for (std::size_t i = 0; i < rings.size(); ++i) {
      const double a = signed_area(mesh_, rings[i], normal_);
      whole += a;
      if (a <= 0.0) continue;
      if (outer != 0) return false;
      outer = i + 1;
    }
    if (outer == 0) return false;
    double drawn = 0.0;
    for (const FaceId f : around_) drawn += area(mesh_, f);
    if (std::abs(drawn + opening_.area_m2 - whole) > 1e-3 * whole) return false;
    std::swap(rings[0], rings[outer - 1]);
    std::vector<std::vector<Corner>> corners;
    for (const auto& ring : rings) {
      corners.emplace_back();
      for (const std::uint32_t p : ring) corners.back().push_back({p, mesh_.at(p)});
    }
    const auto found = triangulate(corners, normal_, whole);
    if (!found || found->size() > around_.size()) return false;
    const auto& triangles = *found;
    patch.surface = mesh_.faces[opening_.wall].surface;
    patch.normal = normal_;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      Redrawn r{around_[i], triangles[i], {}};
      for (std::size_t k = 0; k < 3; ++k) {
        r.vertex[k] = vertex_at(r.point[k]);
        if (r.vertex[k] == none) return false;
      }
      patch.redrawn.push_back(r);
    }
    patch.gone.assign(around_.begin() + static_cast<std::ptrdiff_t>(triangles.size()), around_.end());
    return true;
  }

 private:
  // The wall's vertex there; none if the wall has a seam there.
  [[nodiscard]] VertexId vertex_at(std::uint32_t point) const {
    VertexId found = none;
    for (const FaceId f : around_) {
      const Face& face = mesh_.faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        if (face.point[k] != point || face.vertex[k] == found) continue;
        if (found != none && !same_looks(mesh_.values, found, face.vertex[k])) return none;
        found = std::min(found, face.vertex[k]);
      }
    }
    return found;
  }

  const FacetMesh& mesh_;
  const Opening& opening_;
  const std::vector<FaceId>& around_;  // ascending
  glm::dvec3 normal_;
};

// The faces that fill the hole in its plane; false if they do not fill it exactly.
bool find_filling(const FacetMesh& mesh, const Opening& opening, const Plane& plane, const std::vector<FaceId>& around,
                  std::vector<FaceId>& filling) {
  std::vector<Edge> wanted;
  for (std::size_t i = 0; i < opening.loop.size(); ++i) {
    wanted.emplace_back(opening.loop[(i + 1) % opening.loop.size()], opening.loop[i]);
  }
  std::sort(wanted.begin(), wanted.end());
  const auto visit = [&](std::uint32_t a, std::uint32_t b) {
    for (const FaceId f : mesh.faces_of[a]) {
      if (!has_edge(mesh.faces[f], a, b) || contains(around, f)) continue;
      if (std::find(filling.begin(), filling.end(), f) == filling.end()) filling.push_back(f);
    }
  };
  for (const auto& [a, b] : wanted) visit(a, b);
  for (std::size_t i = 0; i < filling.size(); ++i) {
    if (filling.size() > 4 * most_corners) return false;
    const Face& face = mesh.faces[filling[i]];
    if (!lies_in(mesh, face, plane.normal, plane.offset_m)) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge e{face.point[k], face.point[k == 2 ? 0 : k + 1]};
      if (!std::binary_search(wanted.begin(), wanted.end(), e)) visit(e.second, e.first);
    }
  }
  std::sort(filling.begin(), filling.end());
  return filling.empty() || outline(mesh, filling) == wanted;
}

// The faces that go straight back from the outline of the hole.
std::vector<FaceId> sides_of(const FacetMesh& mesh, const Opening& opening, const Plane& plane,
                             const std::vector<FaceId>& content) {
  const auto is_upright = [&](FaceId f) {
    return std::abs(glm::dot(mesh.faces[f].normal, plane.normal)) < side_cosine;
  };
  std::vector<FaceId> sides;
  for (const FaceId f : content) {
    const auto& p = mesh.faces[f].point;
    if (is_upright(f) &&
        (is_edge_of(opening, p[0], p[1]) || is_edge_of(opening, p[1], p[2]) || is_edge_of(opening, p[2], p[0]))) {
      sides.push_back(f);
    }
  }
  // And what they share an edge and a plane with.
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Face face = mesh.faces[sides[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      for (const FaceId g : mesh.faces_of[face.point[k]]) {
        if (!mesh.faces[g].has_point(face.point[k == 2 ? 0 : k + 1]) || !contains(content, g) ||
            std::find(sides.begin(), sides.end(), g) != sides.end() ||
            !lies_in(mesh, mesh.faces[g], face.normal, glm::dot(face.normal, mesh.at(face.point[0])))) {
          continue;
        }
        sides.push_back(g);
      }
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

}  // namespace

// What stands in the opening becomes one pane in the plane of the wall, drawn between the corners of the hole: the pane
// comes forward and hides the rest. Empty if the opening is not covered, if something holds it from outside, or if it
// is flush.
std::optional<OpeningJob> Openings::flatten(const Opening& opening, double price, Known& known) {
  const Plane plane = plane_of(mesh_, opening);
  const Shape shape{mesh_, opening, plane.normal};
  std::vector<FaceId> content;
  ++look_;
  // Asked of each point for all faces around it.
  const auto stands_in = [&](std::uint32_t p) {
    Asked& asked = asked_[p];
    if (asked.look != look_) {
      const glm::dvec3 at = mesh_.at(p);
      const double h = plane.height(at);
      asked = {look_, h > -most_depth_m && h < most_height_m && shape.contains(at, margin_m)};
    }
    return asked.stands_in;
  };
  cells_.visit_points(box_of(opening), [&](std::uint32_t p) {
    if (!stands_in(p)) return;
    for (const FaceId f : mesh_.faces_of[p]) {
      if (looked_at_[f] == look_) continue;
      looked_at_[f] = look_;
      const Face& face = mesh_.faces[f];
      if (!std::all_of(face.point.begin(), face.point.end(), stands_in)) continue;
      // The wall itself may run around a bend of the outline.
      const glm::dvec3 center = (mesh_.at(face.point[0]) + mesh_.at(face.point[1]) + mesh_.at(face.point[2])) / 3.0;
      if (!shape.contains(center, 0.0) && lies_in(mesh_, face, plane.normal, plane.offset_m)) continue;
      content.push_back(f);
      stood_in_[f] = look_;
    }
  });
  std::sort(content.begin(), content.end());
  // Much changes near an opening that is none of its business.
  std::uint64_t state = content.size() + 1;
  for (const FaceId f : content) state += mesh_.state_of(f);
  for (const std::uint32_t p : opening.loop) state = 31 * state + mesh_.version[p];
  if (state == known.content && known.pane_key > price) return std::nullopt;
  known.content = state;
  double& least_key = known.pane_key = std::numeric_limits<double>::infinity();
  if (content.size() + 2 < opening.loop.size()) return std::nullopt;
  double front = 0.0;
  double back = 0.0;
  for (const FaceId f : content) {
    const Face& face = mesh_.faces[f];
    const double a = area(mesh_, f);
    const double facing = glm::dot(face.normal, plane.normal);
    if (facing > facing_cosine) front += a;
    if (facing < -facing_cosine) back += a;
    // Nothing outside may hang on what goes, unless it is hidden by the pane and the model is open anyway.
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a0 = face.point[k];
      const std::uint32_t b0 = face.point[k == 2 ? 0 : k + 1];
      if (is_edge_of(opening, a0, b0)) continue;
      for (const FaceId other : mesh_.faces_of[a0]) {
        if (stood_in_[other] == look_ || !mesh_.faces[other].has_point(b0)) continue;
        if (closed_ || !is_behind(mesh_, mesh_.faces[other], plane)) return std::nullopt;
      }
    }
  }
  if (is_sewn(mesh_, opening, content)) return std::nullopt;
  auto pane = pane_of(opening, plane.normal, content, 0.0, price, least_key);
  // The pane hides what one saw through an open sash.
  const double open_m2 = opening.area_m2 - std::max(front, back);
  if (pane && open_m2 > (1.0 - covered) * opening.area_m2) {
    if (pane->patch.gone.empty()) return std::nullopt;
    const double size_m = opening.size_m();
    pane->cost += open_m2 * size_m * size_m / 3.0 + mesh_.looks.cost_of_hole(open_m2);
    pane->error_m = std::max(pane->error_m, size_m);
  }
  if (closed_) return pane;
  auto behind = recess(opening, plane.normal, content, price, least_key);
  if (!pane || !behind) return pane ? std::move(pane) : std::move(behind);
  // Of two that are worth their price, the one that saves more of it.
  const auto saving = [&](const OpeningJob& j) { return price * static_cast<double>(j.patch.gone.size()) - j.cost; };
  return saving(*behind) > saving(*pane) ? std::move(behind) : std::move(pane);
}

// Bars, frames and whatever else stands in the opening give way to a pane at the depth of one of its faces; the sides
// of the opening stay. Empty if that is hardly behind the wall.
std::optional<OpeningJob> Openings::recess(const Opening& opening, const glm::dvec3& normal,
                                           const std::vector<FaceId>& content, double price, double& least_key) const {
  const Plane plane = plane_of(mesh_, opening);
  const std::vector<FaceId> sides = sides_of(mesh_, opening, plane, content);
  std::vector<FaceId> inside;
  std::set_difference(content.begin(), content.end(), sides.begin(), sides.end(), std::back_inserter(inside));
  if (inside.size() < opening.loop.size() + fewest_saved) return std::nullopt;
  double sum = 0.0;
  double whole = 0.0;
  for (const FaceId f : inside) {
    const double a = area(mesh_, f);
    whole += a;
    for (const std::uint32_t p : mesh_.faces[f].point) sum -= a * plane.height(mesh_.at(p)) / 3.0;
  }
  // In the plane of what lies nearest to the middle of all.
  double depth_m = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const FaceId f : inside) {
    const double own_m = -plane.height(mesh_.at(mesh_.faces[f].point[0]));
    const double away = std::abs(own_m - sum / whole);
    if (away >= least || glm::dot(mesh_.faces[f].normal, normal) < facing_cosine) continue;
    least = away;
    depth_m = own_m;
  }
  if (std::abs(depth_m) < least_depth_m) return std::nullopt;
  auto job = pane_of(opening, normal, inside, depth_m, price, least_key);
  if (job) job->kind = OpeningJob::Kind::Recess;
  return job;
}

// So far behind the wall; with a frame as long as that is worth its faces. Not drawn if it would cost more than the
// price whatever it looks like: then least_key is what it costs at least.
std::optional<OpeningJob> Openings::pane_of(const Opening& opening, const glm::dvec3& normal,
                                            const std::vector<FaceId>& content, double depth_m, double price,
                                            double& least_key) const {
  const Plane plane = plane_of(mesh_, opening);
  const Shape shape{mesh_, opening, normal};
  OpeningJob job{.kind = OpeningJob::Kind::Flatten};
  for (const FaceId f : content) {
    std::array<double, 3> away{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 at = mesh_.at(mesh_.faces[f].point[k]);
      const double height_m = plane.height(at) + depth_m;
      const double farthest_m = std::hypot(height_m, shape.outside_m(at));
      job.error_m = std::max(job.error_m, farthest_m);
      // What reaches under the wall is near to that where the pane is in its plane.
      away[k] = depth_m == 0.0 ? height_m : farthest_m;
    }
    job.cost += area(mesh_, f) * mean_square(away[0], away[1], away[2]);
  }
  if (const double key = job.cost / static_cast<double>(content.size()); key > price) {
    least_key = std::min(least_key, key);
    return std::nullopt;
  }
  const OpeningView view{mesh_, opening.loop, normal, content};
  // Behind the wall it may hardly stand where there was nothing.
  if (depth_m != 0.0 && view.area_between(depth_m - sheet_m, depth_m + sheet_m) < sheet_share * opening.area_m2)
    return std::nullopt;
  const Site site{mesh_, opening, normal, content, view};
  const auto with = [&](auto draw) -> std::optional<OpeningJob> {
    double look_cost = 0.0;
    auto patch = draw(site, depth_m, look_cost);
    if (!patch) return std::nullopt;
    OpeningJob made = job;
    made.patch = std::move(*patch);
    made.cost += look_cost;
    return made;
  };
  if (depth_m != 0.0) job.error_m = std::max(job.error_m, view.farthest_m(depth_m));
  // The corners of a surveyed opening do not lie in one plane.
  double warp_m = 0.0;
  for (const std::uint32_t p : opening.loop) warp_m = std::max(warp_m, std::abs(plane.height(mesh_.at(p))));
  job.error_m += warp_m;
  job.error_m = std::hypot(job.error_m, most_deviation(mesh_, content));
  auto framed = with(draw_framed_pane);
  if (framed && framed->key() <= price) return framed;
  auto whole = with(draw_pane);
  return framed && (!whole || framed->key() < whole->key()) ? std::move(framed) : std::move(whole);
}

namespace {

// The wall closes over an opening that is flush or has nothing in it. Empty if something hangs on its outline.
std::optional<OpeningJob> fill(const FacetMesh& mesh, const Opening& opening) {
  const Plane plane = plane_of(mesh, opening);
  const MaterialId material = mesh.source->face_material(opening.wall);
  std::vector<FaceId> around;
  for (const std::uint32_t p : opening.loop) {
    for (const FaceId f : mesh.faces_of[p]) {
      if (mesh.source->face_material(f) == material && lies_in(mesh, mesh.faces[f], plane.normal, plane.offset_m))
        around.push_back(f);
    }
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  std::vector<FaceId> filling;
  if (!find_filling(mesh, opening, plane, around, filling)) return std::nullopt;
  for (const std::uint32_t p : opening.loop) {
    // The ends of a notch stay, and so may what hangs on them.
    if (opening.is_notch && (p == opening.loop.front() || p == opening.loop.back())) continue;
    for (const FaceId f : mesh.faces_of[p]) {
      if (!contains(around, f) && !contains(filling, f)) return std::nullopt;
    }
  }
  OpeningJob job;
  if (!WallMaker{mesh, opening, around}.run(job.patch)) return std::nullopt;
  job.patch.gone.insert(job.patch.gone.end(), filling.begin(), filling.end());
  const double size = opening.size_m();
  job.cost = (filling.empty() ? 1.0 : look_weight) * opening.area_m2 * size * size / 3.0;
  if (filling.empty()) job.cost += mesh.looks.cost_of_hole(opening.area_m2);
  for (const FaceId f : filling) job.cost += mesh.looks.cost(mesh.source->face_material(f), material, area(mesh, f));
  job.error_m = std::hypot(size, std::max(most_deviation(mesh, around), most_deviation(mesh, filling)));
  // The outline shrinks into its first corner.
  const auto shrink = [&](const std::vector<FaceId>& faces) {
    std::vector<Merged> first;
    for (const FaceId f : faces) {
      const Face& face = mesh.faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        if (face.point[k] == opening.loop[0] && first.empty()) first.push_back({face.vertex[k], face.vertex[k]});
      }
    }
    if (first.empty()) return;
    for (const FaceId f : faces) {
      const Face& face = mesh.faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        if (std::find(opening.loop.begin(), opening.loop.end(), face.point[k]) != opening.loop.end()) {
          job.patch.merged.push_back({face.vertex[k], first[0].vertex});
        }
      }
    }
  };
  shrink(around);
  shrink(filling);
  return job;
}

double key_of(const std::optional<OpeningJob>& job) {
  return job ? job->key() : std::numeric_limits<double>::infinity();
}

}  // namespace

Openings::Openings(const FacetMesh& mesh, bool closed)
    : mesh_(mesh),
      closed_(closed),
      walls_(mesh),
      cells_(mesh),
      looked_at_(mesh.faces.size(), 0),
      stood_in_(mesh.faces.size(), 0),
      asked_(mesh.point_count()) {}

void Openings::update() { cells_.update(walls_.update()); }

// All that a pane may be made of.
FloatBox Openings::box_of(const Opening& opening) const {
  const Plane plane = plane_of(mesh_, opening);
  FloatBox box;
  for (const std::uint32_t p : opening.loop) {
    box.add(glm::vec3{mesh_.at(p) - plane.normal * most_depth_m});
    box.add(glm::vec3{mesh_.at(p) + plane.normal * most_height_m});
  }
  box.low -= static_cast<float>(margin_m);
  box.high += static_cast<float>(margin_m);
  return box;
}

std::optional<OpeningJob> Openings::job(const Opening& opening, double price, double most_error_m) {
  if (!mesh_.faces[opening.wall].live) return std::nullopt;
  // What is far from the price is not looked at anew whenever something near it changes.
  if (const auto at = known_.find(opening.loop);
      at != known_.end() && std::isfinite(at->second.key) && at->second.key > look_ahead * price) {
    return std::nullopt;
  }
  std::uint64_t state = cells_.last_change(box_of(opening));
  for (const std::uint32_t p : opening.loop) state = 31 * state + mesh_.version[p];
  Known& known = known_[opening.loop];
  if (known.state == state && known.key > price) return std::nullopt;
  auto pane = flatten(opening, price, known);
  // Once: between the two sides of a solid wall a pane would come and go for ever.
  if (pane && pane->patch.gone.empty() && known.has_come) pane.reset();
  auto closing = fill(mesh_, opening);
  known.pane_key = std::min(known.pane_key, key_of(pane));
  known.state = state;
  known.key = std::min(known.pane_key, key_of(closing));
  const auto fits = [&](const auto& job) { return job && job->key() <= price && job->error_m <= most_error_m; };
  if (fits(pane)) {
    known.has_come = known.has_come || pane->patch.gone.empty();
    return pane;
  }
  if (fits(closing)) return closing;
  return std::nullopt;
}

}  // namespace lodestone::facets
