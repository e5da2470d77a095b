// SPDX-License-Identifier: MIT
// The planes that the faces around an edge keep, and where a vertex may go that lies in all of them.
#pragma once

#include <vector>

#include "collapse/placement.h"
#include "collapse/star.h"

namespace lodestone::collapse {

class HeldPlanes {
 public:
  // Of the faces that outlive the collapse.
  void look_at(const Star& star, const WorkingMesh& mesh, const EdgeCollapseOptions& options, double diagonal_m);

  [[nodiscard]] bool empty() const noexcept { return planes_.empty(); }
  // Whether there may be a place: false if they contradict each other and neither end lies on those of the other.
  [[nodiscard]] bool meet() const noexcept { return empty() || in_all_ || u_will_do_ || v_will_do_; }
  // Whether all faces keep their planes when both ends go to y, relative to u. An end that stays is taken as it is.
  [[nodiscard]] bool allow(const glm::dvec3& y, const Star& star) const;
  // The best place that `placement` allows among those that lie in all planes, or an end if there is none.
  [[nodiscard]] glm::dvec3 best_place(const Star& star, const StarQuadric& quadric, Placement placement) const;

 private:
  struct Plane {
    std::uint32_t id = none;
    bool of_u = false, of_v = false;  // of a face there
    glm::dvec3 normal{0.0};
    double offset_m = 0.0;  // relative to u
  };
  void find_subspace();
  [[nodiscard]] bool hold(const glm::dvec3& y) const;
  [[nodiscard]] glm::dvec3 across(const glm::dvec3& v) const;
  [[nodiscard]] glm::dvec3 minimum(const Star& star, const StarQuadric& quadric) const;

  std::vector<Plane> planes_;
  std::array<glm::dvec3, 3> axes_{};  // orthogonal to the places that lie in all planes, unit
  std::size_t rank_ = 0;
  glm::dvec3 foot_{0.0};  // the one of them that is nearest to u
  double tolerance_m_ = 0.0;
  bool in_all_ = false;     // there are such places
  bool u_will_do_ = false;  // u lies on the planes of v
  bool v_will_do_ = false;
};

// What it costs the faces that outlive the collapse to turn away from their planes.
[[nodiscard]] StarQuadric sum_turns(const Star& star, const WorkingMesh& mesh, const EdgeCollapseOptions& options);

}  // namespace lodestone::collapse
