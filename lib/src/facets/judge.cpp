// SPDX-License-Identifier: MIT
#include "facets/judge.h"

#include <algorithm>
#include <cmath>

#include "geometry/distance.h"

namespace lodestone::facets {
namespace {

constexpr double sliver_m = 5e-4;        // a flatter face has no direction worth keeping
constexpr double tilt_sine = 0.0075;     // 0.43 degrees are no tilt
constexpr double detail_area_m2 = 0.25;  // planes smaller than this may tilt at a low price
constexpr double detail_arm_m = 0.19;    // a tilt counts like so much distance times its sine
constexpr double plane_arm_m = 9.0;
constexpr double linear_sine = 0.12;    // up to there the cost grows with the sine, beyond with its square
constexpr double outline_weight = 0.2;  // of a material's outline, beside that of a hole
constexpr double growth_weight = 3.0;   // where a hole or the rarer material grows: windows shrink, walls do not
constexpr double side_weight = 0.8;     // of a face that shrinks to nothing: its mean squared way over the largest
constexpr double drift_weight = 3.0;
constexpr double flip_cosine = 0.2;
constexpr double one_side_cosine = 0.95;

// Per area. Small tilts of large planes count more than by their square: they are seen in the light on a wall.
double tilt_cost(double sine, bool detail) {
  if (detail) return sine * sine * detail_arm_m * detail_arm_m;
  return sine * std::max(sine, linear_sine) * plane_arm_m * plane_arm_m;
}

// Adds what happens to one face that keeps three corners; false if it must not.
bool judge_face(const FacetMesh& mesh, const Moved& moved, const Face& face, Verdict& verdict) {
  const auto& p = face.point;
  const std::array<glm::dvec3, 3> to{moved.at(p[0]), moved.at(p[1]), moved.at(p[2])};
  const glm::dvec3 after = glm::cross(to[1] - to[0], to[2] - to[0]);
  const double length = glm::length(after);
  const double height = height_m(to[0], to[1], to[2]);
  const double height_before = height_m(mesh.at(p[0]), mesh.at(p[1]), mesh.at(p[2]));
  if (height > sliver_m && height_before > sliver_m) {
    const glm::dvec3 before = mesh.area_vector(face);
    if (glm::dot(before, after) < flip_cosine * glm::length(before) * length) return false;
  }
  std::array<double, 3> distance{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!moved.moves(p[k])) continue;
    distance[k] = glm::dot(face.normal, to[k] - mesh.at(p[k]));
    verdict.error_m = std::max(verdict.error_m, std::abs(distance[k]));
  }
  verdict.cost += 0.5 * length * mean_square(distance[0], distance[1], distance[2]);
  // What strayed before strays further: (a + b)^2 is more than a^2 + b^2.
  for (std::size_t k = 0; k < 3; ++k) {
    if (!moved.moves(p[k])) continue;
    verdict.cost += drift_weight * 0.5 * length * std::abs(distance[k]) * double{mesh.deviation_m[p[k]]} / 3.0;
  }
  const double sine = glm::length(glm::cross(face.normal, after)) / std::max(length, 1e-30);
  if (sine > tilt_sine && height > sliver_m) {
    verdict.tilts = true;
    const bool detail = mesh.surfaces.surfaces[face.surface].area_m2 < detail_area_m2;
    verdict.cost += 0.5 * length * tilt_cost(sine, detail);
  }
  return true;
}

glm::dvec3 side_of(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& apex) {
  const glm::dvec3 along = to - from;
  const double length2 = glm::dot(along, along);
  const glm::dvec3 side = apex - from - along * (length2 > 0.0 ? glm::dot(apex - from, along) / length2 : 0.0);
  const double length = glm::length(side);
  return length > line_height_m ? side / length : glm::dvec3{0.0};
}

double longest_squared(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
}

// Of a triangle with twice that area.
bool is_taller(double twice_area_m2, double longest_squared_m2, double height_m) {
  return twice_area_m2 * twice_area_m2 > height_m * height_m * longest_squared_m2;
}

double segment_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  return std::sqrt(squared_distance_to_segment(p, a, b));
}

