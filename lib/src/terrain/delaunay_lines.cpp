// SPDX-License-Identifier: MIT
// Based on: Sloan 1993, "A fast algorithm for generating constrained Delaunay triangulations" (flips edges that cross
// the line until none does).
// Differs: edges are found by their ends, because flips change their numbers; the edges that flips made are not made
// Delaunay again but left to the points that are added later.
#include <algorithm>
#include <deque>

#include "terrain/delaunay.h"

namespace lodestone::terrain {
namespace {

std::int64_t along(Post a, Post b, Post p) {
  return static_cast<std::int64_t>(b.x - a.x) * (p.x - a.x) + static_cast<std::int64_t>(b.y - a.y) * (p.y - a.y);
}

}  // namespace

void LatticeDelaunay::fan(std::uint32_t vertex, std::vector<std::uint32_t>& edges) const {
  edges.clear();
  const std::uint32_t t = locate(posts_[vertex], last_);
  std::uint32_t e = 3 * t;
  while (corners_[e] != vertex) ++e;
  // Clockwise to the border if there is one, else once around.
  std::uint32_t first = e;
  while (twins_[first] != outside) {
    first = next_of(twins_[first]);
    if (first == e) break;
  }
  for (std::uint32_t at = first;;) {
    edges.push_back(at);
    const std::uint32_t twin = twins_[prev_of(at)];
    if (twin == outside || twin == first) break;
    at = twin;
  }
}

// `outside` if there is none.
std::uint32_t LatticeDelaunay::edge_between(std::uint32_t from, std::uint32_t to) const {
  std::vector<std::uint32_t> edges;
  fan(from, edges);
  for (const std::uint32_t e : edges) {
    if (corners_[next_of(e)] == to) return e;
  }
  return outside;
}

// The edges that the line crosses on its way to the next vertex on it.
LatticeDelaunay::Crossing LatticeDelaunay::first_stretch(std::uint32_t from, std::uint32_t to) const {
  const Post a = posts_[from], b = posts_[to];
  std::vector<std::uint32_t> edges;
  fan(from, edges);
  std::uint32_t crossed = outside;
  for (const std::uint32_t e : edges) {
    for (const std::uint32_t corner : {next_of(e), prev_of(e)}) {
      if (cross(a, b, at(corner)) == 0 && along(a, b, at(corner)) > 0) return {corners_[corner], {}};
    }
    if (cross(a, b, at(next_of(e))) < 0 && cross(a, b, at(prev_of(e))) > 0) crossed = next_of(e);
  }
  Crossing crossing;
  while (true) {
    crossing.edges.push_back(pair_of(corners_[crossed], corners_[next_of(crossed)]));
    const std::uint32_t twin = twins_[crossed], apex = prev_of(twin);
    const std::int64_t side = cross(a, b, at(apex));
    if (side == 0) {
      crossing.reached = corners_[apex];
      return crossing;
    }
    // From the right of the line to its left, as before.
    crossed = side > 0 ? next_of(twin) : apex;
  }
}

void LatticeDelaunay::clear_stretch(std::uint32_t from, std::uint32_t to, std::vector<std::uint64_t> crossed) {
  const Post a = posts_[from], b = posts_[to];
  std::deque<std::uint64_t> left{crossed.begin(), crossed.end()};
  while (!left.empty()) {
    const std::uint64_t pair = left.front();
    left.pop_front();
    const std::uint32_t e = edge_between(static_cast<std::uint32_t>(pair >> 32U), static_cast<std::uint32_t>(pair));
    const std::uint32_t p = corners_[prev_of(e)], q = corners_[prev_of(twins_[e])];
    // Edge e runs between u and v, p on its left, q on its right: it can be flipped where u and v are on both sides.
    const bool convex = cross(posts_[q], posts_[p], at(e)) > 0 && cross(posts_[q], posts_[p], at(next_of(e))) < 0;
    if (!convex) {
      left.push_back(pair);
      continue;
    }
    last_ = e / 3;
    flip(e);
    const std::int64_t side_p = cross(a, b, posts_[p]), side_q = cross(a, b, posts_[q]);
    if ((side_p > 0 && side_q < 0) || (side_p < 0 && side_q > 0)) left.push_back(pair_of(p, q));
  }
}

void LatticeDelaunay::keep_line(std::uint32_t from, std::uint32_t to) {
  while (from != to) {
    const Crossing crossing = first_stretch(from, to);
    clear_stretch(from, crossing.reached, crossing.edges);
    kept_.insert(pair_of(from, crossing.reached));
    from = crossing.reached;
  }
}

}  // namespace lodestone::terrain
