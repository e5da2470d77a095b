// SPDX-License-Identifier: MIT
// Based on: Wald 2007, "On fast construction of SAH-based bounding volume hierarchies" (binned surface area heuristic).
// Differs: for nearest-point queries, which visit the nearer child first. Boxes are float because corners are: they
// are exact, and distances are computed in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/types.h>

#include "geometry/distance.h"

namespace lodestone {

class TriangleBvh {
 public:
  struct Nearest {
    double squared_distance = std::numeric_limits<double>::infinity();
    FaceId face = none;
    std::uint32_t slot = none;  // hand it to the next query nearby
  };

  // Copies what it needs. O(n log n) time, about 80 bytes per triangle.
  TriangleBvh(std::span<const glm::vec3> positions, std::span<const VertexId> indices);

  [[nodiscard]] bool empty() const noexcept { return triangles_.empty(); }

  // Nearest triangle; `hint` is the slot of a triangle that is likely near. Only ties depend on the hint.
  [[nodiscard]] Nearest nearest(const glm::dvec3& p, std::uint32_t hint = none) const noexcept {
    return nearest_beyond(p, 0.0, hint);
  }

  // The same, or any triangle that lies within `enough`, if there is one: which, depends on the hint.
  [[nodiscard]] Nearest nearest_beyond(const glm::dvec3& p, double enough, std::uint32_t hint = none) const noexcept {
    Nearest best;
    if (hint != none) consider(p, hint, best);
    const double squared_enough = enough * enough;
    if (!nodes_.empty() && best.squared_distance > squared_enough)
      descend(
          p, [&] { return best.squared_distance; },
          [&](std::uint32_t slot) {
            consider(p, slot, best);
            return best.squared_distance > squared_enough;
          });
    return best;
  }

  // Nearest triangle among those for which wanted(face) holds and that lie nearer than `limit`; face `none` if there is
  // none.
  template <class Wanted>
  [[nodiscard]] Nearest nearest_of(const glm::dvec3& p, double limit, Wanted wanted) const {
    return nearest_among(
        p, limit, [&](std::uint32_t slot) { return wanted(faces_[slot]); }, [](std::uint32_t) { return false; });
  }

  // Gives every face a label; `none` takes it out of nearest_unlike(). O(n).
  void set_labels(std::span<const std::uint32_t> label_of_face);

  // As nearest_of() among the faces with a label other than this one. What is all of this label, however
  // near, is passed over as a whole. Precondition: set_labels().
  [[nodiscard]] Nearest nearest_unlike(const glm::dvec3& p, double limit, std::uint32_t label) const {
    return nearest_among(
        p, limit, [&](std::uint32_t slot) { return labels_[slot] != label && labels_[slot] != none; },
        [&](std::uint32_t node) { return node_labels_[node] == label || node_labels_[node] == none; });
  }

  // Calls visit(face) for the triangles in nodes whose boxes lie nearer to this one than bound(), a squared distance
  // that may shrink meanwhile, nearer ones first, until visit returns false.
  struct Place {
    glm::dvec3 low{0.0}, high{0.0};
  };
  template <class Bound, class Visit>
  void visit_boxes(const Place& place, Bound bound, Visit visit) const {
    if (!nodes_.empty()) descend(place, bound, [&](std::uint32_t slot) { return visit(faces_[slot]); });
  }

  // Calls visit(face) for the triangles in nodes whose boxes come within `margin` of the segment from p - reach to
  // p + reach, until visit returns false.
  template <class Visit>
  void visit_along(const glm::dvec3& p, const glm::dvec3& reach, double margin, Visit visit) const {
    if (nodes_.empty()) return;
    const glm::dvec3 inverse = 1.0 / reach;
    const auto meets = [&](const Node& node) {
      double from = -1.0;
      double to = 1.0;
      for (int axis = 0; axis < 3; ++axis) {
        // Not a number where the segment runs within a side: std::max and std::min leave that out.
        const double a = (double{node.low[axis]} - margin - p[axis]) * inverse[axis];
        const double b = (double{node.high[axis]} + margin - p[axis]) * inverse[axis];
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
      }
      return from <= to;
    };
    std::array<std::uint32_t, most_depth + 1> stack;
    std::size_t top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const std::uint32_t index = stack[--top];
      const Node& node = nodes_[index];
      if (!meets(node)) continue;
      for (std::uint32_t i = 0; i < node.count; ++i) {
        if (!visit(faces_[node.first + i])) return;
      }
      if (node.count > 0) continue;
      stack[top++] = node.first;
      stack[top++] = index + 1;
    }
  }

  // Whether the triangle of this slot lies no farther than `radius`.
  [[nodiscard]] bool near(const glm::dvec3& p, std::uint32_t slot, double radius) const noexcept {
    return squared_distance(p, slot) <= radius * radius;
  }