// A face between u and v goes. Where no other face keeps the line from its third corner to v, all of it is lost.
void judge_loss(const FacetMesh& mesh, const Face& face, std::uint32_t u, std::uint32_t v, Verdict& verdict) {
  const auto has = [](const Face& f, std::uint32_t p) { return f.point[0] == p || f.point[1] == p || f.point[2] == p; };
  const std::uint32_t w = *std::find_if(face.point.begin(), face.point.end(), [&](auto p) { return p != u && p != v; });
  bool rests = false;  // w stays
  for (const FaceId f : mesh.faces_of[w]) {
    const bool at_u = has(mesh.faces[f], u);
    const bool at_v = has(mesh.faces[f], v);
    if (at_u != at_v) return;
    rests = rests || !at_u;
  }
  const double away = glm::length(mesh.at(w) - mesh.at(v)) * (rests ? 0.5 : 1.0);
  verdict.cost += mesh.area_m2(face) * away * away / 3.0;
  verdict.error_m = std::max(verdict.error_m, away);
}

void add_deviation(const FacetMesh& mesh, std::span<const Move> moves, Verdict& verdict) {
  double before = 0.0;
  for (const Move& m : moves) before = std::max(before, double{mesh.deviation_m[m.point]});
  verdict.error_m = std::hypot(verdict.error_m, before);
}

}  // namespace

void SlideJudge::look_at(std::uint32_t point) {
  from_ = mesh_.at(point);
  point_ = point;
  faces_.clear();
  spokes_.clear();
  outlines_.clear();
  ratio_ = 1.0;
  for (const FaceId f : mesh_.faces_of[point]) {
    const Face& face = mesh_.faces[f];
    ratio_ = std::max(ratio_, pieces_.ratio(f));
    const auto& p = face.point;
    const std::size_t k = p[0] == point ? 0 : p[1] == point ? 1 : 2;
    SlidingFace s;
    s.face = &face;
    s.a = p[k == 2 ? 0 : k + 1];
    s.b = p[k == 0 ? 2 : k - 1];
    s.at_a = mesh_.at(s.a);
    s.at_b = mesh_.at(s.b);
    s.before = glm::cross(s.at_a - from_, s.at_b - from_);
    s.length_before = glm::length(s.before);
    s.tall_before = is_taller(s.length_before, longest_squared(from_, s.at_a, s.at_b), sliver_m);
    s.material = mesh_.source->face_material(f);
    s.detail = mesh_.surfaces.surfaces[face.surface].area_m2 < detail_area_m2;
    s.outline = outline_of(s);
    spokes_.push_back({s.a, 1, s.material, none, false, true, side_of(from_, s.at_a, s.at_b)});
    spokes_.push_back({s.b, 1, s.material, none, false, true, side_of(from_, s.at_b, s.at_a)});
    faces_.push_back(s);
  }
  join_spokes();
}

// Area that a plane shows of one material, gained or lost: what slides within an outline or along a crease adds up to
// nothing.
std::size_t SlideJudge::outline_of(const SlidingFace& s) {
  const std::pair key{s.face->surface, s.material};
  const auto at = std::find(outlines_.begin(), outlines_.end(), key);
  if (at != outlines_.end()) return static_cast<std::size_t>(at - outlines_.begin());
  outlines_.push_back(key);
  return outlines_.size() - 1;
}

void SlideJudge::join_spokes() {
  std::sort(spokes_.begin(), spokes_.end(), [](const Spoke& a, const Spoke& b) { return a.to < b.to; });
  std::size_t end = 0;
  for (const Spoke& next : spokes_) {
    if (end > 0 && spokes_[end - 1].to == next.to) {
      Spoke& spoke = spokes_[end - 1];
      ++spoke.faces;
      if (spoke.material != next.material) {
        spoke.mixed = true;
        spoke.other = next.material;
      }
      spoke.border = spoke.border && glm::dot(spoke.side, next.side) > one_side_cosine;
    } else {
      spokes_[end++] = next;
    }
  }
  spokes_.resize(end);
  lines_ = std::any_of(spokes_.begin(), spokes_.end(), [](const Spoke& s) { return s.border || s.mixed; });
  complex_ = std::any_of(spokes_.begin(), spokes_.end(), [](const Spoke& s) { return s.faces > 2; });
}

