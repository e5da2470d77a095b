// SPDX-License-Identifier: MIT
// Based on: Garland and Heckbert 1995, "Fast polygonal approximation of terrains and height fields".
// Differs: starts from the border chains; candidates are in buckets by error instead of a heap, and all of the top
// bucket are inserted before new triangles are scanned. That scans a post a third as often, at 2 to 5 % more triangles.
#include "terrain/greedy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "terrain/delaunay.h"
#include "terrain/field.h"

namespace lodestone::terrain {
namespace {

class Greedy {
 public:
  Greedy(const TileLattice& lattice, std::span<const Post> border, const GreedyOptions& options)
      : lattice_{lattice}, field_{lattice, options.step_m}, triangulation_{size} {
    limit_m_ = options.tolerance_m + 0.5 * options.step_m;
    tolerance_ = static_cast<std::int32_t>(std::min(options.tolerance_m / field_.unit_m(), 1e9));
    for (const Post p : triangulation_.posts()) heights_.push_back(field_.vertex_units(p));
    for (const Post p : border) add(p);
    for (const Post p : options.inside) add(p);
  }

  [[nodiscard]] MeasuredTin run() {
    refine();
    MeasuredTin made{result(), {}};
    made.error = measure(made.tin, lattice_, limit_m_);
    // Posts between places as they are and as they are quantised; few, and seldom.
    constexpr int most_rounds = 16;
    for (int round = 0; round < most_rounds && !made.error.too_far.empty(); ++round) {
      const std::size_t before = heights_.size();
      for (const Post p : made.error.too_far) {
        if (p.x > 0 && p.x < size && p.y > 0 && p.y < size) add(p);
      }
      if (heights_.size() == before) break;
      refine();
      made.tin = result();
      made.error = measure(made.tin, lattice_, limit_m_);
    }
    return made;
  }

 private:
  void refine() {
    scan();
    for (std::size_t top = buckets_.size(); top > 0;) {
      std::vector<Candidate>& bucket = buckets_[top - 1];
      if (bucket.empty()) {
        --top;
        continue;
      }
      taken_.swap(bucket);
      for (const Candidate& candidate : taken_) {
        if (triangulation_.version(candidate.triangle) == candidate.version) insert(candidate.post, candidate.triangle);
      }
      taken_.clear();
      top = std::max(top, scan() + 1);
    }
  }

  // Errors of a bucket are within a factor of 1.5, those of the next are larger.
  static constexpr std::size_t bucket_count = 64;
  [[nodiscard]] static std::size_t bucket_of(std::int32_t error) {
    constexpr std::uint32_t mantissa_bits = 23, one = 127U << mantissa_bits;
    return (std::bit_cast<std::uint32_t>(static_cast<float>(error)) - one) >> (mantissa_bits - 1);
  }

  struct Candidate {
    Post post;
    std::uint32_t triangle = 0;
    std::uint32_t version = 0;
  };

  [[nodiscard]] static bool is_corner(Post p) { return (p.x == 0 || p.x == size) && (p.y == 0 || p.y == size); }

  void insert(Post p, std::uint32_t near) {
    last_ = near;
    triangulation_.insert(p, near);
    heights_.push_back(field_.vertex_units(p));
  }
  void add(Post p) {
    if (is_corner(p)) return;
    const std::uint32_t t = triangulation_.locate(p, last_);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (triangulation_.posts()[triangulation_.corners()[3 * t + k]] == p) return;
    }
    insert(p, t);
  }

  // Looks at all changed triangles; returns the highest bucket that got a candidate.
  std::size_t scan() {
    std::size_t top = 0;
    for (const std::uint32_t t : triangulation_.changed()) {
      const std::uint32_t* v = triangulation_.corners().data() + 3 * std::size_t{t};
      const double za = heights_[v[0]], zb = heights_[v[1]], zc = heights_[v[2]];
      if (std::isnan(za + zb + zc)) continue;  // a corner of the tile without data
      const auto& posts = triangulation_.posts();
      const Worst worst = field_.worst_post(posts[v[0]], posts[v[1]], posts[v[2]], za, zb, zc);
      if (worst.error <= tolerance_) continue;
      const std::size_t b = bucket_of(worst.error);
      buckets_[b].push_back({worst.post, t, triangulation_.version(t) + 1});
      top = std::max(top, b);
    }
    triangulation_.forget_changes();
    return top;
  }

  // A triangle lies wholly over cells with data or wholly over others: any cell that it overlaps tells.
  [[nodiscard]] bool over_data(const std::uint32_t* v) const {
    const auto& posts = triangulation_.posts();
    for (int k = 0; k < 3; ++k) {
      if (std::isnan(heights_[v[k]])) return false;
    }
    const int x = (posts[v[0]].x + posts[v[1]].x + posts[v[2]].x) / 3;
    const int y = (posts[v[0]].y + posts[v[1]].y + posts[v[2]].y) / 3;
    return lattice_.cell(std::min(x, size - 1), std::min(y, size - 1));
  }

  [[nodiscard]] Tin result() const {
    Tin tin;
    std::vector<std::uint32_t> name(heights_.size(), none);
    for (std::uint32_t t = 0; t < triangulation_.triangle_count(); ++t) {
      const std::uint32_t* v = triangulation_.corners().data() + 3 * std::size_t{t};
      if (!over_data(v)) continue;
      for (int k = 0; k < 3; ++k) {
        if (name[v[k]] == none) {
          name[v[k]] = static_cast<std::uint32_t>(tin.vertices.size());
          const Post p = triangulation_.posts()[v[k]];
          tin.vertices.push_back({quantized(p.x), quantized(p.y), field_.vertex_height_m(p)});
        }
        tin.triangles.push_back(name[v[k]]);
      }
    }
    return tin;
  }

  const TileLattice& lattice_;
  HeightField field_;
  LatticeDelaunay triangulation_;
  double limit_m_ = 0.0;
  std::int32_t tolerance_ = 0;                                // in units of the field
  std::vector<double> heights_;                               // per vertex
  std::array<std::vector<Candidate>, bucket_count> buckets_;  // those of triangles that changed since do not count
  std::vector<Candidate> taken_;
  std::uint32_t last_ = 0;
};

}  // namespace

MeasuredTin greedy_insertion(const TileLattice& lattice, std::span<const Post> border, const GreedyOptions& options) {
  return Greedy{lattice, border, options}.run();
}

std::vector<Post> rim_posts(const TileLattice& lattice) {
  std::vector<Post> rim;
  for (int y = 1; y < size; ++y) {
    for (int x = 1; x < size; ++x) {
      const int cells = static_cast<int>(lattice.cell(x, y)) + static_cast<int>(lattice.cell(x - 1, y)) +
                        static_cast<int>(lattice.cell(x, y - 1)) + static_cast<int>(lattice.cell(x - 1, y - 1));
      if (cells > 0 && cells < 4) rim.push_back({x, y});
    }
  }
  return rim;
}

}  // namespace lodestone::terrain
