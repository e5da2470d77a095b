// SPDX-License-Identifier: MIT
// Based on: Meisters 1975 (ears); Eberly 2002, "Triangulation by ear clipping" (bridges to holes); Held 2001, "FIST:
// fast industrial-strength triangulation of polygons" (a grid over the reflex vertices, and relaxing step by step when
// no ear is left).
// Differs: vertices in the middle of a straight side block ears like reflex ones, so that none is left over; work on
// input that is no polygon is bounded by a budget, after which ears are cut without looking.
#include <lodestone/polygon.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace lodestone {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

struct Node {
  glm::dvec2 p{0.0};
  std::uint32_t point = 0;  // index into the caller's points
  std::uint32_t prev = 0;
  std::uint32_t next = 0;
};

double orient(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) noexcept {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double length_l1(const glm::dvec2& v) noexcept { return std::abs(v.x) + std::abs(v.y); }

// Newell's normal of the outer ring; where that vanishes (a figure of eight), of its largest triangle at one corner.
glm::dvec3 plane_normal(std::span<const glm::dvec3> ring) {
  glm::dvec3 sum{0.0};
  glm::dvec3 largest{0.0};
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const glm::dvec3 n = glm::cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
    sum += n;
    if (glm::dot(n, n) > glm::dot(largest, largest)) largest = n;
  }
  return glm::length(sum) > 1e-9 * glm::length(largest) ? sum : largest;
}

// Rotates so that `normal` points at the viewer, and drops the depth.
class Projection {
 public:
  explicit Projection(const glm::dvec3& normal) {
    const glm::dvec3 n = glm::normalize(normal);
    const glm::dvec3 size = glm::abs(n);
    const glm::dvec3 helper = size.x < size.y && size.x < size.z ? glm::dvec3{1.0, 0.0, 0.0}
                              : size.y < size.z                  ? glm::dvec3{0.0, 1.0, 0.0}
                                                                 : glm::dvec3{0.0, 0.0, 1.0};
    u_ = glm::normalize(glm::cross(helper, n));
    v_ = glm::cross(n, u_);
  }
  [[nodiscard]] glm::dvec2 operator()(const glm::dvec3& p) const noexcept { return {glm::dot(u_, p), glm::dot(v_, p)}; }

 private:
  glm::dvec3 u_{0.0}, v_{0.0};
};

// Vertices that may block an ear, bucketed by place.
class Grid {
 public:
  Grid(const std::vector<Node>& nodes, const std::vector<std::uint32_t>& members) {
    side_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(members.size()))), 1, 1024);
    for (const std::uint32_t i : members) {
      low_ = glm::min(low_, nodes[i].p);
      high_ = glm::max(high_, nodes[i].p);
    }
    const glm::dvec2 extent = glm::max(high_ - low_, glm::dvec2{1e-300});
    scale_ = glm::dvec2{static_cast<double>(side_)} / extent;
    first_.assign(static_cast<std::size_t>(side_) * side_ + 1, 0);
    for (const std::uint32_t i : members) ++first_[cell(nodes[i].p) + 1];
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    items_.resize(members.size());
    std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
    for (const std::uint32_t i : members) items_[fill[cell(nodes[i].p)]++] = i;
    count_.resize(first_.size() - 1);
    for (std::size_t c = 0; c < count_.size(); ++c) count_[c] = first_[c + 1] - first_[c];
  }

  // True if blocks(i) holds for a member in the box. Members for which stale(i) holds are forgotten. `work` counts.
  template <class Stale, class Blocks>
  bool any(const glm::dvec2& low, const glm::dvec2& high, std::uint64_t& work, Stale stale, Blocks blocks) {
    if (items_.empty() || low.x > high_.x || low.y > high_.y || high.x < low_.x || high.y < low_.y) return false;
    const int x1 = column(high.x);
    const int y1 = row(high.y);
    for (int y = row(low.y); y <= y1; ++y) {
      for (int x = column(low.x); x <= x1; ++x) {
        const std::size_t c = static_cast<std::size_t>(y) * side_ + x;
        work += 1 + count_[c];
        for (std::uint32_t k = 0; k < count_[c];) {
          std::uint32_t& item = items_[first_[c] + k];
          if (stale(item)) {
            item = items_[first_[c] + --count_[c]];
            continue;
          }
          if (blocks(item)) return true;
          ++k;
        }
      }
    }
    return false;
  }

 private:
  [[nodiscard]] int column(double x) const noexcept {
    return static_cast<int>(std::clamp((x - low_.x) * scale_.x, 0.0, side_ - 1.0));
  }
  [[nodiscard]] int row(double y) const noexcept {
    return static_cast<int>(std::clamp((y - low_.y) * scale_.y, 0.0, side_ - 1.0));
  }
  [[nodiscard]] std::size_t cell(const glm::dvec2& p) const noexcept {
    return static_cast<std::size_t>(row(p.y)) * side_ + column(p.x);
  }

  int side_ = 1;
  glm::dvec2 low_{std::numeric_limits<double>::infinity()};
  glm::dvec2 high_{-std::numeric_limits<double>::infinity()};
  glm::dvec2 scale_{1.0};
  std::vector<std::uint32_t> first_, count_, items_;
};