// Adds what happens to one face that keeps its corners; false if it must not.
bool SlideJudge::judge_face(SlidingFace& s, const glm::dvec3& to, double deviation_m, Verdict& verdict) {
  const glm::dvec3 after = glm::cross(s.at_a - to, s.at_b - to);
  const double length = glm::length(after);
  s.length_after = length;
  shown_m2_[s.outline] += 0.5 * glm::dot(s.face->normal, after - s.before);
  const double longest2 = longest_squared(to, s.at_a, s.at_b);
  const bool tall = is_taller(length, longest2, sliver_m);
  if (s.tall_before) {
    if (!is_taller(length, longest2, line_height_m)) return false;
    if (tall && glm::dot(s.before, after) < flip_cosine * s.length_before * length) return false;
  }
  const double distance = std::abs(glm::dot(s.face->normal, to - from_));
  verdict.error_m = std::max(verdict.error_m, distance);
  // What strayed before strays further: (a + b)^2 is more than a^2 + b^2.
  verdict.cost += 0.5 * length * (mean_square(distance, 0.0, 0.0) + drift_weight * distance * deviation_m / 3.0);
  if (!tall) return true;
  const glm::dvec3 across = glm::cross(s.face->normal, after);
  const double sine2 = glm::dot(across, across) / (length * length);
  if (sine2 > tilt_sine * tilt_sine) {
    verdict.tilts = true;
    verdict.cost += 0.5 * length * tilt_cost(std::sqrt(sine2), s.detail);
  }
  return true;
}

// Whether the faces around lose area (a hole grows), or the material that is rarer in the whole building gains area on
// the other ones (a window grows).
bool SlideJudge::goes_the_wrong_way(bool border) const {
  MaterialId common = none;
  double gain = 0.0;
  double rare_gain = 0.0;  // of all others than the most common material
  const auto area = [&](MaterialId m) { return mesh_.material_area_m2[m]; };
  for (const SlidingFace& s : faces_) {
    if (common == none || area(s.material) > area(common)) common = s.material;
  }
  for (const SlidingFace& s : faces_) {
    const double more = s.length_after - s.length_before;
    gain += more;
    if (s.material != common) rare_gain += more;
  }
  return border ? gain < -1e-6 : rare_gain > 1e-6;
}

// Whether an outline of a material would come to touch another one across what lies between.
bool SlideJudge::pinches(std::uint32_t v) const {
  const auto edge = std::find_if(spokes_.begin(), spokes_.end(), [v](const Spoke& s) { return s.to == v; });
  if (edge == spokes_.end() || edge->border || edge->mixed) return false;
  const auto& around = mesh_.faces_of[v];
  return std::any_of(around.begin(), around.end(),
                     [&](FaceId f) { return mesh_.source->face_material(f) != edge->material; });
}

// How far the lines through the point leave their place when it goes to v.
void SlideJudge::judge_lines(std::uint32_t v, Verdict& verdict) const {
  const glm::dvec3 to = mesh_.at(v);
  double v_to_old = std::numeric_limits<double>::infinity();
  bool border = false;
  for (const Spoke& s : spokes_) {
    if (!s.border && !s.mixed) continue;
    border = border || s.border;
    v_to_old = std::min(v_to_old, s.to == v ? 0.0 : segment_distance(to, mesh_.at(s.to), from_));
  }
  verdict.error_m = std::max(verdict.error_m, v_to_old);
  const double pinch_m = pinches(v) ? glm::length(to - from_) : 0.0;
  double swept = 0.0;
  bool ends = true;
  for (const Spoke& s : spokes_) {
    if ((!s.border && !s.mixed) || s.to == v) continue;
    ends = false;
    const glm::dvec3 w = mesh_.at(s.to);
    const double away = std::max({segment_distance(from_, w, to), v_to_old, pinch_m});
    const double area_m2 = 0.5 * glm::length(glm::cross(w - from_, to - from_));
    swept += area_m2 * away * away / 3.0;
    if (s.mixed) verdict.cost += mesh_.looks.cost(s.material, s.other, area_m2);
    verdict.error_m = std::max(verdict.error_m, away);
  }
  // A line that ends here shrinks.
  if (ends) verdict.error_m = std::max(verdict.error_m, glm::length(to - from_));
  verdict.cost += swept * (goes_the_wrong_way(border) ? growth_weight : border ? 1.0 : outline_weight);
}

