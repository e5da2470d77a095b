// SPDX-License-Identifier: MIT
// Where the vertex goes that an edge collapses into, and what that costs.
#pragma once

#include "collapse/star.h"
#include "collapse/symmetric3.h"

namespace lodestone::collapse {

// Sum over the faces and lines of a star of weighted squared distance, each once:
// cost(y) = y A y - 2 b y + c, y relative to u.
struct StarQuadric {
  Symmetric3 a;
  glm::dvec3 b{0.0};
  double c = 0.0;
  double weight = 0.0;            // sum of the weights: cost / weight is a mean squared distance
  glm::dvec3 volume_normal{0.0};  // places with volume_normal * y == volume keep the volume
  double volume = 0.0;

  [[nodiscard]] double cost(const glm::dvec3& y) const noexcept {
    return std::max(a.form(y) - 2.0 * glm::dot(b, y) + c, 0.0);
  }
  friend StarQuadric operator+(StarQuadric q, const StarQuadric& o) noexcept {
    q.a += o.a;
    q.b += o.b;
    q.c += o.c;
    q.weight += o.weight;
    q.volume_normal += o.volume_normal;
    q.volume += o.volume;
    return q;
  }
};
// Faces around u alone count by `weight_of_u`, those around v by `weight_of_v`, those around both by the mean.
[[nodiscard]] StarQuadric sum_star(const Star& star, double weight_of_lines, double weight_of_u, double weight_of_v);

// The best place that `placement` allows, relative to u.
[[nodiscard]] glm::dvec3 best_place(const Star& star, const StarQuadric& quadric, Placement placement);

// Square of how far from u a vertex may sensibly go.
[[nodiscard]] double reach_squared(const Star& star);

// Whether a place is farther from the faces around the edge than half the edge: a spike, of which their planes say
// nothing.
[[nodiscard]] bool sticks_out(const Star& star, const glm::dvec3& y);

// How the faces that stay take it when both ends go to y.
struct Fit {
  bool upright = false;           // none turns too far or loses its area
  double squared_distance = 0.0;  // of the farther of the old ends from the planes of the new faces
};
[[nodiscard]] Fit fit_at(const Star& star, const glm::dvec3& y);

}  // namespace lodestone::collapse
