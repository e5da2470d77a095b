// SPDX-License-Identifier: MIT
// Based on: Huang, Li, Zhang, Ascher and Cohen-Or 2009, "Consolidation of unorganized point clouds for surface
// reconstruction" (weighted locally optimal projection).
// Differs: neighbours are found by their place among the posts; the kernel ends at three quarters of the radius, where
// it is below 1/8000, and comes from a table; distances are never taken below a sixteenth of the radius.
#include <algorithm>

#include "terrain/sample_points.h"

namespace lodestone::terrain {
namespace {

class Projection {
 public:
  Projection(const TileLattice& lattice, const std::vector<Post>& posts, const SampleOptions& options)
      : lattice_{lattice}, options_{options}, weights_(std::size_t{size + 1} * (size + 1), 0.0F) {
    radius_m_ = options.radius_posts * std::sqrt(options.spacing_m.x * options.spacing_m.y);
    const auto reach = [&](double spacing_m) {
      // Near a pole posts crowd eastwards: as many are enough as there are northwards, and half more.
      return static_cast<int>(std::ceil(std::min(0.75 * radius_m_ / spacing_m, 1.125 * options_.radius_posts)));
    };
    reach_x_ = reach(options.spacing_m.x);
    reach_y_ = reach(options.spacing_m.y);
    for (std::size_t i = 0; i < kernel_.size(); ++i) {
      const double share2 = static_cast<double>(i) * kernel_end / kernel_steps;  // of the radius, squared
      kernel_[i] = static_cast<float>(std::exp(-16.0 * share2));
    }
    for (const Post p : posts) weights_[place_of(p)] = 1.0F;
    std::vector<float> weights = weights_;
    for (const Post p : posts) {
      double density = 0.0;
      const glm::dvec3 at = place_m({p.x, p.y, lattice.at(p.x, p.y)});
      each_post(at, p, [&](Post, const glm::dvec3&, double theta, double) { density += theta; });
      weights[place_of(p)] = static_cast<float>(1.0 / density);
    }
    weights_ = std::move(weights);
    points_ = random_points_of(posts);
  }

  [[nodiscard]] std::vector<glm::dvec3> run() {
    for (int i = 0; i < options_.iterations; ++i) iterate();
    for (glm::dvec3& p : points_) p = {p.x / options_.spacing_m.x, p.y / options_.spacing_m.y, p.z};
    return points_;
  }

 private:
  static constexpr std::size_t kernel_steps = 2048;
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

  // Kernel of a squared distance, 0 beyond its end, and one over the distance.
  struct Pull {
    double theta = 0.0;
    double inverse_m = 0.0;
  };
  [[nodiscard]] Pull pull(double distance2) const {
    const double share2 = distance2 / (radius_m_ * radius_m_);
    if (share2 >= kernel_end) return {};
    const double theta = kernel_[static_cast<std::size_t>(share2 * (kernel_steps / kernel_end))];
    return {theta, 1.0 / std::max(std::sqrt(distance2), radius_m_ / 16.0)};
  }

  template <class Visit>
  void each_post(const glm::dvec3& at, Post middle, Visit visit) const {
    const int x0 = std::max(1, middle.x - reach_x_), x1 = std::min(size - 1, middle.x + reach_x_);
    const int y0 = std::max(1, middle.y - reach_y_), y1 = std::min(size - 1, middle.y + reach_y_);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Post p{x, y};
        if (weights_[place_of(p)] == 0.0F) continue;
        const glm::dvec3 place{x * options_.spacing_m.x, y * options_.spacing_m.y, lattice_.at(x, y)};
        const glm::dvec3 d = place - at;
        const Pull found = pull(glm::dot(d, d));
        if (found.theta > 0.0) visit(p, place, found.theta, found.inverse_m);
      }
    }
  }

  // Points by bins as wide as the kernel, so that neighbours are in nine of them.
  void sort_into_bins() {
    columns_ = size / (reach_x_ + 1) + 1;
    rows_ = size / (reach_y_ + 1) + 1;
    bins_.assign(static_cast<std::size_t>(columns_ * rows_), {});
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
        if (found.theta > 0.0) visit(j, d, found.theta, found.inverse_m);
      }
    }
  }

  void iterate() {
    constexpr double repulsion = 0.45;
    sort_into_bins();
    std::vector<double> crowding(points_.size(), 1.0);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      each_point(i, [&](std::uint32_t, const glm::dvec3&, double theta, double) { crowding[i] += theta; });
    }
    std::vector<glm::dvec3> moved(points_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const glm::dvec3& at = points_[i];
      const Post middle{static_cast<int>(at.x / options_.spacing_m.x + 0.5),
                        static_cast<int>(at.y / options_.spacing_m.y + 0.5)};
      glm::dvec3 sum{0.0}, push{0.0};
      double weight = 0.0, push_weight = 0.0;
      each_post(at, middle, [&](Post p, const glm::dvec3& place, double theta, double inverse_m) {
        const double share = theta * inverse_m * weights_[place_of(p)];
        sum += share * place;
        weight += share;
      });
      each_point(i, [&](std::uint32_t j, const glm::dvec3& d, double theta, double inverse_m) {
        const double share = crowding[j] * theta * inverse_m;
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
  int reach_x_ = 1;
  int reach_y_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::array<float, kernel_steps + 1> kernel_{};
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
