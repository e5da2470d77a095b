// SPDX-License-Identifier: MIT
// Delaunay triangulation of points with whole coordinates in a square, point by point, with edges that stay. All tests
// are exact.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "terrain/lattice.h"

namespace lodestone::terrain {

class LatticeDelaunay {
 public:
  static constexpr std::uint32_t outside = none;

  // The square with vertices 0..3: south-west, south-east, north-east, north-west. side < 2^15.
  explicit LatticeDelaunay(int side);

  // Adds a post; precondition: it is inside the square and no vertex yet. `near` is any triangle, best one close by.
  std::uint32_t insert(Post post, std::uint32_t near);

  // Makes edges of the straight line between two vertices, and keeps them whatever is added later; a point added on one
  // cuts it. Precondition: the line crosses no edge that is kept already.
  void keep_line(std::uint32_t from, std::uint32_t to);
  [[nodiscard]] bool kept(std::uint32_t edge) const {
    return !kept_.empty() && kept_.count(pair_of(corners_[edge], corners_[next_of(edge)])) != 0;
  }

  // The triangle that the post lies in or on the border of; `near` as above.
  [[nodiscard]] std::uint32_t locate(Post post, std::uint32_t near) const;

  // Slots that insert() changed or added since forget_changes(), each once.
  [[nodiscard]] const std::vector<std::uint32_t>& changed() const noexcept { return changed_; }
  // Differs from what it was before a slot was changed.
  [[nodiscard]] std::uint32_t version(std::uint32_t triangle) const noexcept { return versions_[triangle]; }
  void forget_changes() noexcept;

  [[nodiscard]] const std::vector<Post>& posts() const noexcept { return posts_; }
  // Corner k of triangle t is corners()[3 * t + k]; counter-clockwise.
  [[nodiscard]] const std::vector<std::uint32_t>& corners() const noexcept { return corners_; }
  [[nodiscard]] std::uint32_t triangle_count() const noexcept {
    return static_cast<std::uint32_t>(corners_.size() / 3);
  }
  // Half edge e runs from corner e to the next corner of its triangle; its twin, or `outside`.
  [[nodiscard]] const std::vector<std::uint32_t>& twins() const noexcept { return twins_; }
  [[nodiscard]] static constexpr std::uint32_t next_of(std::uint32_t edge) {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
  }
  [[nodiscard]] static constexpr std::uint32_t prev_of(std::uint32_t edge) {
    return edge % 3 == 0 ? edge + 2 : edge - 1;
  }

 private:
  [[nodiscard]] static std::uint64_t pair_of(std::uint32_t a, std::uint32_t b) {
    return a < b ? std::uint64_t{a} << 32U | b : std::uint64_t{b} << 32U | a;
  }
  [[nodiscard]] Post at(std::uint32_t corner) const { return posts_[corners_[corner]]; }
  // Half edges that begin at a vertex, counter-clockwise as far as there are triangles.
  void fan(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const;
  [[nodiscard]] std::uint32_t edge_between(std::uint32_t from, std::uint32_t to) const;
  struct Crossing {
    std::uint32_t reached = none;  // the next vertex on the line
    std::vector<std::uint64_t> edges;
  };
  [[nodiscard]] Crossing first_stretch(std::uint32_t from, std::uint32_t to) const;
  void clear_stretch(std::uint32_t from, std::uint32_t to, std::vector<std::uint64_t> crossed);
  void split_inside(std::uint32_t triangle, std::uint32_t vertex);
  void split_edge(std::uint32_t edge, std::uint32_t vertex);
  void set_triangle(std::uint32_t triangle, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t twin_ab,
                    std::uint32_t twin_bc, std::uint32_t twin_ca);
  std::uint32_t add_triangle();
  // Here, so that every caller has them inline: they are most of what an insertion does.
  void link(std::uint32_t edge, std::uint32_t twin) {
    twins_[edge] = twin;
    if (twin != outside) twins_[twin] = edge;
  }
  void mark(std::uint32_t triangle) {
    if (versions_[triangle] % 2 == 1) return;
    ++versions_[triangle];
    changed_.push_back(triangle);
  }
  void legalise(std::uint32_t edge);
  void flip(std::uint32_t edge);

  std::vector<Post> posts_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> versions_;  // per triangle; odd: in changed_
  std::vector<std::uint32_t> changed_;
  std::vector<std::uint32_t> suspects_;     // half edges to look at, scratch of legalise
  std::unordered_set<std::uint64_t> kept_;  // only asked, never walked through
  std::uint32_t last_ = 0;                  // where keep_line() begins to look
};

}  // namespace lodestone::terrain
