// SPDX-License-Identifier: MIT
// Based on: Huang, Li, Zhang, Ascher and Cohen-Or 2009, "Consolidation of unorganized point clouds for surface
// reconstruction" (weighted locally optimal projection).
// Differs: neighbours are found by their place among the posts; the kernel ends at three quarters of the radius, where
// it is below 1/8000, and comes from a table; distances are never taken below a sixteenth of the radius.
// Where the radius spans 16 posts and more, the density of posts is found at every second, third ... of them and among
// these only, and holds for those beside it: it would take nine tenths of the time, and is much the same there.
#include <algorithm>
#include <cmath>

#include "terrain/sample_points.h"

namespace lodestone::terrain {
namespace {

class Projection {
 public:
  Projection(const TileLattice& lattice, const std::vector<Post>& posts, const SampleOptions& options)
      : lattice_{lattice}, options_{options}, weights_(std::size_t{size + 1} * (size + 1), 0.0F) {
    radius_m_ = options.radius_posts * std::sqrt(options.spacing_m.x * options.spacing_m.y);
    inverse_radius2_ = 1.0 / (radius_m_ * radius_m_);
    const auto reach = [&](double spacing_m) {
      // Near a pole posts crowd eastwards: as many are enough as there are northwards, and half more.
      return static_cast<int>(std::ceil(std::min(0.75 * radius_m_ / spacing_m, 1.125 * options_.radius_posts)));
    };
    reach_x_ = reach(options.spacing_m.x);
    reach_y_ = reach(options.spacing_m.y);
    for (std::size_t i = 0; i < kernel_.size(); ++i) {
      const double share2 = (static_cast<double>(i) + 0.5) * kernel_end / kernel_steps;  // of the radius, squared
      const double theta = std::exp(-16.0 * share2);
      kernel_[i] = {static_cast<float>(theta),
                    static_cast<float>(theta / (radius_m_ * std::max(std::sqrt(share2), 1.0 / 16.0)))};
    }
    for (const Post p : posts) weights_[place_of(p)] = 1.0F;
    weigh(posts);
    points_ = random_points_of(posts);
  }

  [[nodiscard]] std::vector<glm::dvec3> run() {
    for (int i = 0; i < options_.iterations; ++i) iterate();
    for (glm::dvec3& p : points_) p = {p.x / options_.spacing_m.x, p.y / options_.spacing_m.y, p.z};
    return points_;
  }

 private:
  static constexpr std::size_t kernel_steps = 4096;
  static constexpr double kernel_end = 0.5625;

  [[nodiscard]] static std::size_t place_of(Post p) {
    return static_cast<std::size_t>(p.y) * (size + 1) + static_cast<std::size_t>(p.x);
  }
  [[nodiscard]] glm::dvec3 place_m(const glm::dvec3& at) const {
    return {at.x * options_.spacing_m.x, at.y * options_.spacing_m.y, at.z};
  }
  [[nodiscard]] std::vector<glm::dvec3> random_points_of(const std::vector<Post>& posts) const {
    std::vector<glm::dvec3> places;
    for (const Post p : random_points(posts, options_)) places.push_back(place_m({p.x, p.y, lattice_.at(p.x, p.y)}));
    return places;
  }

  // One over the density of posts around each.
  void weigh(const std::vector<Post>& posts) {
    constexpr int least_radius = 8;
    const int stride = std::max(1, static_cast<int>(options_.radius_posts) / least_radius);
    const auto asked = [&](Post p) { return Post{p.x - p.x % stride, p.y - p.y % stride}; };
    std::vector<float> weights = weights_;
    std::vector<Post> others;
    for (const Post p : posts) {
      if (asked(p) != p && weights_[place_of(asked(p))] != 0.0F) {
        others.push_back(p);
        continue;
      }
      double density = asked(p) == p ? 0.0 : 1.0;
      const glm::dvec3 at = place_m({p.x, p.y, lattice_.at(p.x, p.y)});
      each_post(at, p, stride, [&](std::size_t, const glm::dvec3&, const Pull& found) { density += found.theta; });
      weights[place_of(p)] = static_cast<float>(1.0 / density);
    }
    for (const Post p : others) weights[place_of(p)] = weights[place_of(asked(p))];
    weights_ = std::move(weights);
  }

  // The kernel, and the kernel over the distance. Both 0 beyond its end.
  struct Pull {
    float theta = 0.0F;
    float per_m = 0.0F;
  };
  [[nodiscard]] Pull pull(double distance2) const {
    const double share2 = distance2 * inverse_radius2_;
    return share2 < kernel_end ? kernel_[static_cast<std::size_t>(share2 * (kernel_steps / kernel_end))] : Pull{};
  }

