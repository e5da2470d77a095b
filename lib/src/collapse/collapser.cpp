// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998; Dey et al. 1999 (link condition); Garland and Heckbert 1997 (flips, contacts).
// Differs: the link condition is asked only where both rings are manifold, so that soup reduces too.
#include "collapse/collapser.h"

#include <algorithm>
#include <cmath>

#include "collapse/weights.h"

namespace lodestone::collapse {

Refusal Collapser::attempt(std::uint32_t u, std::uint32_t v, std::uint32_t key) {
  const WorkingMesh& mesh = state_.mesh;
  if (((mesh.flags[u] | mesh.flags[v]) & point_locked) != 0) return Refusal::Busy;
  if (!gather_star(mesh, u, v, region_, star_)) return Refusal::Outside;
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
  if (((fu | fv) & point_complex) == 0) {
    if ((fu & fv & point_border) != 0 && star_.shared != 1) return Refusal::Link;
    if (!link_holds()) return Refusal::Link;
  }
  if (((fu | fv) & (point_border | point_complex)) != 0 && !apexes_stay()) return Refusal::Border;
  if (!star_.plain) find_lines();
  return Refusal::None;
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

// False if the third corner of a face on the edge would lose its last face.
bool Collapser::apexes_stay() const {
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
    if (!stays) return false;
  }
  // Something must be left for the point that stays.
  return star_.faces.size() > star_.shared;
}

void Collapser::find_lines() {
  const WorkingMesh& mesh = state_.mesh;
  struct Spoke {
    std::uint32_t from, to, faces;
    glm::dvec3 direction;
  };
  std::vector<Spoke> spokes;
  const auto count = [&](std::uint32_t from, std::uint32_t to, const glm::dvec3& direction) {
    for (Spoke& s : spokes) {
      if (s.from == from && s.to == to) {
        ++s.faces;
        return;
      }
    }
    spokes.push_back({from, to, 1, direction});
  };
  for (const StarFace& f : star_.faces) {
    const std::uint32_t near = f.side == Side::V ? star_.v : star_.u;
    const glm::dvec3 at = f.side == Side::V ? star_.e : glm::dvec3{0.0};
    count(near, f.a, f.at_a - at);
    count(near, f.b, f.at_b - at);
    if (f.side != Side::Both) continue;
    const bool a_is_v = f.a == star_.v;
    count(star_.v, a_is_v ? f.b : f.a, (a_is_v ? f.at_b : f.at_a) - star_.e);
  }
  static_cast<void>(mesh);
  for (const Spoke& s : spokes) {
    if (s.faces != 2) star_.lines.push_back({s.from, s.to, s.direction});
  }
}

Refusal Collapser::choose_ends() {
  const WorkingMesh& mesh = state_.mesh;
  u_may_go_ = (mesh.flags[star_.u] & point_frozen) == 0;
  v_may_go_ = (mesh.flags[star_.v] & point_frozen) == 0;
  if (!u_may_go_ && !v_may_go_) return Refusal::Frozen;
  if (state_.options.attributes == Attributes::All && !state_.relaxed && state_.looks_matter) {
    u_may_go_ = u_may_go_ && wedges_.stays_on_seam(star_, star_.u);
    v_may_go_ = v_may_go_ && wedges_.stays_on_seam(star_, star_.v);
    if (!u_may_go_ && !v_may_go_) return Refusal::Seam;
  }
  return Refusal::None;
}

bool Collapser::try_place(const glm::dvec3& y) {
  const glm::dvec3 origin{state_.mesh.position[star_.u]};
  const bool at_u = y == glm::dvec3{0.0};
  const bool at_v = y == star_.e;
  choice_.place = at_u   ? glm::vec3{state_.mesh.position[star_.u]}
                  : at_v ? glm::vec3{state_.mesh.position[star_.v]}
                         : glm::vec3{origin + y};
  choice_.relative = glm::dvec3{choice_.place} - origin;
  if (!keeps_orientation(star_, choice_.relative)) return false;
  const bool u_frozen = (state_.mesh.flags[star_.u] & point_frozen) != 0;
  const bool v_frozen = (state_.mesh.flags[star_.v] & point_frozen) != 0;
  bool keep_u = at_u ? true : at_v ? false : star_.faces_of_u >= star_.faces_of_v;
  if (u_frozen || !u_may_go_) keep_u = true;
  if (v_frozen || !v_may_go_) keep_u = false;
  choice_.kept = keep_u ? star_.u : star_.v;
  choice_.gone = keep_u ? star_.v : star_.u;
  choice_.moves = !(keep_u ? at_u : at_v);
  choice_.cost = quadric_.cost(choice_.relative);
  return true;
}

Refusal Collapser::choose_place() {
  quadric_ = sum_star(star_);
  const bool u_frozen = (state_.mesh.flags[star_.u] & point_frozen) != 0;
  const bool v_frozen = (state_.mesh.flags[star_.v] & point_frozen) != 0;
  const Placement placement = state_.options.placement;
  const bool ends_only = placement == Placement::EndPoint || placement == Placement::Subset;
  // A place where the end that cannot go, or may not move, already is.
  const bool must_u = u_frozen || (ends_only && !u_may_go_);
  const bool must_v = v_frozen || (ends_only && !v_may_go_);
  const glm::dvec3 zero{0.0};
  bool found = false;
  if (must_u || must_v) {
    found = try_place(must_u ? zero : star_.e);
  } else {
    found = try_place(best_place(star_, quadric_, placement));
    const bool u_better = quadric_.cost(zero) <= quadric_.cost(star_.e);
    if (!found) found = try_place(u_better ? zero : star_.e);
    if (!found) found = try_place(u_better ? star_.e : zero);
  }
  if (!found) return Refusal::Flip;
  if (choice_.cost > state_.cost_limit) return Refusal::Cost;
  if (error_m() > state_.options.max_error_m) return Refusal::Cost;
  if (choice_.cost + wedges_.plan(star_, choice_) > state_.cost_limit) return Refusal::Cost;
  return Refusal::None;
}

float Collapser::error_m() const {
  const double before = std::max(state_.mesh.deviation_m[star_.u], state_.mesh.deviation_m[star_.v]);
  const double added2 = quadric_.weight > 0.0 ? choice_.cost / quadric_.weight : 0.0;
  return static_cast<float>(std::sqrt(before * before + error_growth * added2));
}

void Collapser::commit(std::uint32_t key) {
  WorkingMesh& mesh = state_.mesh;
  const float error = error_m();
  wedges_.commit(star_, choice_, log_);
  const Side gone_side = choice_.gone == star_.u ? Side::U : Side::V;
  key = std::max({key, state_.last_key[star_.u], state_.last_key[star_.v]});
  for (const StarFace& f : star_.faces) {
    key = std::max({key, state_.last_key[f.a], state_.last_key[f.b]});
    Face& face = mesh.faces[f.index];
    if (f.side == Side::Both) {
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
