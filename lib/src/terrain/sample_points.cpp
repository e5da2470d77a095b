// SPDX-License-Identifier: MIT
// Based on: Campos et al. 2020, section 4.3.2 (random, grid), and Pauly, Gross and Kobbelt 2002, "Efficient
// simplification of point-sampled surfaces" (clusters halved by covariance).
// Differs: chance is a hash of the tile and the post, so that it is the same for every order of work; a cluster is
// represented by its post nearest to the mean, not by the mean, so that vertices have heights that were measured.
#include "terrain/sample_points.h"

#include <algorithm>

#include "base/hash.h"

namespace lodestone::terrain {
namespace {

std::uint64_t chance(Post p, const SampleOptions& options) {
  return mix64(hash_combine(options.seed, static_cast<std::uint64_t>(p.y) << 32U | static_cast<std::uint32_t>(p.x)));
}

class Clusters {
 public:
  Clusters(const TileLattice& lattice, const std::vector<Post>& posts, const SampleOptions& options)
      : options_{options} {
    items_.reserve(posts.size());
    for (const Post p : posts) {
      items_.push_back({{p.x * options.spacing_m.x, p.y * options.spacing_m.y, lattice.at(p.x, p.y)}, p});
    }
  }

  [[nodiscard]] std::vector<Post> run() {
    std::vector<Post> kept;
    std::vector<std::pair<std::size_t, std::size_t>> left{{0, items_.size()}};
    while (!left.empty()) {
      const auto [begin, end] = left.back();
      left.pop_back();
      if (begin == end) continue;
      const Shape shape = shape_of(begin, end);
      const bool small = end - begin <= options_.cluster_posts;
      if (end - begin == 1 || (small && shape.variation <= options_.surface_variation)) {
        kept.push_back(nearest(begin, end, shape.mean));
        continue;
      }
      const auto middle = std::partition(
          items_.begin() + static_cast<std::ptrdiff_t>(begin), items_.begin() + static_cast<std::ptrdiff_t>(end),
          [&](const Item& item) { return glm::dot(item.place_m - shape.mean, shape.axis) < 0.0; });
      const auto cut = static_cast<std::size_t>(middle - items_.begin());
      if (cut == begin || cut == end) {
        kept.push_back(nearest(begin, end, shape.mean));
        continue;
      }
      left.emplace_back(cut, end);
      left.emplace_back(begin, cut);
    }
    return kept;
  }

 private:
  struct Item {
    glm::dvec3 place_m{0.0};
    Post post;
  };
  struct Shape {
    glm::dvec3 mean{0.0};
    glm::dvec3 axis{1.0, 0.0, 0.0};  // of the largest spread
    double variation = 0.0;          // smallest spread as a share of all
  };

  [[nodiscard]] Shape shape_of(std::size_t begin, std::size_t end) const {
    const glm::dvec3 origin = items_[begin].place_m;
    glm::dvec3 sum{0.0}, squares{0.0}, products{0.0};  // xx, yy, zz; xy, yz, zx
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 d = items_[i].place_m - origin;
      sum += d;
      squares += d * d;
      products += d * glm::dvec3{d.y, d.z, d.x};
    }
    const auto count = static_cast<double>(end - begin);
    const glm::dvec3 mean = sum / count;
    squares = squares / count - mean * mean;
    products = products / count - mean * glm::dvec3{mean.y, mean.z, mean.x};
    Shape shape;
    shape.mean = origin + mean;
    const glm::dmat3 m{squares.x,  products.x, products.z, products.x, squares.y,
                       products.y, products.z, products.y, squares.z};
    const double trace = squares.x + squares.y + squares.z;
    if (!(trace > 0.0)) return shape;
    // The eigenvalues of a symmetric matrix of three (Smith 1961).
    const double third = trace / 3.0;
    const glm::dmat3 off = m - glm::dmat3{third};
    double square_sum = 0.0;
    for (int k = 0; k < 3; ++k) square_sum += glm::dot(off[k], off[k]);
    const double p = std::sqrt(square_sum / 6.0);
    if (!(p > 1e-12 * trace)) return {shape.mean, shape.axis, 1.0 / 3.0};
    const double r = std::clamp(glm::determinant(off) / (2.0 * p * p * p), -1.0, 1.0);
    const double angle = std::acos(r) / 3.0;
    const double largest = third + 2.0 * p * std::cos(angle);
    const double smallest = third + 2.0 * p * std::cos(angle + 2.0943951023931953);
    shape.variation = std::max(smallest, 0.0) / trace;
    // Rows of m - largest are normal to the axis.
    const glm::dmat3 rows = m - glm::dmat3{largest};
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 normal = glm::cross(rows[k], rows[(k + 1) % 3]);
      if (glm::dot(normal, normal) > longest) longest = glm::dot(normal, normal), shape.axis = normal;
    }
    return shape;
  }