class EarClipper {
 public:
  // Points nearer than `noise` to a line may lie on either side of it.
  explicit EarClipper(double noise) : noise_(noise) {}

  // Adds a ring, deprived of repeated points; returns one of its nodes, or `none` if fewer than three are left.
  std::uint32_t add_ring(std::span<const glm::dvec2> ring, std::uint32_t first_point, bool counter_clockwise) {
    const auto begin = static_cast<std::uint32_t>(nodes_.size());
    double area = 0.0;
    for (std::uint32_t i = 0; i < ring.size(); ++i) {
      if (nodes_.size() > begin && nodes_.back().p == ring[i]) continue;
      nodes_.push_back({.p = ring[i], .point = first_point + i});
    }
    while (nodes_.size() > begin + 1 && nodes_.back().p == nodes_[begin].p) nodes_.pop_back();
    const auto end = static_cast<std::uint32_t>(nodes_.size());
    if (end - begin < 3) {
      nodes_.resize(begin);
      return none;
    }
    for (std::uint32_t i = begin + 1; i + 1 < end; ++i) area += orient(nodes_[begin].p, nodes_[i].p, nodes_[i + 1].p);
    if ((area < 0.0) == counter_clockwise) std::reverse(nodes_.begin() + begin, nodes_.end());
    for (std::uint32_t i = begin; i < end; ++i) {
      nodes_[i].prev = i == begin ? end - 1 : i - 1;
      nodes_[i].next = i + 1 == end ? begin : i + 1;
    }
    return begin;
  }

