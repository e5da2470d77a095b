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
constexpr double detail_arm_m = 0.17;    // a tilt counts like so much distance times its sine
constexpr double plane_arm_m = 9.0;
constexpr double outline_weight = 0.2;  // of a material's outline, beside that of a hole
constexpr double growth_weight = 3.0;   // where a hole or the rarer material grows: windows shrink, walls do not
constexpr double side_weight = 0.8;     // of a face that shrinks to nothing: its mean squared way over the largest
constexpr double drift_weight = 3.0;
constexpr double flip_cosine = 0.2;
constexpr double one_side_cosine = 0.95;

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
    const double arm = sine * (detail ? detail_arm_m : plane_arm_m);
    verdict.cost += 0.5 * length * arm * arm;
  }
  return true;
}

// Edges at a point that are borders or where materials meet.
struct Spoke {
  std::uint32_t to = none;
  std::uint32_t faces = 0;
  MaterialId material = none;
  bool mixed = false;
  bool border = true;    // all faces lie on one side of it: one face, or sheets that lie on each other
  glm::dvec3 side{0.0};  // from the edge into the first face, unit
};

glm::dvec3 side_of(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& apex) {
  const glm::dvec3 along = to - from;
  const double length2 = glm::dot(along, along);
  const glm::dvec3 side = apex - from - along * (length2 > 0.0 ? glm::dot(apex - from, along) / length2 : 0.0);
  const double length = glm::length(side);
  return length > line_height_m ? side / length : glm::dvec3{0.0};
}

void find_spokes(const FacetMesh& mesh, std::uint32_t u, std::vector<Spoke>& spokes) {
  spokes.clear();
  for (const FaceId f : mesh.faces_of[u]) {
    const MaterialId material = mesh.source->face_material(f);
    const auto& p = mesh.faces[f].point;
    const std::size_t k = p[0] == u ? 0 : p[1] == u ? 1 : 2;
    const std::uint32_t a = p[k == 2 ? 0 : k + 1];
    const std::uint32_t b = p[k == 0 ? 2 : k - 1];
    spokes.push_back({a, 1, material, false, true, side_of(mesh.at(u), mesh.at(a), mesh.at(b))});
    spokes.push_back({b, 1, material, false, true, side_of(mesh.at(u), mesh.at(b), mesh.at(a))});
  }
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) { return a.to < b.to; });
  std::size_t end = 0;
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (end > 0 && spokes[end - 1].to == spokes[i].to) {
      ++spokes[end - 1].faces;
      Spoke& spoke = spokes[end - 1];
      spoke.mixed = spoke.mixed || spoke.material != spokes[i].material;
      spoke.border = spoke.border && glm::dot(spoke.side, spokes[i].side) > one_side_cosine;
    } else {
      spokes[end++] = spokes[i];
    }
  }
  spokes.resize(end);
}

// The faces around u and v must have no common neighbours but the third corners of the faces between them, or sheets
// would stick together. Asked only where both are manifold.
bool link_holds(const FacetMesh& mesh, const std::vector<Spoke>& spokes, std::uint32_t u, std::uint32_t v) {
  std::uint32_t shared = 0;
  for (const Spoke& s : spokes) {
    if (s.faces > 2) return true;
    if (s.to == v) shared = s.faces;
  }
  thread_local std::vector<Spoke> others;
  find_spokes(mesh, v, others);
  std::uint32_t common = 0;
  auto at = spokes.begin();
  for (const Spoke& s : others) {
    if (s.faces > 2) return true;
    while (at != spokes.end() && at->to < s.to) ++at;
    if (at != spokes.end() && at->to == s.to && s.to != u) ++common;
  }
  if (spokes.size() == 3 && others.size() == 3 && shared == 2) return false;
  return common == shared;
}

double segment_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  return std::sqrt(squared_distance_to_segment(p, a, b));
}

