// SPDX-License-Identifier: MIT
// Based on: Campos et al. 2020, section 4.3 (lines and points are simplified apart and meet in a constrained Delaunay
// triangulation).
// Differs: borders are the chains that all methods share; rims of voids are lines as well.
#include "terrain/point_set.h"

#include <algorithm>

#include "terrain/feature_lines.h"
#include "terrain/over_data.h"

namespace lodestone::terrain {
namespace {

class PointSetTin {
 public:
  PointSetTin(const TileLattice& lattice, const PointSetTask& task)
      : lattice_{lattice}, task_{task}, vertex_at_(std::size_t{size + 1} * (size + 1), none) {
    for (const Post p : {Post{0, 0}, Post{size, 0}, Post{size, size}, Post{0, size}}) {
      vertex_at_[place_of(p)] = static_cast<std::uint32_t>(heights_m_.size());
      heights_m_.push_back(lattice.vertex_height_m(p));
    }
  }

  void add_lines(std::span<const Tin::Vertex> border) {
    std::vector<Post> others;
    for (const Tin::Vertex& vertex : border) {
      const Post p{nearest_post(vertex.u), nearest_post(vertex.v)};
      const std::uint32_t id = add({vertex.u, vertex.v}, vertex.height_m);
      heights_m_[id] = vertex.height_m;  // of a corner, which was there
      if (quantized(p.x) == vertex.u && quantized(p.y) == vertex.v) vertex_at_[place_of(p)] = id;
      others.push_back(p);
    }
    for (const Post p : task_.inside) add_post(p);
    if (!lattice_.complete()) {
      for (const Post p : rim_posts(lattice_)) others.push_back(p);
      keep_rims();
    }
    std::vector<FeatureLine> lines = feature_lines(lattice_, task_.feature_angle_rad, task_.feature_edges);
    simplify_lines(lines, lattice_, task_.samples.spacing_m, others, task_.tolerance_m);
    for (const FeatureLine& line : lines) {
      std::uint32_t before = add_post(line.front());
      for (std::size_t i = 1; i < line.size(); ++i) {
        const std::uint32_t id = add_post(line[i]);
        triangulation_.keep_line(before, id);
        before = id;
      }
    }
  }

  void add_samples() {
    const std::vector<Post> posts = sample_posts(lattice_);
    switch (task_.method) {
      case TerrainMethod::PointsGrid:
        return add_posts(grid_points(posts, task_.samples));
      case TerrainMethod::PointsHierarchy:
        return add_posts(hierarchy_points(lattice_, posts, task_.samples));
      case TerrainMethod::PointsWlop:
        return add_places(wlop_points(lattice_, posts, task_.samples));
      default:
        return add_posts(random_points(posts, task_.samples));
    }
  }

  [[nodiscard]] MeasuredTin result() const {
    MeasuredTin made{tin_over_data(triangulation_, lattice_, heights_m_, task_.step_m), {}};
    made.error = measure(made.tin, lattice_, task_.tolerance_m + 0.5 * task_.step_m);
    return made;
  }

 private:
  [[nodiscard]] static std::size_t place_of(Post p) {
    return static_cast<std::size_t>(p.y) * (size + 1) + static_cast<std::size_t>(p.x);
  }
  // The vertex at a quantised place, added if there is none.
  std::uint32_t add(Post at, double height_m) {
    last_ = triangulation_.locate(at, last_);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = triangulation_.corners()[3 * last_ + k];
      if (triangulation_.posts()[corner] == at) return corner;
    }
    heights_m_.push_back(height_m);
    return triangulation_.insert(at, last_);
  }
  std::uint32_t add_post(Post p) {
    std::uint32_t& id = vertex_at_[place_of(p)];
    if (id == none) id = add({quantized(p.x), quantized(p.y)}, lattice_.vertex_height_m(p));
    return id;
  }
  void add_posts(const std::vector<Post>& posts) {
    for (const Post p : posts) add_post(p);
  }
  void add_places(const std::vector<glm::dvec3>& places) {
    constexpr double units = static_cast<double>(quantized_max) / size;
    for (const glm::dvec3& p : places) {
      const Post at{static_cast<int>(p.x * units + 0.5), static_cast<int>(p.y * units + 0.5)};
      if (lattice_.cell(static_cast<int>(p.x), static_cast<int>(p.y))) add(at, p.z);
    }
  }
  void keep_rims() {
    const auto keep = [&](Post a, Post b, bool first, bool second) {
      if (first != second) triangulation_.keep_line(add_post(a), add_post(b));
    };
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        if (y > 0) keep({x, y}, {x + 1, y}, lattice_.cell(x, y), lattice_.cell(x, y - 1));
        if (x > 0) keep({x, y}, {x, y + 1}, lattice_.cell(x, y), lattice_.cell(x - 1, y));
      }
    }
  }

  const TileLattice& lattice_;
  const PointSetTask& task_;
  LatticeDelaunay triangulation_{quantized_max};
  std::vector<double> heights_m_;         // per vertex
  std::vector<std::uint32_t> vertex_at_;  // per post
  std::uint32_t last_ = 0;
};

}  // namespace

MeasuredTin point_set_tin(const TileLattice& lattice, std::span<const Tin::Vertex> border, const PointSetTask& task) {
  PointSetTin tin{lattice, task};
  tin.add_lines(border);
  tin.add_samples();
  return tin.result();
}

}  // namespace lodestone::terrain
