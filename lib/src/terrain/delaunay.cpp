// SPDX-License-Identifier: MIT
// Based on: Lawson 1977, "Software for C1 surface interpolation" (insertion and flips).
// Differs: integer coordinates below 2^15, so all tests are exact; circles through four vertices keep the edge that is
// there, so the result is a function of the order of insertion.
#include "terrain/delaunay.h"

#include <cassert>

namespace lodestone::terrain {
namespace {

// Whether d lies inside the circle through a, b, c (counter-clockwise). The determinant is six times the volume between
// four points of a paraboloid over a square of side 2^15, hence at most 2^60, though its terms may be more: they are
// added modulo 2^64, which leaves the sum as it is.
bool in_circle(Post a, Post b, Post c, Post d) {
  const std::int64_t ax = a.x - d.x, ay = a.y - d.y;
  const std::int64_t bx = b.x - d.x, by = b.y - d.y;
  const std::int64_t cx = c.x - d.x, cy = c.y - d.y;
  const auto term = [](std::int64_t squared, std::int64_t area) {
    return static_cast<std::uint64_t>(squared) * static_cast<std::uint64_t>(area);
  };
  return static_cast<std::int64_t>(term(ax * ax + ay * ay, bx * cy - by * cx) -
                                   term(bx * bx + by * by, ax * cy - ay * cx) +
                                   term(cx * cx + cy * cy, ax * by - ay * bx)) > 0;
}

}  // namespace

LatticeDelaunay::LatticeDelaunay(int side) : posts_{{0, 0}, {side, 0}, {side, side}, {0, side}} {
  add_triangle();
  add_triangle();
  set_triangle(0, 0, 1, 2, outside, outside, 3);
  set_triangle(1, 0, 2, 3, 2, outside, outside);
}

void LatticeDelaunay::forget_changes() noexcept {
  for (const std::uint32_t t : changed_) ++versions_[t];
  changed_.clear();
}

std::uint32_t LatticeDelaunay::add_triangle() {
  const std::uint32_t triangle = triangle_count();
  corners_.resize(corners_.size() + 3, none);
  twins_.resize(twins_.size() + 3, outside);
  versions_.push_back(0);
  return triangle;
}

void LatticeDelaunay::set_triangle(std::uint32_t triangle, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                   std::uint32_t twin_ab, std::uint32_t twin_bc, std::uint32_t twin_ca) {
  const std::uint32_t e = 3 * triangle;
  corners_[e] = a;
  corners_[e + 1] = b;
  corners_[e + 2] = c;
  link(e, twin_ab);
  link(e + 1, twin_bc);
  link(e + 2, twin_ca);
  mark(triangle);
}

std::uint32_t LatticeDelaunay::locate(Post post, std::uint32_t near) const {
  std::uint32_t t = near;
  // A walk may circle where edges are kept that are not Delaunay, unless chance decides which side it looks at first.
  for (std::uint32_t chance = 0;; chance = chance * 1664525U + 1013904223U) {
    std::uint32_t leave = outside;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t e = 3 * t + (i + (chance >> 16U)) % 3;
      if (cross(posts_[corners_[e]], posts_[corners_[next_of(e)]], post) < 0) {
        leave = e;
        break;
      }
    }
    if (leave == outside) return t;
    assert(twins_[leave] != outside);
    t = twins_[leave] / 3;
  }
}

std::uint32_t LatticeDelaunay::insert(Post post, std::uint32_t near) {
  const std::uint32_t t = locate(post, near);
  const auto vertex = static_cast<std::uint32_t>(posts_.size());
  posts_.push_back(post);
  std::uint32_t on = outside;
  for (std::uint32_t e = 3 * t; e < 3 * t + 3; ++e) {
    if (cross(posts_[corners_[e]], posts_[corners_[next_of(e)]], post) == 0) on = e;
  }
  if (on == outside) {
    split_inside(t, vertex);
  } else {
    split_edge(on, vertex);
  }
  while (!suspects_.empty()) {
    const std::uint32_t edge = suspects_.back();
    suspects_.pop_back();
    legalise(edge);
  }
  return vertex;
}