// The faces around both ends must have no common neighbours but the third corners of the faces between them, or sheets
// would stick together. Asked only where both are manifold.
bool SlideJudge::link_holds(std::uint32_t v) {
  if (complex_) return true;
  others_.clear();
  for (const FaceId f : mesh_.faces_of[v]) {
    for (const std::uint32_t p : mesh_.faces[f].point) {
      if (p != v) others_.push_back(p);
    }
  }
  std::sort(others_.begin(), others_.end());
  std::uint32_t common = 0;
  std::uint32_t count = 0;
  auto at = spokes_.begin();
  for (std::size_t i = 0; i < others_.size();) {
    const std::uint32_t to = others_[i];
    std::size_t end = i;
    while (end < others_.size() && others_[end] == to) ++end;
    if (end - i > 2) return true;
    i = end;
    ++count;
    while (at != spokes_.end() && at->to < to) ++at;
    if (at != spokes_.end() && at->to == to && to != point_) ++common;
  }
  const auto edge = std::find_if(spokes_.begin(), spokes_.end(), [v](const Spoke& s) { return s.to == v; });
  const std::uint32_t shared = edge == spokes_.end() ? 0 : edge->faces;
  if (spokes_.size() == 3 && count == 3 && shared == 2) return false;
  return common == shared;
}

Verdict SlideJudge::judge(std::uint32_t onto, double most_cost) {
  Verdict verdict;
  const glm::dvec3 to = mesh_.at(onto);
  const double deviation_m = mesh_.deviation_m[point_];
  shown_m2_.assign(outlines_.size(), 0.0);
  for (SlidingFace& s : faces_) {
    if (s.a == onto || s.b == onto) {
      ++verdict.faces_gone;
      s.length_after = 0.0;
      shown_m2_[s.outline] -= 0.5 * glm::dot(s.face->normal, s.before);
      judge_loss(mesh_, *s.face, point_, onto, verdict);
    } else if (!judge_face(s, to, deviation_m, verdict) || verdict.cost > most_cost) {
      return verdict;
    }
  }
  double changed_m2 = 0.0;
  for (const double more_m2 : shown_m2_) changed_m2 += std::abs(more_m2);
  verdict.cost += 0.5 * mesh_.looks.cost_of_hole(changed_m2);
  if (verdict.cost > most_cost) return verdict;
  if (lines_) judge_lines(onto, verdict);
  verdict.cost *= ratio_;
  verdict.error_m = std::hypot(verdict.error_m, deviation_m);
  verdict.allowed = verdict.faces_gone != 0 && verdict.cost <= most_cost && link_holds(onto);
  return verdict;
}

Verdict judge_shift(const FacetMesh& mesh, Moved& moved, std::span<const Move> moves) {
  Verdict verdict;
  moved.set(moves);
  for (const FaceId f : moved.faces()) {
    const Face& face = mesh.faces[f];
    const auto& p = face.point;
    const bool gone = moved.point(p[0]) == moved.point(p[1]) || moved.point(p[1]) == moved.point(p[2]) ||
                      moved.point(p[2]) == moved.point(p[0]);
    if (!gone) {
      if (!judge_face(mesh, moved, face, verdict)) return verdict;
      continue;
    }
    // Its points lie up to the way of its corners from what is left.
    ++verdict.faces_gone;
    double way = 0.0;
    for (const std::uint32_t q : p) way = std::max(way, glm::length(moved.at(q) - mesh.at(q)));
    verdict.cost += mesh.area_m2(face) * way * way * side_weight;
    verdict.error_m = std::max(verdict.error_m, way);
  }
  add_deviation(mesh, moves, verdict);
  verdict.allowed = verdict.faces_gone != 0;
  return verdict;
}

}  // namespace lodestone::facets
