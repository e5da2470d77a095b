// SPDX-License-Identifier: MIT
// Delaunay triangulation of posts of a square lattice, point by point. All tests are exact in 64-bit integers.
#pragma once

#include <cstdint>
#include <vector>

#include "terrain/lattice.h"

namespace lodestone::terrain {

class LatticeDelaunay {
 public:
  static constexpr std::uint32_t outside = none;

  // The square with vertices 0..3: south-west, south-east, north-east, north-west.
  explicit LatticeDelaunay(int side);

  // Adds a post; precondition: it is inside the square and no vertex yet. `near` is any triangle, best one close by.
  std::uint32_t insert(Post post, std::uint32_t near);

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

 private:
  void split_inside(std::uint32_t triangle, std::uint32_t vertex);
  void split_edge(std::uint32_t edge, std::uint32_t vertex);
  void set_triangle(std::uint32_t triangle, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t twin_ab,
                    std::uint32_t twin_bc, std::uint32_t twin_ca);
  std::uint32_t add_triangle();
  void link(std::uint32_t edge, std::uint32_t twin);
  void legalise(std::uint32_t edge);
  void flip(std::uint32_t edge);
  void mark(std::uint32_t triangle);

  std::vector<Post> posts_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> versions_;  // per triangle; odd: in changed_
  std::vector<std::uint32_t> changed_;
  std::vector<std::uint32_t> suspects_;  // half edges to look at, scratch of legalise
};

}  // namespace lodestone::terrain