  template <class Visit>
  void each_post(const glm::dvec3& at, Post middle, int stride, Visit visit) const {
    const auto next = [&](int post) { return (post + stride - 1) / stride * stride; };
    const int y0 = next(std::max(1, middle.y - reach_y_)), y1 = std::min(size - 1, middle.y + reach_y_);
    const double reach2 = kernel_end * radius_m_ * radius_m_;
    for (int y = y0; y <= y1; y += stride) {
      // Within the circle that the kernel has in the plane.
      const double north = y * options_.spacing_m.y, off = north - at.y;
      if (off * off >= reach2) continue;
      const int reach = std::min(reach_x_, static_cast<int>(std::sqrt(reach2 - off * off) / options_.spacing_m.x) + 1);
      const int x1 = std::min(size - 1, middle.x + reach);
      std::size_t here = place_of({next(std::max(1, middle.x - reach)), y});
      for (int x = next(std::max(1, middle.x - reach)); x <= x1;
           x += stride, here += static_cast<std::size_t>(stride)) {
        if (weights_[here] == 0.0F) continue;
        const glm::dvec3 place{x * options_.spacing_m.x, north, lattice_.at(x, y)};
        const glm::dvec3 d = place - at;
        const Pull found = pull(glm::dot(d, d));
        if (found.theta > 0.0F) visit(here, place, found);
      }
    }
  }

  // Points by bins as wide as the kernel, so that neighbours are in nine of them.
  void sort_into_bins() {
    columns_ = size / (reach_x_ + 1) + 1;
    rows_ = size / (reach_y_ + 1) + 1;
    bins_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), {});
    for (std::uint32_t i = 0; i < points_.size(); ++i) bins_[bin_of(points_[i], 0, 0)].push_back(i);
  }
  [[nodiscard]] std::size_t bin_of(const glm::dvec3& p, int dx, int dy) const {
    const int x = static_cast<int>(p.x / options_.spacing_m.x) / (reach_x_ + 1) + dx;
    const int y = static_cast<int>(p.y / options_.spacing_m.y) / (reach_y_ + 1) + dy;
    return x < 0 || y < 0 || x >= columns_ || y >= rows_ ? bins_.size() : static_cast<std::size_t>(y * columns_ + x);
  }
  template <class Visit>
  void each_point(std::uint32_t i, Visit visit) const {
    for (int k = 0; k < 9; ++k) {
      const std::size_t bin = bin_of(points_[i], k % 3 - 1, k / 3 - 1);
      if (bin == bins_.size()) continue;
      for (const std::uint32_t j : bins_[bin]) {
        if (j == i) continue;
        const glm::dvec3 d = points_[i] - points_[j];
        const Pull found = pull(glm::dot(d, d));
        if (found.theta > 0.0F) visit(j, d, found);
      }
    }
  }

  void iterate() {
    constexpr double repulsion = 0.45;
    sort_into_bins();
    std::vector<double> crowding(points_.size(), 1.0);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      each_point(i, [&](std::uint32_t, const glm::dvec3&, const Pull& found) { crowding[i] += found.theta; });
    }
    std::vector<glm::dvec3> moved(points_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const glm::dvec3& at = points_[i];
      const Post middle{static_cast<int>(std::lround(at.x / options_.spacing_m.x)),
                        static_cast<int>(std::lround(at.y / options_.spacing_m.y))};
      glm::dvec3 sum{0.0}, push{0.0};
      double weight = 0.0, push_weight = 0.0;
      each_post(at, middle, 1, [&](std::size_t here, const glm::dvec3& place, const Pull& found) {
        const double share = static_cast<double>(found.per_m) * weights_[here];
        sum += share * place;
        weight += share;
      });
      each_point(i, [&](std::uint32_t j, const glm::dvec3& d, const Pull& found) {
        const double share = crowding[j] * found.per_m;
        push += share * d;
        push_weight += share;
      });
      moved[i] = weight > 0.0 ? sum / weight : at;
      if (push_weight > 0.0) moved[i] += repulsion * push / push_weight;
      moved[i].x = std::clamp(moved[i].x, 0.25 * options_.spacing_m.x, (size - 0.25) * options_.spacing_m.x);
      moved[i].y = std::clamp(moved[i].y, 0.25 * options_.spacing_m.y, (size - 0.25) * options_.spacing_m.y);
    }
    points_ = std::move(moved);
  }

  const TileLattice& lattice_;
  const SampleOptions& options_;
  double radius_m_ = 1.0;
  double inverse_radius2_ = 1.0;
  int reach_x_ = 1;
  int reach_y_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::array<Pull, kernel_steps + 1> kernel_{};
  std::vector<float> weights_;  // per post: one over the density of posts around it; 0: none there
  std::vector<glm::dvec3> points_;
  std::vector<std::vector<std::uint32_t>> bins_;
};

}  // namespace

std::vector<glm::dvec3> wlop_points(const TileLattice& lattice, const std::vector<Post>& posts,
                                    const SampleOptions& options) {
  return Projection{lattice, posts, options}.run();
}

}  // namespace lodestone::terrain