  [[nodiscard]] Post nearest(std::size_t begin, std::size_t end, const glm::dvec3& mean) const {
    const Item* best = &items_[begin];
    const auto distance = [&](const Item& item) {
      const glm::dvec3 d = item.place_m - mean;
      return glm::dot(d, d);
    };
    double least = distance(*best);
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double here = distance(items_[i]);
      const Post p = items_[i].post, q = best->post;
      const bool earlier = p.y != q.y ? p.y < q.y : p.x < q.x;
      if (here < least || (here == least && earlier)) best = &items_[i], least = here;
    }
    return best->post;
  }

  const SampleOptions& options_;
  std::vector<Item> items_;
};

}  // namespace

std::vector<Post> sample_posts(const TileLattice& lattice) {
  std::vector<Post> posts;
  const bool complete = lattice.complete();
  for (int y = 1; y < size; ++y) {
    for (int x = 1; x < size; ++x) {
      const bool used = complete || lattice.cell(x, y) || lattice.cell(x - 1, y) || lattice.cell(x, y - 1) ||
                        lattice.cell(x - 1, y - 1);
      if (used) posts.push_back({x, y});
    }
  }
  return posts;
}

std::vector<Post> random_points(const std::vector<Post>& posts, const SampleOptions& options) {
  struct Drawn {
    std::uint64_t lot = 0;
    Post post;
  };
  std::vector<Drawn> drawn;
  drawn.reserve(posts.size());
  for (const Post p : posts) drawn.push_back({chance(p, options), p});
  const auto count = static_cast<std::size_t>(static_cast<double>(posts.size()) * options.keep_ratio + 0.5);
  const auto end = drawn.begin() + static_cast<std::ptrdiff_t>(std::min(count, drawn.size()));
  const auto by_lot = [](const Drawn& a, const Drawn& b) { return a.lot < b.lot; };
  std::nth_element(drawn.begin(), end, drawn.end(), by_lot);
  // Row by row, so that the triangulation finds the next point near the last.
  std::sort(drawn.begin(), end, [](const Drawn& a, const Drawn& b) {
    return a.post.y != b.post.y ? a.post.y < b.post.y : a.post.x < b.post.x;
  });
  std::vector<Post> kept;
  for (auto at = drawn.begin(); at != end; ++at) kept.push_back(at->post);
  return kept;
}

std::vector<Post> grid_points(const std::vector<Post>& posts, const SampleOptions& options) {
  const int cells = (size + options.cell_posts - 1) / options.cell_posts;
  std::vector<Post> drawn(static_cast<std::size_t>(cells * cells));  // (0, 0): none, which is no post inside
  for (const Post p : posts) {
    Post& best = drawn[static_cast<std::size_t>(p.y / options.cell_posts * cells + p.x / options.cell_posts)];
    if (best == Post{} || chance(p, options) < chance(best, options)) best = p;
  }
  std::erase(drawn, Post{});
  return drawn;
}

std::vector<Post> hierarchy_points(const TileLattice& lattice, const std::vector<Post>& posts,
                                   const SampleOptions& options) {
  return Clusters{lattice, posts, options}.run();
}

}  // namespace lodestone::terrain