  void join_holes(std::uint32_t outer, std::vector<std::uint32_t> holes) {
    for (std::uint32_t& hole : holes) hole = rightmost(hole);
    std::stable_sort(holes.begin(), holes.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return nodes_[a].p.x > nodes_[b].p.x; });
    for (const std::uint32_t hole : holes) {
      const std::uint32_t bridge = find_bridge(outer, hole);
      if (bridge != none) connect(bridge, hole);
    }
  }

  Triangles clip(std::uint32_t start) {
    std::uint32_t left = 0;
    std::vector<std::uint32_t> blockers;
    for (std::uint32_t i = start; left == 0 || i != start; i = nodes_[i].next, ++left) {
      if (!convex(i)) blockers.push_back(i);
    }
    budget_ = 1'000'000 + 2000 * std::uint64_t{left};
    gone_.assign(nodes_.size(), 0);
    Grid grid{nodes_, blockers};
    Triangles triangles;
    triangles.reserve(left);
    std::uint32_t at = start;
    std::uint32_t since_clip = 0;
    bool reversed = false;
    while (left >= 3) {
      const bool looking = since_clip < left && budget_ > 0;
      if (looking && is_ear(grid, at)) {
        // Going on two vertices further keeps fans, with their slivers, short.
        at = nodes_[cut(at, triangles)].next;
        --left;
        since_clip = 0;
        continue;
      }
      if (looking) {
        ++since_clip;
        at = nodes_[at].next;
        continue;
      }
      if (const std::uint32_t dropped = drop_hairpins(at, left); dropped > 0) {
        left -= dropped;
        since_clip = 0;
        continue;
      }
      const std::uint32_t forced = smallest_convex(at, left);
      if (forced != none) {
        at = nodes_[cut(forced, triangles)].prev;  // one step back, so that scans for convex corners add up to O(n)
        --left;
      } else if (!reversed && has_area(at, left)) {
        reverse(at, left);  // what is left runs the wrong way round, as the second loop of a figure of eight does
        reversed = true;
      } else {
        break;  // nothing but straight lines
      }
      since_clip = 0;
    }
    return triangles;
  }

 private:
  [[nodiscard]] double corner(std::uint32_t i) const noexcept {
    return orient(nodes_[nodes_[i].prev].p, nodes_[i].p, nodes_[nodes_[i].next].p);
  }

  [[nodiscard]] bool right_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) const noexcept {
    return orient(a, b, p) < -noise_ * length_l1(b - a);
  }

  [[nodiscard]] bool convex(std::uint32_t i) const noexcept {
    const Node& n = nodes_[i];
    const double longest = std::max(length_l1(n.p - nodes_[n.prev].p), length_l1(nodes_[n.next].p - n.p));
    return corner(i) > noise_ * longest;
  }

  [[nodiscard]] std::uint32_t rightmost(std::uint32_t ring) const noexcept {
    std::uint32_t best = ring;
    for (std::uint32_t i = nodes_[ring].next; i != ring; i = nodes_[i].next) {
      if (nodes_[i].p.x > nodes_[best].p.x) best = i;
    }
    return best;
  }

  // Whether the way from node i to q begins inside the polygon.
  [[nodiscard]] bool opens_towards(std::uint32_t i, const glm::dvec2& q) const noexcept {
    const Node& n = nodes_[i];
    const glm::dvec2& a = nodes_[n.prev].p;
    const glm::dvec2& c = nodes_[n.next].p;
    if (orient(a, n.p, c) > 0.0) return orient(n.p, c, q) >= 0.0 && orient(n.p, q, a) >= 0.0;
    return orient(n.p, c, q) >= 0.0 || orient(n.p, q, a) >= 0.0;
  }

  // A vertex of the ring of `outer` that sees the rightmost vertex of a hole, or `none` if the hole lies outside.
  [[nodiscard]] std::uint32_t find_bridge(std::uint32_t outer, std::uint32_t hole) const noexcept {
    const glm::dvec2 m = nodes_[hole].p;
    double hit_x = std::numeric_limits<double>::infinity();
    std::uint32_t best = none;
    std::uint32_t i = outer;
    do {  // the side hit first by the ray to the right; the inside is to the left of it, so it runs upwards
      const Node& n = nodes_[i];
      const glm::dvec2 a = n.p;
      const glm::dvec2 b = nodes_[n.next].p;
      if (a.y <= m.y && m.y <= b.y && a.y != b.y) {
        const double x = a.x + (m.y - a.y) / (b.y - a.y) * (b.x - a.x);
        if (x >= m.x && x < hit_x) {
          hit_x = x;
          best = a.x > b.x ? i : n.next;
        }
      }
      i = n.next;
    } while (i != outer);
    if (best == none) return none;

    // Vertices in the triangle (m, hit, best) hide `best`; of them the one nearest in angle to the ray is seen.
    const glm::dvec2 hit{hit_x, m.y};
    const glm::dvec2 p = nodes_[best].p;
    double best_slope = std::numeric_limits<double>::infinity();
    std::uint32_t seen = none;
    i = outer;
    do {
      const glm::dvec2 q = nodes_[i].p;
      if (q.x >= m.x && q.x <= std::max(hit_x, p.x) && inside(m, hit, p, q) && opens_towards(i, m)) {
        const double slope = q == m ? 0.0 : std::abs(q.y - m.y) / std::max(q.x - m.x, 1e-300);
        if (slope < best_slope || (slope == best_slope && q.x < nodes_[seen].p.x)) {
          best_slope = slope;
          seen = i;
        }
      }
      i = nodes_[i].next;
    } while (i != outer);
    return seen == none ? best : seen;
  }

  // In the closed triangle, which may turn either way.
  [[nodiscard]] static bool inside(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& q) {
    const double u = orient(a, b, q);
    const double v = orient(b, c, q);
    const double w = orient(c, a, q);
    return (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
  }

  // Makes one ring of two: ... a h ... h' a' ...
  void connect(std::uint32_t a, std::uint32_t h) {
    const auto a2 = static_cast<std::uint32_t>(nodes_.size());
    const std::uint32_t h2 = a2 + 1;
    const Node at_a = nodes_[a];
    const Node at_h = nodes_[h];
    nodes_.push_back({.p = at_a.p, .point = at_a.point, .prev = h2, .next = at_a.next});
    nodes_.push_back({.p = at_h.p, .point = at_h.point, .prev = at_h.prev, .next = a2});
    nodes_[at_a.next].prev = a2;
    nodes_[at_h.prev].next = h2;
    nodes_[a].next = h;
    nodes_[h].prev = a;
  }

  [[nodiscard]] bool is_ear(Grid& grid, std::uint32_t i) {
    if (!convex(i)) return false;
    const std::uint32_t ia = nodes_[i].prev;
    const std::uint32_t ic = nodes_[i].next;
    const glm::dvec2 a = nodes_[ia].p;
    const glm::dvec2 b = nodes_[i].p;
    const glm::dvec2 c = nodes_[ic].p;
    std::uint64_t work = 0;
    const bool blocked = grid.any(
        glm::min(a, glm::min(b, c)) - noise_, glm::max(a, glm::max(b, c)) + noise_, work,
        [&](std::uint32_t q) { return gone_[q] != 0 || convex(q); },
        [&](std::uint32_t q) {
          if (q == ia || q == i || q == ic) return false;
          const glm::dvec2 p = nodes_[q].p;
          if (p == a) return enters(q, a, b, c);
          if (p == b) return enters(q, b, c, a);
          if (p == c) return enters(q, c, a, b);
          return !right_of(a, b, p) && !right_of(b, c, p) && !right_of(c, a, p);
        });
    budget_ -= std::min(budget_, work + 1);
    return !blocked;
  }

  // Whether the outside at node q, which lies on corner a of a triangle, reaches into the triangle. Both are cones
  // with one apex: they overlap if a ray of one, or the middle if they are equal, is inside the other.
  [[nodiscard]] bool enters(std::uint32_t q, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) const {
    const glm::dvec2& prev = nodes_[nodes_[q].prev].p;
    const glm::dvec2& next = nodes_[nodes_[q].next].p;
    const auto in_triangle = [&](const glm::dvec2& p) { return right_of(b, a, p) && right_of(a, c, p); };
    const auto outside = [&](const glm::dvec2& p) { return right_of(prev, a, p) && right_of(a, next, p); };
    const glm::dvec2 middle = (prev - a) / length_l1(prev - a) + (next - a) / length_l1(next - a);
    return in_triangle(prev) || in_triangle(next) || in_triangle(a + middle) || outside(b) || outside(c);
  }

  // Removes vertex i with its triangle; returns the one after it.
  std::uint32_t cut(std::uint32_t i, Triangles& triangles) {
    const Node& n = nodes_[i];
    triangles.push_back({nodes_[n.prev].point, n.point, nodes_[n.next].point});
    unlink(i);
    return n.next;
  }

  void unlink(std::uint32_t i) noexcept {
    nodes_[nodes_[i].prev].next = nodes_[i].next;
    nodes_[nodes_[i].next].prev = nodes_[i].prev;
    gone_[i] = 1;
  }

  // Where the way leads out and straight back, both sides enclose nothing. Returns how many vertices went.
  std::uint32_t drop_hairpins(std::uint32_t& at, std::uint32_t left) noexcept {
    std::uint32_t dropped = 0;
    if (budget_ == 0) return 0;
    budget_ -= std::min<std::uint64_t>(budget_, left);
    for (std::uint32_t k = 0; k < left && left - dropped > 2; ++k) {
      const std::uint32_t prev = nodes_[at].prev;
      const std::uint32_t next = nodes_[at].next;
      if (nodes_[prev].p == nodes_[next].p) {
        unlink(at);
        unlink(next);
        dropped += 2;
        at = prev;
      } else {
        at = next;
      }
    }
    return dropped;
  }

  // Without an ear: the convex corner that does least harm. Once the budget is spent the next best must do.
  [[nodiscard]] std::uint32_t smallest_convex(std::uint32_t start, std::uint32_t left) noexcept {
    std::uint32_t best = none;
    double best_area = std::numeric_limits<double>::infinity();
    std::uint32_t i = start;
    for (std::uint32_t k = 0; k < left; ++k, i = nodes_[i].next) {
      const double area = corner(i);
      if (area > 0.0 && area < best_area) {
        best_area = area;
        best = i;
        if (budget_ == 0) break;
      }
    }
    budget_ -= std::min<std::uint64_t>(budget_, left);
    return best;
  }

  [[nodiscard]] bool has_area(std::uint32_t start, std::uint32_t left) const noexcept {
    std::uint32_t i = start;
    for (std::uint32_t k = 0; k < left; ++k, i = nodes_[i].next) {
      if (corner(i) != 0.0) return true;
    }
    return false;
  }

  void reverse(std::uint32_t start, std::uint32_t left) noexcept {
    std::uint32_t i = start;
    for (std::uint32_t k = 0; k < left; ++k) {
      std::swap(nodes_[i].prev, nodes_[i].next);
      i = nodes_[i].prev;
    }
  }

  double noise_ = 0.0;
  std::vector<Node> nodes_;
  std::vector<std::uint8_t> gone_;
  std::uint64_t budget_ = 0;
};

