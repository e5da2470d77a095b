// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998; Dey et al. 1999 (link condition); Garland and Heckbert 1997 (flips, contacts).
// Differs: the link condition is asked only where both rings are manifold, so that soup reduces too.
#include "collapse/collapser.h"

#include <algorithm>
#include <cmath>

#include "collapse/weights.h"

namespace lodestone::collapse {

constexpr double infinity = std::numeric_limits<double>::infinity();

Refusal Collapser::attempt(std::uint32_t u, std::uint32_t v, std::uint32_t key, double cost_limit) {
  cost_limit_ = cost_limit;
  const WorkingMesh& mesh = state_.mesh;
  if (((mesh.flags[u] | mesh.flags[v]) & point_locked) != 0) return Refusal::Busy;
  const std::uint32_t faces = mesh.first[u + 1] - mesh.first[u] + mesh.first[v + 1] - mesh.first[v];
  if (faces > most_star_faces) return Refusal::Crowded;
  gather_star(mesh, u, v, star_);
  if (star_.shared == 0) return Refusal::Busy;  // an earlier collapse took the faces between
  if (const Refusal refusal = check_topology(); refusal != Refusal::None) return refusal;
  if (const Refusal refusal = choose_ends(); refusal != Refusal::None) return refusal;
  if (const Refusal refusal = choose_place(); refusal != Refusal::None) return refusal;
  commit(key);
  return Refusal::None;
}

Refusal Collapser::check_topology() {
  const WorkingMesh& mesh = state_.mesh;
  const std::uint8_t fu = mesh.flags[star_.u];
  const std::uint8_t fv = mesh.flags[star_.v];
  if (((fu | fv) & point_complex) == 0 && !state_.loose) {
    if ((fu & fv & point_border) != 0 && star_.shared != 1) return Refusal::Link;
    if (!link_holds()) return Refusal::Link;
  }
  const bool open = ((fu | fv) & (point_border | point_complex)) != 0;
  lost_.clear();
  if ((open || state_.loose) && !apexes_stay()) return Refusal::Border;
  if (state_.loose && !state_.keeps_twins) find_twins();
  return groups_stay() ? Refusal::None : Refusal::Frozen;
}

bool Collapser::groups_stay() {
  if (state_.options.material_groups.empty()) return true;
  going_.clear();
  for (const StarFace& f : star_.faces) {
    if (f.side == Side::Both || f.twin) going_.push_back(state_.mesh.faces[f.index].id);
  }
  return state_.last_faces.may_go(going_, region_);
}

bool Collapser::link_holds() {
  // A tetrahedron would fold into two coincident faces.
  if (star_.faces_of_u == 3 && star_.faces_of_v == 3 && star_.shared == 2) return false;
  const std::uint32_t seen = ++stamp_;
  const std::uint32_t counted = ++stamp_;
  std::uint32_t common = 0;
  for (const StarFace& f : star_.faces) {
    if (f.side != Side::V) {
      state_.stamps[f.a] = seen;
      state_.stamps[f.b] = seen;
      continue;
    }
    for (const std::uint32_t p : {f.a, f.b}) {
      if (state_.stamps[p] != seen) continue;
      state_.stamps[p] = counted;
      ++common;
    }
  }
  // The apex of a face on the border may be met from v by that face alone.
  for (const StarFace& f : star_.faces) {
    if (f.side != Side::Both) continue;
    const std::uint32_t apex = f.a == star_.v ? f.b : f.a;
    if (state_.stamps[apex] == seen) {
      state_.stamps[apex] = counted;
      ++common;
    }
  }
  return common == star_.shared;
}

// False if the third corner of a face on the edge would lose its last face. In the end it may, at the price of that
// face: triangles that hang on a point alone could never go otherwise.
bool Collapser::apexes_stay() {
  const WorkingMesh& mesh = state_.mesh;
  for (const StarFace& f : star_.faces) {
    if (f.side != Side::Both) continue;
    const std::uint32_t apex = f.a == star_.v ? f.b : f.a;
    bool stays = false;
    for (std::uint32_t i = mesh.first[apex]; i != mesh.first[apex + 1] && !stays; ++i) {
      const Face& other = mesh.faces[mesh.corners[i] >> 2U];
      const auto has = [&](std::uint32_t p) { return corner_at(other, p) != 2 || other.point[2] == p; };
      stays = other.id != none && !(has(star_.u) && has(star_.v));
    }
    if (stays) continue;
    if (!state_.last_resort || (mesh.flags[apex] & point_frozen) != 0) return false;
    lost_.push_back({apex, f.a == star_.v ? f.at_b : f.at_a, glm::dot(f.normal, f.normal)});
  }
  // Something must be left for the point that stays.
  return star_.faces.size() > star_.shared;
}

// Where two sheets fold onto each other one of them is enough, unless it can be told which side is seen.
void Collapser::find_twins() {
  for (std::size_t i = 0; i < star_.faces.size(); ++i) {
    StarFace& f = star_.faces[i];
    if (f.side == Side::Both) continue;
    const FaceId id = state_.mesh.faces[f.index].id;
    for (std::size_t j = 0; j < i && !f.twin; ++j) {
      const StarFace& other = star_.faces[j];
      if (other.side == Side::Both || other.twin) continue;
      const bool same = other.a == f.a && other.b == f.b;
      if (!same && (other.a != f.b || other.b != f.a)) continue;
      const MaterialId material = state_.source.face_material(id);
      f.twin = material == state_.source.face_material(state_.mesh.faces[other.index].id) &&
               (same || state_.source.materials[material].double_sided);
    }
  }
}

void Collapser::find_lines() {
  spokes_.clear();
  for (const StarFace& f : star_.faces) {
    const std::uint32_t near = f.side == Side::V ? star_.v : star_.u;
    const glm::dvec3 at = f.side == Side::V ? star_.e : glm::dvec3{0.0};
    add_spoke(near, f.a, f.at_a - at, f);
    add_spoke(near, f.b, f.at_b - at, f);
    if (f.side != Side::Both) continue;
    const bool a_is_v = f.a == star_.v;
    add_spoke(star_.v, a_is_v ? f.b : f.a, (a_is_v ? f.at_b : f.at_a) - star_.e, f);
  }
  for (const Spoke& s : spokes_) {
    const bool line = s.faces != 2 || (state_.looks_matter && looks_differ(s));
    if (line) star_.lines.push_back({s.from, s.to, s.direction});
  }
}

void Collapser::add_spoke(std::uint32_t from, std::uint32_t to, const glm::dvec3& direction, const StarFace& face) {
  for (Spoke& s : spokes_) {
    if (s.from != from || s.to != to) continue;
    s.second = &face;
    ++s.faces;
    return;
  }
  spokes_.push_back({from, to, 1, direction, &face, nullptr});
}

bool Collapser::looks_differ(const Spoke& spoke) const {
  const WorkingMesh& mesh = state_.mesh;
  return seam_between(mesh, state_.source, mesh.faces[spoke.first->index], mesh.faces[spoke.second->index], spoke.from,
                      spoke.to);
}

// Whether the two faces on the edge meet at more than the given angle.
bool Collapser::edge_is_sharp() const {
  glm::dvec3 unit[2] = {glm::dvec3{0.0}, glm::dvec3{0.0}};
  int found = 0;
  for (const StarFace& f : star_.faces) {
    const double length = glm::length(f.normal);
    if (f.side == Side::Both && found < 2 && length > 0.0) unit[found++] = f.normal / length;
  }
  return found == 2 && glm::dot(unit[0], unit[1]) < std::cos(state_.options.sharp_edge_rad);
}

Refusal Collapser::choose_ends() {
  const std::uint8_t fu = state_.mesh.flags[star_.u];
  const std::uint8_t fv = state_.mesh.flags[star_.v];
  u_fixed_ = (fu & (point_frozen | point_corner)) != 0;
  v_fixed_ = (fv & (point_frozen | point_corner)) != 0;
  if (((fu | fv) & point_sharp) != 0 && !edge_is_sharp()) {
    u_fixed_ = u_fixed_ || (fu & point_sharp) != 0;
    v_fixed_ = v_fixed_ || (fv & point_sharp) != 0;
  }
  if (u_fixed_ && v_fixed_) return Refusal::Frozen;
  u_may_go_ = !u_fixed_;
  v_may_go_ = !v_fixed_;
  return Refusal::None;
}

bool Collapser::try_place(const glm::dvec3& y) {
  if (!held_.allow(y, star_)) return false;
  const glm::dvec3 origin{state_.mesh.position[star_.u]};
  const bool at_u = y == glm::dvec3{0.0};
  const bool at_v = y == star_.e;
  choice_.place = at_u   ? glm::vec3{state_.mesh.position[star_.u]}
                  : at_v ? glm::vec3{state_.mesh.position[star_.v]}
                         : glm::vec3{origin + y};
  choice_.relative = glm::dvec3{choice_.place} - origin;
  const Fit fit = fit_at(star_, choice_.relative);
  if (!fit.upright) return false;
  choice_.squared_distance = fit.squared_distance;
  bool keep_u = at_u ? true : at_v ? false : star_.faces_of_u >= star_.faces_of_v;
  if (!u_may_go_) keep_u = true;
  if (!v_may_go_) keep_u = false;
  choice_.kept = keep_u ? star_.u : star_.v;
  choice_.gone = keep_u ? star_.v : star_.u;
  choice_.moves = !(keep_u ? at_u : at_v);
  choice_.cost = quadric_.cost(choice_.relative);
  for (const Lost& lost : lost_) {
    const glm::dvec3 way = choice_.relative - lost.at;
    choice_.cost += lost.weight * glm::dot(way, way);
  }
  return true;
}

Refusal Collapser::choose_place() {
  const Placement placement = state_.options.placement;
  const bool ends_only = placement == Placement::EndPoint || placement == Placement::Subset;
  if (ends_only && !fit_at(star_, star_.e).upright && !fit_at(star_, glm::dvec3{0.0}).upright) return Refusal::Flip;
  if (!star_.plain) find_lines();
  quadric_ = sum_star(star_, state_.line_weight, state_.mesh.weight_at(star_.u), state_.mesh.weight_at(star_.v));
  if (!state_.options.face_planes.empty()) {
    held_.look_at(star_, state_.mesh, state_.options, state_.diagonal_m);
    if (!held_.meet()) return Refusal::Plane;
  }
  const bool steered = state_.options.plane_arm_m > 0.0 && !state_.options.face_planes.empty();
  if (steered) turns_ = sum_turns(star_, state_.mesh, state_.options);
  const StarQuadric aim = steered ? quadric_ + turns_ : quadric_;
  // A place where the end that cannot go, or may not move, already is.
  const bool must_u = u_fixed_ || (ends_only && !u_may_go_);
  const bool must_v = v_fixed_ || (ends_only && !v_may_go_);
  const glm::dvec3 zero{0.0};
  bool found = false;
  if (must_u || must_v) {
    found = try_place(must_u ? zero : star_.e);
  } else {
    found = try_place(held_.empty() ? best_place(star_, aim, placement) : held_.best_place(star_, aim, placement));
    const bool u_better = aim.cost(zero) <= aim.cost(star_.e);
    if (!found) found = try_place(u_better ? zero : star_.e);
    if (!found) found = try_place(u_better ? star_.e : zero);
  }
  if (!found) return held_.empty() ? Refusal::Flip : Refusal::Plane;
  const double turn_cost = steered ? turns_.cost(choice_.relative) : 0.0;
  cost_ = choice_.cost + turn_cost;
  if (cost_ > cost_limit_) return Refusal::Cost;
  cost_ += wedges_.plan(star_, choice_);
  if (cost_ > cost_limit_) return Refusal::Cost;
  error_m_ = error_m(choice_.cost);
  const float limited_m = steered ? error_m(choice_.cost + turn_cost) : error_m_;
  if (!(limited_m > state_.options.max_error_m)) return Refusal::None;
  cost_ = infinity;
  return Refusal::Cost;
}

float Collapser::error_m(double cost) const {
  const double before = std::max(state_.mesh.deviation_m[star_.u], state_.mesh.deviation_m[star_.v]);
  const double mean = quadric_.weight > 0.0 ? cost / quadric_.weight : 0.0;
  const glm::dvec3 from_v = choice_.relative - star_.e;
  // No point of the surface goes further than the end it hangs on.
  const double travel = std::max(glm::dot(choice_.relative, choice_.relative), glm::dot(from_v, from_v));
  double added = std::min(std::max(error_growth * mean, choice_.squared_distance), travel);
  for (const Lost& lost : lost_) {
    const glm::dvec3 way = choice_.relative - lost.at;
    added = std::max(added, glm::dot(way, way));
  }
  return static_cast<float>(std::sqrt(before * before + added));
}

void Collapser::commit(std::uint32_t key) {
  WorkingMesh& mesh = state_.mesh;
  const float error = error_m_;
  wedges_.commit(star_, choice_, log_);
  state_.last_faces.take(going_, region_);
  if (!mesh.has_seams()) {
    for (const Lost& lost : lost_) log_.vertices.push_back({mesh.wedge[lost.point], mesh.wedge[choice_.kept]});
  }
  const Side gone_side = choice_.gone == star_.u ? Side::U : Side::V;
  key = std::max({key, state_.last_key[star_.u], state_.last_key[star_.v]});
  for (const StarFace& f : star_.faces) {
    key = std::max({key, state_.last_key[f.a], state_.last_key[f.b]});
    Face& face = mesh.faces[f.index];
    if (f.side == Side::Both || f.twin) {
      face.id = none;
    } else if (f.side == gone_side) {
      face.point[f.k] = choice_.kept;
    }
  }
  for (const StarFace& f : star_.faces) {
    state_.last_key[f.a] = key;
    state_.last_key[f.b] = key;
  }
  state_.last_key[star_.u] = key;
  state_.last_key[star_.v] = key;
  mesh.position[choice_.kept] = glm::vec3{choice_.place};
  mesh.deviation_m[choice_.kept] = error;
  mesh.flags[star_.u] |= point_locked;
  mesh.flags[star_.v] |= point_locked;
  log_.end(key, error);
}

}  // namespace lodestone::collapse
