// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998, sections 3.2 to 3.4 (volume preservation, volume and boundary optimisation).
// Differs: one regularised system instead of a chain of constraints that are added while they are independent: a weak
// pull towards the middle of the edge decides where flat or straight surroundings leave the place open. Borders enter
// as lines with a fixed weight, so that borders, seams, sharp edges and contacts of three faces are one thing.
#include "collapse/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collapse/weights.h"
#include "geometry/distance.h"

namespace lodestone::collapse {

double reach_squared(const Star& star) {
  double reach = glm::dot(star.e, star.e);
  for (const StarFace& f : star.faces) reach = std::max({reach, glm::dot(f.at_a, f.at_a), glm::dot(f.at_b, f.at_b)});
  return reach;
}

bool sticks_out(const Star& star, const glm::dvec3& y) {
  const double near2 = 0.25 * glm::dot(star.e, star.e);
  if (squared_distance_to_segment(y, glm::dvec3{0.0}, star.e) <= near2) return false;
  return std::none_of(star.faces.begin(), star.faces.end(), [&](const StarFace& f) {
    const glm::dvec3 near = f.side == Side::V ? star.e : glm::dvec3{0.0};
    return squared_distance_to_triangle(y, near, f.at_a, f.at_b) <= near2;
  });
}

namespace {

// The minimum under the volume constraint, which holds only where the surface is closed around the edge.
glm::dvec3 optimum(const Star& star, const StarQuadric& quadric) {
  Symmetric3 a = quadric.a;
  const double pull = middle_weight * quadric.a.trace() + 1e-300;
  a.add_isotropic(pull);
  const Solver3 solve{a};
  const double reach = reach_squared(star);
  // Slivers that are almost without area say nothing about the place.
  if (!solve.valid() || quadric.a.trace() < 1e-20 * reach * reach) return 0.5 * star.e;
  const glm::dvec3 free = solve(quadric.b + (0.5 * pull) * star.e);
  if (!(glm::dot(free, free) <= reach) || sticks_out(star, free)) return 0.5 * star.e;
  if (!star.plain) return free;
  const glm::dvec3 along = solve(quadric.volume_normal);
  const double slope = glm::dot(quadric.volume_normal, along);
  // A star that folds back on itself has hardly any volume normal: there the constraint would throw the vertex far
  // away.
  if (!(slope * a.trace() > 1e-3 * glm::dot(quadric.volume_normal, quadric.volume_normal))) return free;
  const glm::dvec3 kept = free + along * ((quadric.volume - glm::dot(quadric.volume_normal, free)) / slope);
  return glm::dot(kept, kept) <= reach && !sticks_out(star, kept) ? kept : free;
}

}  // namespace

StarQuadric sum_star(const Star& star, double weight_of_lines, double weight_of_u, double weight_of_v) {
  StarQuadric sum;
  const double weight_of_both = 0.5 * (weight_of_u + weight_of_v);
  for (const StarFace& f : star.faces) {
    const double weight = f.side == Side::Both ? weight_of_both : (f.side == Side::V ? weight_of_v : weight_of_u);
    const glm::dvec3 plane = f.normal * weight;
    sum.a.add_plane(f.normal, weight);
    sum.weight += glm::dot(plane, f.normal);
    sum.volume_normal += f.normal;
    if (f.side != Side::V) continue;
    const double t = glm::dot(f.normal, star.e);
    sum.b += plane * t;
    sum.c += weight * t * t;
    sum.volume += t;
  }
  for (const StarLine& line : star.lines) {
    const double length2 = glm::dot(line.direction, line.direction);
    Symmetric3 m;
    m.add_line(line.direction, weight_of_lines * length2);
    sum.a += m;
    sum.weight += weight_of_lines * length2 * length2;
    if (line.from == star.u) continue;
    const glm::dvec3 b = m * star.e;
    sum.b += b;
    sum.c += glm::dot(b, star.e);
  }
  return sum;
}

glm::dvec3 best_place(const Star& star, const StarQuadric& quadric, Placement placement) {
  switch (placement) {
    case Placement::Optimal:
      return optimum(star, quadric);
    case Placement::OnEdge: {
      const double square = quadric.a.form(star.e);
      const double t = square > 0.0 ? glm::dot(quadric.b, star.e) / square : 0.5;
      return star.e * std::clamp(t, 0.0, 1.0);
    }
    case Placement::Midpoint:
      return 0.5 * star.e;
    case Placement::EndPoint:
    case Placement::Subset:
      break;
  }
  return quadric.cost(star.e) < quadric.cost(glm::dvec3{0.0}) ? star.e : glm::dvec3{0.0};
}

Fit fit_at(const Star& star, const glm::dvec3& y) {
  Fit fit;
  double u_away = std::numeric_limits<double>::infinity();
  double v_away = u_away;
  for (const StarFace& f : star.faces) {
    if (f.side == Side::Both || f.twin) continue;
    const glm::dvec3 normal = glm::cross(f.at_a - y, f.at_b - y);
    const double before = glm::dot(f.normal, f.normal);
    const double after = glm::dot(normal, normal);
    const double turn = glm::dot(f.normal, normal);
    if (before > 0.0 && (turn <= 0.0 || turn * turn < flip_cosine * flip_cosine * before * after)) return fit;
    if (!(after > 0.0)) continue;
    const double from_u = glm::dot(normal, y);
    const double from_v = glm::dot(normal, star.e - y);
    u_away = std::min(u_away, from_u * from_u / after);
    v_away = std::min(v_away, from_v * from_v / after);
  }
  const double away = std::max(u_away, v_away);
  fit.upright = true;
  fit.squared_distance = away < std::numeric_limits<double>::infinity() ? away : 0.0;
  return fit;
}

}  // namespace lodestone::collapse