  // Calls visit(face) for every triangle no farther than `radius` for which wanted(face), which is asked first, holds;
  // visit returns false to stop.
  template <class Wanted, class Visit>
  void within(const glm::dvec3& p, double radius, Wanted wanted, Visit visit) const {
    if (nodes_.empty()) return;
    descend(
        p, [&, bound = inclusive(radius)] { return bound; },
        [&](std::uint32_t slot) {
          return !wanted(faces_[slot]) || squared_distance(p, slot) > radius * radius || visit(faces_[slot]);
        });
  }

 private:
  struct Node {
    glm::vec3 low{0.0F};
    std::uint32_t first = 0;  // leaf: first slot; else index of the right child (the left one follows its parent)
    glm::vec3 high{0.0F};
    std::uint32_t count = 0;  // slots of a leaf, 0 for an inner node

    [[nodiscard]] double squared_distance(const glm::dvec3& p) const noexcept {
      const glm::dvec3 d = glm::max(glm::max(glm::dvec3{low} - p, p - glm::dvec3{high}), glm::dvec3{0.0});
      return squared_length(d);
    }
    [[nodiscard]] double squared_distance(const Place& place) const noexcept {
      const glm::dvec3 d =
          glm::max(glm::max(glm::dvec3{low} - place.high, place.low - glm::dvec3{high}), glm::dvec3{0.0});
      return squared_length(d);
    }
  };
  struct Build;

  [[nodiscard]] double squared_distance(const glm::dvec3& p, std::uint32_t slot) const noexcept {
    const auto& t = triangles_[slot];
    return squared_distance_to_triangle(p, glm::dvec3{t[0]}, glm::dvec3{t[1]}, glm::dvec3{t[2]});
  }

  void consider(const glm::dvec3& p, std::uint32_t slot, Nearest& best) const noexcept {
    const double d = squared_distance(p, slot);
    if (d < best.squared_distance) best = {d, faces_[slot], slot};
  }

  // descend() takes an exclusive bound, hence the next larger number.
  [[nodiscard]] static double inclusive(double radius) noexcept {
    return std::nextafter(radius * radius, std::numeric_limits<double>::infinity());
  }

  // Nearest of the slots that takes(slot), nearer than `limit`, in nodes not left out by skips(node).
  template <class Takes, class Skips>
  [[nodiscard]] Nearest nearest_among(const glm::dvec3& p, double limit, Takes takes, Skips skips) const {
    Nearest best;
    best.squared_distance = limit * limit;
    if (nodes_.empty()) return best;
    descend(
        p, [&] { return best.squared_distance; },
        [&](std::uint32_t slot) {
          if (takes(slot)) consider(p, slot, best);
          return true;
        },
        skips);
    return best;
  }

  // Calls visit(slot) for the triangles of leaves nearer than bound(), nearer ones first, until it returns false.
  template <class Where, class Bound, class Visit>
  void descend(const Where& p, Bound bound, Visit visit) const {
    descend(p, bound, visit, [](std::uint32_t) { return false; });
  }
  // Leaves out nodes for which skips(node).
  template <class Where, class Bound, class Visit, class Skips>
  void descend(const Where& p, Bound bound, Visit visit, Skips skips) const {
    struct Waiting {  // no pair: that would fill the whole stack with zeros for every query
      double distance;
      std::uint32_t index;
    };
    std::array<Waiting, most_depth + 1> stack;
    std::size_t top = 0;
    stack[top++] = {nodes_[0].squared_distance(p), 0};
    while (top > 0) {
      const auto [distance, index] = stack[--top];
      if (distance >= bound()) continue;
      const Node& node = nodes_[index];
      for (std::uint32_t i = 0; i < node.count; ++i) {
        if (!visit(node.first + i)) return;
      }
      if (node.count > 0) continue;
      Waiting near{nodes_[index + 1].squared_distance(p), index + 1};
      Waiting far{nodes_[node.first].squared_distance(p), node.first};
      if (far.distance < near.distance) std::swap(near, far);
      if (far.distance < bound() && !skips(far.index)) stack[top++] = far;
      if (near.distance < bound() && !skips(near.index)) stack[top++] = near;
    }
  }

  static constexpr std::uint32_t most_depth = 112;  // 64 by surface area, then halves of at most 2^32

  std::vector<Node> nodes_;  // depth first
  std::vector<std::array<glm::vec3, 3>> triangles_;
  std::vector<FaceId> faces_;
  std::vector<std::uint32_t> labels_;       // per slot
  std::vector<std::uint32_t> node_labels_;  // of all slots below that have one, or `mixed`

  static constexpr std::uint32_t mixed = none - 1;
};

}  // namespace lodestone
