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
#include "terrain/over_data.h"

namespace lodestone::terrain {
namespace {

class Greedy {
 public:
  Greedy(const TileLattice& lattice, std::span<const Tin::Vertex> border, const GreedyOptions& options)
      : lattice_{lattice}, step_m_{options.step_m}, field_{lattice, options.step_m, on_posts(border)} {
    limit_m_ = options.tolerance_m + 0.5 * step_m_;
    tolerance_ = static_cast<std::int32_t>(std::min(options.tolerance_m / field_.unit_m(), 1e9));
    vertex_at_.assign(std::size_t{size + 1} * (size + 1), none);
    for (const Post p : {Post{0, 0}, Post{size, 0}, Post{size, size}, Post{0, size}}) {
      vertex_at_[place_of(p)] = static_cast<std::uint32_t>(heights_.size());
      heights_.push_back(field_.to_units(field_.vertex_height_m(p)));
    }
    for (const Tin::Vertex& vertex : border) add_border(vertex);
    for (const Post p : options.inside) add(p);
  }

  // Posts that are off still are those that a client decodes a little beside, on steep ground: a vertex there is too
  // high or low by what is measured, another post becomes a vertex. Vertices are off by less each round where their
  // neighbours are near, so in the end these are made vertices as well.
  [[nodiscard]] MeasuredTin run() {
    refine();
    MeasuredTin made{result(), {}};
    made.error = measure(made.tin, lattice_, limit_m_);
    constexpr int most_rounds = 32, alone = 4;
    for (int round = 0; round < most_rounds && !made.error.too_far.empty(); ++round) {
      bool changed = false;
      for (const TinError::Off& off : made.error.too_far) {
        if (!inside(off.post)) continue;
        changed = true;
        if (!add(off.post)) heights_[vertex_at_[place_of(off.post)]] -= off.off_m / field_.unit_m();
        if (round >= alone) add_around(off.post);
      }
      if (!changed) break;
      refine();
      made.tin = result();
      made.error = measure(made.tin, lattice_, limit_m_);
    }
    return made;
  }

 private:
  [[nodiscard]] static bool on_posts(std::span<const Tin::Vertex> border) {
    return std::all_of(border.begin(), border.end(), [](const Tin::Vertex& vertex) {
      return vertex.u == quantized(nearest_post(vertex.u)) && vertex.v == quantized(nearest_post(vertex.v));
    });
  }

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
        if (triangulation_.version(candidate.triangle) != candidate.version) continue;
        if (vertex_at_[place_of(candidate.post)] == none) insert(candidate.post, candidate.triangle);
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

  [[nodiscard]] static bool inside(Post p) { return p.x > 0 && p.x < size && p.y > 0 && p.y < size; }
  [[nodiscard]] static std::size_t place_of(Post p) {
    return static_cast<std::size_t>(p.y) * (size + 1) + static_cast<std::size_t>(p.x);
  }

  void insert(Post p, std::uint32_t near) {
    last_ = near;
    vertex_at_[place_of(p)] = triangulation_.insert({quantized(p.x), quantized(p.y)}, near);
    heights_.push_back(field_.to_units(field_.vertex_height_m(p)));
  }
  // False: it is a vertex already.
  bool add(Post p) {
    if (vertex_at_[place_of(p)] != none) return false;
    insert(p, last_);
    return true;
  }
  void add_border(const Tin::Vertex& vertex) {
    const Post at{vertex.u, vertex.v};
    const std::uint32_t t = triangulation_.locate(at, last_);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = triangulation_.corners()[3 * t + k];
      if (triangulation_.posts()[corner] != at) continue;
      heights_[corner] = field_.to_units(vertex.height_m);
      return;
    }
    last_ = t;
    triangulation_.insert(at, t);
    heights_.push_back(field_.to_units(vertex.height_m));
  }
  void add_around(Post p) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Post beside{p.x + dx, p.y + dy};
        if (inside(beside) && lattice_.valid(beside.x, beside.y)) add(beside);
      }
    }
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

  [[nodiscard]] Tin result() const {
    std::vector<double> heights_m;
    heights_m.reserve(heights_.size());
    for (const double units : heights_) heights_m.push_back(field_.to_m(units));
    return tin_over_data(triangulation_, lattice_, heights_m, step_m_);
  }

  const TileLattice& lattice_;
  double step_m_;
  HeightField field_;
  LatticeDelaunay triangulation_{quantized_max};
  double limit_m_ = 0.0;
  std::int32_t tolerance_ = 0;                                // in units of the field
  std::vector<double> heights_;                               // per vertex, in units of the field
  std::vector<std::uint32_t> vertex_at_;                      // per post; not of those on the border between corners
  std::array<std::vector<Candidate>, bucket_count> buckets_;  // those of triangles that changed since do not count
  std::vector<Candidate> taken_;
  std::uint32_t last_ = 0;
};

}  // namespace

MeasuredTin greedy_insertion(const TileLattice& lattice, std::span<const Tin::Vertex> border,
                             const GreedyOptions& options) {
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