void LatticeDelaunay::split_inside(std::uint32_t triangle, std::uint32_t vertex) {
  const std::uint32_t e = 3 * triangle;
  const std::uint32_t a = corners_[e], b = corners_[e + 1], c = corners_[e + 2];
  const std::uint32_t ab = twins_[e], bc = twins_[e + 1], ca = twins_[e + 2];
  const std::uint32_t second = add_triangle(), third = add_triangle();
  set_triangle(triangle, a, b, vertex, ab, outside, outside);
  set_triangle(second, b, c, vertex, bc, outside, 3 * triangle + 1);
  set_triangle(third, c, a, vertex, ca, 3 * triangle + 2, 3 * second + 1);
  suspects_.insert(suspects_.end(), {3 * triangle, 3 * second, 3 * third});
}

// Each triangle at the edge is cut in two.
void LatticeDelaunay::split_edge(std::uint32_t edge, std::uint32_t vertex) {
  const std::uint32_t twin = twins_[edge];
  // Cuts triangle (a, b, c) at edge ab: (vertex, b, c) stays in its slot, (a, vertex, c) is new. Returns the new one.
  const auto cut = [&](std::uint32_t e) {
    const std::uint32_t t = e / 3, next = next_of(e), prev = prev_of(e);
    const std::uint32_t a = corners_[e], b = corners_[next], c = corners_[prev];
    const std::uint32_t bc = twins_[next], ca = twins_[prev];
    const std::uint32_t added = add_triangle();
    set_triangle(t, vertex, b, c, outside, bc, outside);
    set_triangle(added, a, vertex, c, outside, 3 * t + 2, ca);
    suspects_.insert(suspects_.end(), {3 * t + 1, 3 * added + 2});
    return added;
  };
  if (kept(edge)) {
    const std::uint32_t a = corners_[edge], b = corners_[next_of(edge)];
    kept_.erase(pair_of(a, b));
    kept_.insert({pair_of(a, vertex), pair_of(vertex, b)});
  }
  const std::uint32_t mine = edge / 3;
  const std::uint32_t added = cut(edge);
  if (twin == outside) return;
  const std::uint32_t theirs = twin / 3;
  const std::uint32_t their_added = cut(twin);
  // Mine holds (vertex, b), theirs (vertex, a): each meets the other's new half.
  twins_[3 * mine] = 3 * their_added;
  twins_[3 * their_added] = 3 * mine;
  twins_[3 * theirs] = 3 * added;
  twins_[3 * added] = 3 * theirs;
}

void LatticeDelaunay::legalise(std::uint32_t edge) {
  const std::uint32_t twin = twins_[edge];
  if (twin == outside) return;
  const Post a = posts_[corners_[edge]], b = posts_[corners_[next_of(edge)]];
  const Post c = posts_[corners_[prev_of(edge)]], d = posts_[corners_[prev_of(twin)]];
  if (!in_circle(a, b, c, d) || kept(edge)) return;
  flip(edge);
  // The vertex just inserted is c; after the flip the edges that face it begin at these places.
  suspects_.insert(suspects_.end(), {3 * (edge / 3) + 1, 3 * (twin / 3) + 1});
}

// Turns the edge ab of (a, b, c) and (b, a, d) into cd: slots become (c, a, d) and (c, d, b).
void LatticeDelaunay::flip(std::uint32_t edge) {
  const std::uint32_t twin = twins_[edge];
  const std::uint32_t a = corners_[edge], b = corners_[next_of(edge)];
  const std::uint32_t c = corners_[prev_of(edge)], d = corners_[prev_of(twin)];
  const std::uint32_t bc = twins_[next_of(edge)], ca = twins_[prev_of(edge)];
  const std::uint32_t ad = twins_[next_of(twin)], db = twins_[prev_of(twin)];
  const std::uint32_t t = edge / 3, s = twin / 3;
  set_triangle(t, c, a, d, ca, ad, outside);
  set_triangle(s, c, d, b, 3 * t + 2, db, bc);
}

}  // namespace lodestone::terrain
