// SPDX-License-Identifier: MIT
// Based on: Meisters 1975 (ears), Eberly 2002, "Triangulation by ear clipping" (holes joined by bridges).
// Differs: whole coordinates, so that all tests are exact; the ear with the shortest diagonal goes first. Points in the
// middle of straight edges are kept as corners of triangles, which general triangulators may drop: the body of a house
// is closed only if both facets at an edge use the same points.
#include <algorithm>
#include <array>
#include <cassert>
#include <functional>
#include <numeric>

#include "generate/lattice.h"

namespace lodestone::generate {

namespace {

bool on_segment(const Point2& p, const Point2& a, const Point2& b) {
  return orient(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

// Whether the segments have a point in common other than a shared end.
bool blocks(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const auto strictly_between = [](const Point2& p, const Point2& s, const Point2& t) {
    return p != s && p != t && on_segment(p, s, t);
  };
  if (strictly_between(c, a, b) || strictly_between(d, a, b) || strictly_between(a, c, d) ||
      strictly_between(b, c, d)) {
    return true;
  }
  const auto side = [](std::int64_t v) { return v > 0 ? 1 : (v < 0 ? -1 : 0); };
  return side(orient(a, b, c)) * side(orient(a, b, d)) < 0 && side(orient(c, d, a)) * side(orient(c, d, b)) < 0;
}

class Polygon {
 public:
  explicit Polygon(const std::vector<Loop2>& rings) {
    for (const Loop2& ring : rings) points_.insert(points_.end(), ring.begin(), ring.end());
    std::uint32_t first = 0;
    for (const Loop2& ring : rings) {
      std::vector<std::uint32_t> ids(ring.size());
      std::iota(ids.begin(), ids.end(), first);
      first += static_cast<std::uint32_t>(ring.size());
      rings_.push_back(std::move(ids));
    }
  }

  std::vector<std::uint32_t> clip() {
    join_holes();
    std::vector<std::uint32_t> triangles;
    while (ring_.size() > 3) {
      const std::size_t ear = best_ear();
      if (ear == ring_.size()) break;
      emit(ear, triangles);
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    assert(ring_.size() == 3 && "ring is not simple");
    if (ring_.size() == 3) emit(1, triangles);
    return triangles;
  }

 private:
  [[nodiscard]] const Point2& at(std::size_t i) const { return points_[ring_[i]]; }
  [[nodiscard]] std::size_t before(std::size_t i) const { return (i + ring_.size() - 1) % ring_.size(); }
  [[nodiscard]] std::size_t after(std::size_t i) const { return (i + 1) % ring_.size(); }

  void emit(std::size_t ear, std::vector<std::uint32_t>& triangles) const {
    triangles.insert(triangles.end(), {ring_[before(ear)], ring_[ear], ring_[after(ear)]});
  }

  [[nodiscard]] bool is_ear(std::size_t i) const {
    const Point2& a = at(before(i));
    const Point2& b = at(i);
    const Point2& c = at(after(i));
    for (std::size_t k = 0; k < ring_.size(); ++k) {
      const Point2& p = at(k);
      if (p == a || p == b || p == c) continue;
      if (orient(a, b, p) >= 0 && orient(b, c, p) >= 0 && orient(c, a, p) >= 0) return false;
    }
    return true;
  }

  // ring_.size() if there is none.
  [[nodiscard]] std::size_t best_ear() const {
    std::vector<std::pair<std::int64_t, std::size_t>> candidates;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Point2& a = at(before(i));
      const Point2& c = at(after(i));
      if (orient(a, at(i), c) <= 0) continue;
      const std::int64_t dx = c.x - a.x;
      const std::int64_t dy = c.y - a.y;
      candidates.emplace_back(dx * dx + dy * dy, i);
    }
    // Most often one of the first few is an ear: a heap costs less than sorting all.
    std::make_heap(candidates.begin(), candidates.end(), std::greater<>{});
    while (!candidates.empty()) {
      std::pop_heap(candidates.begin(), candidates.end(), std::greater<>{});
      if (is_ear(candidates.back().second)) return candidates.back().second;
      candidates.pop_back();
    }
    return ring_.size();
  }

  [[nodiscard]] bool sees(const Point2& a, const Point2& b) const {
    const auto crosses = [&](const std::vector<std::uint32_t>& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        if (blocks(a, b, points_[ring[i]], points_[ring[(i + 1) % ring.size()]])) return true;
      }
      return false;
    };
    return !crosses(ring_) && std::none_of(rings_.begin() + 1, rings_.end(), crosses);
  }

  // A corner of the ring may appear twice, where a bridge starts; the bridge must leave inside this one's angle.
  [[nodiscard]] bool opens_to(std::size_t i, const Point2& p) const {
    const Point2& a = at(before(i));
    const Point2& b = at(i);
    const Point2& c = at(after(i));
    const bool left_of_in = orient(a, b, p) > 0;
    const bool left_of_out = orient(b, c, p) > 0;
    return orient(a, b, c) > 0 ? left_of_in && left_of_out : left_of_in || left_of_out;
  }

  void join_holes() {
    ring_ = rings_.front();
    while (rings_.size() > 1) {
      // The shortest bridge between the ring and any hole.
      std::vector<std::array<std::int64_t, 4>> bridges;
      for (std::size_t h = 1; h < rings_.size(); ++h) {
        for (std::size_t k = 0; k < rings_[h].size(); ++k) {
          for (std::size_t i = 0; i < ring_.size(); ++i) {
            const glm::i64vec2 d = glm::i64vec2{points_[rings_[h][k]]} - glm::i64vec2{at(i)};
            bridges.push_back({d.x * d.x + d.y * d.y, static_cast<std::int64_t>(h), static_cast<std::int64_t>(k),
                               static_cast<std::int64_t>(i)});
          }
        }
      }
      std::make_heap(bridges.begin(), bridges.end(), std::greater<>{});
      while (true) {
        assert(!bridges.empty());
        std::pop_heap(bridges.begin(), bridges.end(), std::greater<>{});
        const auto [length, h, k, i] = bridges.back();
        bridges.pop_back();
        const Point2& target = points_[rings_[static_cast<std::size_t>(h)][static_cast<std::size_t>(k)]];
        if (!opens_to(static_cast<std::size_t>(i), target) || !sees(at(static_cast<std::size_t>(i)), target)) continue;
        splice(static_cast<std::size_t>(h), static_cast<std::size_t>(k), static_cast<std::size_t>(i));
        break;
      }
    }
  }

  void splice(std::size_t hole, std::size_t corner, std::size_t i) {
    std::vector<std::uint32_t> inserted;
    const auto& ring = rings_[hole];
    for (std::size_t k = 0; k <= ring.size(); ++k) inserted.push_back(ring[(corner + k) % ring.size()]);
    inserted.push_back(ring_[i]);
    ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(i) + 1, inserted.begin(), inserted.end());
    rings_.erase(rings_.begin() + static_cast<std::ptrdiff_t>(hole));
  }

  std::vector<Point2> points_;
  std::vector<std::vector<std::uint32_t>> rings_;
  std::vector<std::uint32_t> ring_;
};

}  // namespace

std::vector<std::uint32_t> triangulate(const std::vector<Loop2>& rings) { return Polygon{rings}.clip(); }

}  // namespace lodestone::generate