struct Scaled {
  std::vector<glm::dvec3> points;  // relative to the first and of unit size; empty if that is impossible
  double noise = 0.0;              // what rounding of the original coordinates amounts to here
};

Scaled normalised(std::span<const glm::dvec3> points) {
  double extent = 0.0;
  double magnitude = 0.0;
  for (const glm::dvec3& p : points) {
    const glm::dvec3 d = glm::abs(p - points[0]);
    const glm::dvec3 m = glm::abs(p);
    if (!std::isfinite(d.x + d.y + d.z) || !std::isfinite(m.x + m.y + m.z)) return {};
    extent = std::max({extent, d.x, d.y, d.z});
    magnitude = std::max({magnitude, m.x, m.y, m.z});
  }
  if (extent == 0.0) return {};
  Scaled scaled{.points = {points.begin(), points.end()},
                .noise = 4.0 * std::numeric_limits<double>::epsilon() * (1.0 + magnitude / extent)};
  for (glm::dvec3& p : scaled.points) p = (p - points[0]) / extent;
  return scaled;
}

// Four corners, convex: cut along the shorter diagonal. Empty otherwise.
Triangles convex_quad(const std::vector<glm::dvec2>& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    if (!(orient(p[i], p[(i + 1) % 4], p[(i + 2) % 4]) > 0.0)) return {};
  }
  if (glm::distance(p[0], p[2]) <= glm::distance(p[1], p[3])) return {{0, 1, 2}, {0, 2, 3}};
  return {{0, 1, 3}, {1, 2, 3}};
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const glm::dvec3> points,
                                                              std::span<const std::uint32_t> ring_ends) {
  assert(std::is_sorted(ring_ends.begin(), ring_ends.end()));
  assert(ring_ends.empty() ? points.empty() : ring_ends.back() == points.size());
  if (points.size() < 3 || ring_ends.empty()) return {};
  if (points.size() == 3 && ring_ends[0] == 3) return {{0, 1, 2}};
  const Scaled scaled = normalised(points);
  if (scaled.points.empty()) return {};
  const glm::dvec3 normal = plane_normal(std::span{scaled.points}.first(ring_ends[0]));
  if (glm::dot(normal, normal) == 0.0) return {};

  const Projection project{normal};
  std::vector<glm::dvec2> flat(scaled.points.size());
  std::transform(scaled.points.begin(), scaled.points.end(), flat.begin(), project);
  if (flat.size() == 4 && ring_ends[0] == 4) {
    if (Triangles quad = convex_quad(flat); !quad.empty()) return quad;
  }
  EarClipper clipper{scaled.noise};
  std::uint32_t outer = none;
  std::vector<std::uint32_t> holes;
  std::uint32_t begin = 0;
  for (const std::uint32_t end : ring_ends) {
    const std::uint32_t ring = clipper.add_ring(std::span{flat}.subspan(begin, end - begin), begin, begin == 0);
    if (begin == 0) {
      outer = ring;
    } else if (ring != none) {
      holes.push_back(ring);
    }
    begin = end;
  }
  if (outer == none) return {};
  clipper.join_holes(outer, std::move(holes));
  return clipper.clip(outer);
}

}  // namespace lodestone