// Whether the faces around lose area (a hole grows), or the material that is rarer in the whole building gains area on
// the other ones (a window grows).
bool goes_the_wrong_way(const FacetMesh& mesh, const Moved& moved, bool border) {
  MaterialId common = none;
  double gain = 0.0;
  double rare_gain = 0.0;  // of all others than the most common material
  const auto area = [&](MaterialId m) { return mesh.material_area_m2[m]; };
  for (const FaceId f : moved.faces()) {
    const MaterialId m = mesh.source->face_material(f);
    if (common == none || area(m) > area(common)) common = m;
  }
  for (const FaceId f : moved.faces()) {
    const auto& p = mesh.faces[f].point;
    const glm::dvec3 after = glm::cross(moved.at(p[1]) - moved.at(p[0]), moved.at(p[2]) - moved.at(p[0]));
    const double more = glm::length(after) - glm::length(mesh.area_vector(mesh.faces[f]));
    gain += more;
    if (mesh.source->face_material(f) != common) rare_gain += more;
  }
  return border ? gain < -1e-6 : rare_gain > 1e-6;
}

// How far the lines through u leave their place when u goes to v.
void judge_lines(const FacetMesh& mesh, const Moved& moved, const std::vector<Spoke>& spokes, std::uint32_t u,
                 std::uint32_t v, Verdict& verdict) {
  const glm::dvec3 from = mesh.at(u);
  const glm::dvec3 to = mesh.at(v);
  double v_to_old = std::numeric_limits<double>::infinity();
  bool any = false;
  bool border = false;
  for (const Spoke& s : spokes) {
    if (!s.border && !s.mixed) continue;
    any = true;
    border = border || s.border;
    v_to_old = std::min(v_to_old, s.to == v ? 0.0 : segment_distance(to, mesh.at(s.to), from));
  }
  if (!any) return;
  verdict.error_m = std::max(verdict.error_m, v_to_old);
  double swept = 0.0;
  bool ends = true;
  for (const Spoke& s : spokes) {
    if ((!s.border && !s.mixed) || s.to == v) continue;
    ends = false;
    const glm::dvec3 w = mesh.at(s.to);
    const double away = std::max(segment_distance(from, w, to), v_to_old);
    swept += 0.5 * glm::length(glm::cross(w - from, to - from)) * away * away / 3.0;
    verdict.error_m = std::max(verdict.error_m, away);
  }
  // A line that ends here shrinks.
  if (ends) verdict.error_m = std::max(verdict.error_m, glm::length(to - from));
  verdict.cost += swept * (goes_the_wrong_way(mesh, moved, border) ? growth_weight : border ? 1.0 : outline_weight);
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
  verdict.cost += 0.5 * glm::length(mesh.area_vector(face)) * away * away / 3.0;
  verdict.error_m = std::max(verdict.error_m, away);
}

void add_deviation(const FacetMesh& mesh, std::span<const Move> moves, Verdict& verdict) {
  double before = 0.0;
  for (const Move& m : moves) before = std::max(before, double{mesh.deviation_m[m.point]});
  verdict.error_m = std::hypot(verdict.error_m, before);
}

}  // namespace

Verdict judge_slide(const FacetMesh& mesh, Moved& moved, const Move& move, double most_cost) {
  Verdict verdict;
  moved.set({&move, 1});
  for (const FaceId f : moved.faces()) {
    const Face& face = mesh.faces[f];
    const auto& p = face.point;
    if (p[0] == move.onto || p[1] == move.onto || p[2] == move.onto) {
      ++verdict.faces_gone;
      judge_loss(mesh, face, move.point, move.onto, verdict);
      continue;
    }
    const double height = height_m(moved.at(p[0]), moved.at(p[1]), moved.at(p[2]));
    if (height < line_height_m && height_m(mesh.at(p[0]), mesh.at(p[1]), mesh.at(p[2])) > sliver_m) return verdict;
    if (!judge_face(mesh, moved, face, verdict) || verdict.cost > most_cost) return verdict;
  }
  thread_local std::vector<Spoke> spokes;
  find_spokes(mesh, move.point, spokes);
  judge_lines(mesh, moved, spokes, move.point, move.onto, verdict);
  add_deviation(mesh, {&move, 1}, verdict);
  verdict.allowed =
      verdict.faces_gone != 0 && verdict.cost <= most_cost && link_holds(mesh, spokes, move.point, move.onto);
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
    verdict.cost += 0.5 * glm::length(mesh.area_vector(face)) * way * way * side_weight;
    verdict.error_m = std::max(verdict.error_m, way);
  }
  add_deviation(mesh, moves, verdict);
  verdict.allowed = verdict.faces_gone != 0;
  return verdict;
}

}  // namespace lodestone::facets
