// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998, "Fast and memory efficient polygonal simplification" (cost and place from the
// triangles as they are, volume kept), with the constraints of Campos et al. 2020, section 4.2, in coordinates scaled
// to the unit cube (section 4.4.1). Differs: begins with a greedy TIN finer than asked instead of all posts; the border
// is a chain that never changes, so that the boundary term is 0; may stop by error, which is measured at every post
// that a collapse touches. A triangle that is not counter-clockwise from above is refused, so there are no vertical
// walls, and no edge between vertices that have one already. Edges wait in the order of the least cost that a place on
// the edge has, in buckets an eighth of a power of two wide; those that cannot keep the tolerance are left out. Sums
// over a vertex's triangles are kept as seen from the vertex, where their linear parts vanish.
#include "terrain/edge_collapse.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "collapse/symmetric3.h"
#include "terrain/error.h"

namespace lodestone::terrain {
namespace {

using Vertex = Tin::Vertex;

constexpr std::uint32_t next_of(std::uint32_t edge) { return edge % 3 == 2 ? edge - 2 : edge + 1; }
constexpr std::uint32_t prev_of(std::uint32_t edge) { return edge % 3 == 0 ? edge + 2 : edge - 1; }

// Over the triangles around a vertex, as seen from it: sums of n n' and of n, where n is a triangle's normal (twice its
// area long). n'x is six times the volume between the triangle and x.
struct Fan {
  collapse::Symmetric3 nn;
  glm::dvec3 n{0.0};

  void add(const glm::dvec3& normal, double times = 1.0) {
    nn.add_plane(normal, times);
    n += times * normal;
  }
};

// Sums over triangles of n n', n d, d d, n and d, where d is a triangle's distance from the origin along n.
struct Volumes {
  collapse::Symmetric3 nn;
  glm::dvec3 nd{0.0}, n{0.0};
  double dd = 0, d = 0;

  // The triangles of two fans, each once, from half way between them; `along` leads from there to the first. Those that
  // both have pass through the origin.
  Volumes(const Fan& first, const Fan& second, const glm::dvec3& along, const std::array<glm::dvec3, 2>& common)
      : nn{first.nn + second.nn}, n{first.n + second.n} {
    const glm::dvec3 near = first.nn * along, far = second.nn * along;
    nd = near - far;
    dd = glm::dot(along, near + far);
    d = glm::dot(along, first.n - second.n);
    for (const glm::dvec3& normal : common) {
      nn.add_plane(normal, -1.0);
      n -= normal;
    }
  }
  // Sum of squares at x.
  [[nodiscard]] double at(const glm::dvec3& x) const { return nn.form(x) - 2.0 * glm::dot(nd, x) + dd; }

  // The x with the least sum of squares among those where volumes above and below are equal; each is also drawn to the
  // origin by `pull` of its squared distance.
  [[nodiscard]] std::optional<glm::dvec3> least(double weight, double pull) const {
    collapse::Symmetric3 pulled{weight * nn.xx, weight * nn.xy, weight * nn.xz,
                                weight * nn.yy, weight * nn.yz, weight * nn.zz};
    pulled.add_isotropic(pull);
    const collapse::Solver3 solve{pulled};
    if (!solve.valid()) return std::nullopt;
    const glm::dvec3 free = solve(weight * nd), along = solve(n);
    const double gain = glm::dot(n, along);
    if (!(gain > 0.0)) return std::nullopt;
    return free - (glm::dot(n, free) - d) / gain * along;
  }
};

// Edges by cost: those of a bucket are within an eighth of each other, and the last to come goes first.
class CostQueue {
 public:
  struct Candidate {
    std::uint32_t a = 0, b = 0;
    std::uint32_t version_a = 0, version_b = 0;
  };
  void push(double cost, const Candidate& candidate) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(static_cast<float>(cost));
    const std::size_t at = bits >> 20U;
    buckets_[at].push_back(candidate);
    lowest_ = std::min(lowest_, at);
  }
  [[nodiscard]] bool pop(Candidate& candidate) {
    while (lowest_ < buckets_.size() && buckets_[lowest_].empty()) ++lowest_;
    if (lowest_ == buckets_.size()) return false;
    candidate = buckets_[lowest_].back();
    buckets_[lowest_].pop_back();
    return true;
  }

 private:
  std::vector<std::vector<Candidate>> buckets_{std::size_t{1} << 11U};
  std::size_t lowest_ = std::size_t{1} << 11U;
};

// The same TIN with its triangles in strips from west to east, eight posts high, and its vertices in the order of their
// use: what a collapse touches then lies close together in memory. That is worth a quarter of the time.
Tin in_strips(const Tin& tin) {
  constexpr int strip = 1024;
  std::vector<std::uint64_t> order(tin.triangles.size() / 3);
  for (std::size_t t = 0; t < order.size(); ++t) {
    const Vertex& corner = tin.vertices[tin.triangles[3 * t]];
    const auto key = static_cast<std::uint64_t>(corner.v / strip << 16 | corner.u);
    order[t] = key << 32U | t;
  }
  std::sort(order.begin(), order.end());
  Tin sorted;
  sorted.vertices.reserve(tin.vertices.size());
  sorted.triangles.reserve(tin.triangles.size());
  std::vector<std::uint32_t> name(tin.vertices.size(), none);
  for (const std::uint64_t key : order) {
    const std::size_t first = 3 * (key & 0xffffffffU);
    for (std::size_t k = first; k < first + 3; ++k) {
      std::uint32_t& id = name[tin.triangles[k]];
      if (id == none) {
        id = static_cast<std::uint32_t>(sorted.vertices.size());
        sorted.vertices.push_back(tin.vertices[tin.triangles[k]]);
      }
      sorted.triangles.push_back(id);
    }
  }
  return sorted;
}

class TinCollapse {
 public:
  TinCollapse(const Tin& tin, const TileLattice& lattice, const CollapseOptions& options)
      : lattice_{lattice}, options_{options}, vertices_{tin.vertices}, corners_{tin.triangles} {
    double low_m = vertices_.front().height_m, high_m = low_m;
    for (const Vertex& v : vertices_) {
      low_m = std::min(low_m, v.height_m);
      high_m = std::max(high_m, v.height_m);
    }
    base_m_ = low_m;
    range_m_ = std::max(high_m - low_m, options.step_m);
    inverse_range_ = 1.0 / range_m_;
    if (options.target_edges == 0) {
      const double most_off = hopeless * options.limit_m * inverse_range_;
      most_off2_ = most_off * most_off;
    }
    versions_.assign(vertices_.size(), 0);
    fixed_.assign(vertices_.size(), 0);
    edge_of_.assign(vertices_.size(), none);
    link_twins();
    fix_posts();
    sums_.resize(vertices_.size());
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      if (fixed_[v] == 0) sum_up(v);
    }
  }

  // What was refused may fit once its surroundings have changed: in another pass. By error that would be up to a
  // tenth fewer triangles for half as much time again.
  [[nodiscard]] Tin run() {
    const int most_passes = options_.target_edges == 0 ? 1 : 4;
    constexpr std::size_t worth_a_pass = 100;  // one more if one edge in so many went
    for (int pass = 0; pass < most_passes; ++pass) {
      const std::size_t before = edge_count_;
      for (std::uint32_t e = 0; e < corners_.size(); ++e) {
        if (corners_[e] != none && twins_[e] != none && corners_[e] < corners_[next_of(e)]) push(e);
      }
      CostQueue::Candidate top;
      while (!reached() && queue_.pop(top)) {
        if (versions_[top.a] == top.version_a && versions_[top.b] == top.version_b) try_collapse(top.a, top.b);
      }
      if (reached() || before - edge_count_ < before / worth_a_pass) break;
    }
    return result();
  }

 private:
  // Collapses that move the ground by so many times the limit on average are not tried: one in fifty would fit.
  static constexpr double hopeless = 2.5;

  [[nodiscard]] bool reached() const { return options_.target_edges != 0 && edge_count_ <= options_.target_edges; }
  [[nodiscard]] glm::dvec3 scaled(const Vertex& v) const {
    constexpr double unit = 1.0 / quantized_max;
    return {v.u * unit, v.v * unit, (v.height_m - base_m_) * inverse_range_};
  }

  // Everything on an edge of one triangle stays: borders, rims of voids.
  void link_twins() {
    twins_.assign(corners_.size(), none);
    std::vector<std::uint32_t> next(corners_.size(), none);  // of the half edges that begin at a vertex
    for (std::uint32_t e = 0; e < corners_.size(); ++e) {
      next[e] = edge_of_[corners_[e]];
      edge_of_[corners_[e]] = e;
    }
    std::size_t open = 0;
    for (std::uint32_t e = 0; e < corners_.size(); ++e) {
      for (std::uint32_t other = edge_of_[corners_[next_of(e)]]; other != none; other = next[other]) {
        if (corners_[next_of(other)] == corners_[e]) twins_[e] = other;
      }
      if (twins_[e] != none) continue;
      fixed_[corners_[e]] = fixed_[corners_[next_of(e)]] = 1;
      ++open;
    }
    edge_count_ = (corners_.size() + open) / 2;
  }

  void fix_posts() {
    std::vector<std::uint8_t> given(std::size_t{size + 1} * (size + 1));
    const auto place_of = [](int x, int y) { return static_cast<std::size_t>(y * (size + 1) + x); };
    for (const Post p : options_.fixed) given[place_of(p.x, p.y)] = 1;
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      if (given[place_of(nearest_post(vertices_[v].u), nearest_post(vertices_[v].v))] != 0) fixed_[v] = 1;
    }
  }

  // Calls visit(half edge) for those that begin at a vertex with triangles all around, counter-clockwise.
  template <class Visit>
  void around(std::uint32_t v, Visit visit) const {
    const std::uint32_t first = edge_of_[v];
    std::uint32_t e = first;
    do {
      visit(e);
      e = twins_[prev_of(e)];
    } while (e != first);
  }

  void sum_up(std::uint32_t v) {
    Fan sum;
    const glm::dvec3 middle = scaled(vertices_[v]);
    glm::dvec3 last = scaled(vertices_[corners_[next_of(edge_of_[v])]]) - middle;
    around(v, [&](std::uint32_t e) {
      const glm::dvec3 next = scaled(vertices_[corners_[prev_of(e)]]) - middle;
      sum.add(glm::cross(last, next));
      last = next;
    });
    sums_[v] = sum;
  }

  struct Placed {
    glm::dvec3 place{0.0};  // scaled
    double off2 = 0.0;      // how far old triangles are from it, upwards, squared: the mean by squared area
  };
  // Where the squared volumes between old and new triangles are least, their sum being 0.
  [[nodiscard]] Placed place(std::uint32_t edge) const {
    const std::uint32_t a = corners_[edge], b = corners_[next_of(edge)];
    const glm::dvec3 pa = scaled(vertices_[a]), pb = scaled(vertices_[b]), along = 0.5 * (pa - pb);
    const auto across = [&](std::uint32_t e) {
      return glm::cross(2.0 * along, scaled(vertices_[corners_[prev_of(e)]]) - pb);
    };
    const Volumes volumes{sums_[a], sums_[b], along, {-across(edge), across(twins_[edge])}};
    // The shape term draws towards the middle of the edge, which is the origin here.
    const double pull = options_.shape_weight + 1e-11 * volumes.nn.trace();
    const auto best = volumes.least(options_.volume_weight, pull);
    constexpr double farthest = 4.0;  // half edges
    glm::dvec3 at{0.0};
    if (best && glm::length(glm::dvec2{*best}) <= farthest * glm::length(glm::dvec2{along})) at = *best;
    return {at + 0.5 * (pa + pb), volumes.at(at) / volumes.nn.zz};
  }

  // In the order of the least cost on the edge itself, which takes a tenth of the time of finding the best place beside
  // it; that is looked for when the edge's turn comes. As few triangles are left.
  void push(std::uint32_t edge) {
    const std::uint32_t a = corners_[edge], b = corners_[next_of(edge)];
    if (fixed_[a] != 0 && fixed_[b] != 0) return;
    const glm::dvec3 along = scaled(vertices_[b]) - scaled(vertices_[a]);
    double sum = 0.0, level = 0.0;
    if (fixed_[a] != 0 || fixed_[b] != 0) {
      const Fan& fan = sums_[fixed_[a] != 0 ? b : a];
      sum = fan.nn.form(along);
      level = fan.nn.zz;
    } else {
      // Where on the edge the sum is least: one end's triangles count by its squared distance, the other's likewise.
      const double to_b = sums_[a].nn.form(along), to_a = sums_[b].nn.form(along);
      if (to_a + to_b > 0.0) sum = to_a * to_b / (to_a + to_b);
      level = sums_[a].nn.zz + sums_[b].nn.zz;
    }
    sum = std::max(0.0, sum);
    if (sum > most_off2_ * level) return;
    const double cost = options_.volume_weight * sum + 0.25 * options_.shape_weight * glm::dot(along, along);
    queue_.push(cost, {a, b, versions_[a], versions_[b]});
  }

  [[nodiscard]] Vertex rounded(const glm::dvec3& at) const {
    const auto whole = [](double x) {
      return static_cast<int>(std::clamp(std::floor(x * quantized_max + 0.5), 1.0, quantized_max - 1.0));
    };
    return {whole(at.x), whole(at.y), snapped_m(base_m_ + at.z * range_m_, options_.step_m)};
  }

  // The triangles that move, with the vertex at `at`, are sound and near enough to all their posts.
  [[nodiscard]] bool fits(const Vertex& at) const {
    for (const std::uint32_t e : moving_) {
      if (area_of(at, vertices_[corners_[next_of(e)]], vertices_[corners_[prev_of(e)]]) <= 0) return false;
    }
    if (options_.target_edges > 0) return true;
    if (!near_posts(at)) return false;
    return std::all_of(moving_.begin(), moving_.end(), [&](std::uint32_t e) {
      return within(at, vertices_[corners_[next_of(e)]], vertices_[corners_[prev_of(e)]], lattice_, options_.limit_m);
    });
  }

  // A vertex between posts is no farther from the surface through the four around it than a post may be from the TIN.
  [[nodiscard]] bool near_posts(const Vertex& at) const {
    constexpr double posts_per_unit = static_cast<double>(size) / quantized_max;
    const int x = cell_of(at.u), y = cell_of(at.v);
    const double east = at.u * posts_per_unit - x, north = at.v * posts_per_unit - y;
    const auto row_m = [&](int row) {
      return std::lerp(static_cast<double>(lattice_.at(x, row)), static_cast<double>(lattice_.at(x + 1, row)), east);
    };
    return std::fabs(at.height_m - std::lerp(row_m(y), row_m(y + 1), north)) <= options_.limit_m;
  }

  // Half edges that begin at a free vertex, but those of the two triangles at the edge to the other.
  void gather(std::uint32_t v, std::uint32_t other) {
    around(v, [&](std::uint32_t e) {
      if (corners_[next_of(e)] != other && corners_[prev_of(e)] != other) moving_.push_back(e);
    });
  }

  void try_collapse(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t goes = fixed_[b] != 0 ? a : b, stays = goes == a ? b : a;
    std::uint32_t edge = none;
    around(goes, [&](std::uint32_t e) {
      if (corners_[next_of(e)] == stays) edge = e;
    });
    moving_.clear();
    gather(goes, stays);
    if (fixed_[stays] == 0) gather(stays, goes);
    if (const auto at = choose(edge, stays)) apply(edge, *at);
  }

  [[nodiscard]] std::optional<Vertex> choose(std::uint32_t edge, std::uint32_t stays) const {
    if (fixed_[stays] != 0) return fits(vertices_[stays]) ? std::optional{vertices_[stays]} : std::nullopt;
    const Placed placed = place(edge);
    if (placed.off2 > most_off2_) return std::nullopt;
    const Vertex best = rounded(placed.place);
    return fits(best) ? std::optional{best} : std::nullopt;
  }

  // `edge` begins at the vertex that goes.
  void apply(std::uint32_t edge, const Vertex& at) {
    const std::uint32_t goes = corners_[edge], stays = corners_[next_of(edge)], twin = twins_[edge];
    for (const std::uint32_t e : moving_) corners_[e] = stays;
    for (const std::uint32_t e : {edge, twin}) {
      const std::uint32_t left = twins_[next_of(e)], right = twins_[prev_of(e)];
      if (left != none) twins_[left] = right;
      if (right != none) twins_[right] = left;
      // Both lie in triangles that stay, or the vertex across is fixed and its edge is not asked for.
      const std::uint32_t across = corners_[prev_of(e)];  // where `left` begins
      if (left != none) edge_of_[across] = left;
    }
    for (const std::uint32_t f : {edge / 3, twin / 3}) {
      for (std::uint32_t k = 0; k < 3; ++k) corners_[3 * f + k] = none;
    }
    vertices_[stays] = at;
    ++versions_[stays];
    ++versions_[goes];
    edge_count_ -= 3;
    edge_of_[stays] = moving_.front();
    if (fixed_[stays] == 0) sum_up(stays);
    for (const std::uint32_t e : moving_) {
      if (fixed_[corners_[next_of(e)]] == 0) sum_up(corners_[next_of(e)]);
      if (fixed_[corners_[prev_of(e)]] == 0 && fixed_[stays] != 0) sum_up(corners_[prev_of(e)]);
    }
    for (const std::uint32_t e : moving_) {
      if (twins_[e] != none) push(e);
      if (fixed_[stays] != 0 && twins_[prev_of(e)] != none) push(prev_of(e));
    }
  }

  [[nodiscard]] Tin result() const {
    Tin tin;
    std::vector<std::uint32_t> name(vertices_.size(), none);
    for (const std::uint32_t v : corners_) {
      if (v == none) continue;
      if (name[v] == none) {
        name[v] = static_cast<std::uint32_t>(tin.vertices.size());
        tin.vertices.push_back(vertices_[v]);
      }
      tin.triangles.push_back(name[v]);
    }
    return tin;
  }

  const TileLattice& lattice_;
  const CollapseOptions& options_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> corners_;  // 3 per face; `none` where a face is gone
  std::vector<std::uint32_t> twins_;    // per half edge; `none`: it has one triangle
  std::vector<std::uint32_t> edge_of_;  // per free vertex, a half edge that begins there
  std::vector<std::uint32_t> versions_;
  std::vector<std::uint8_t> fixed_;
  std::vector<Fan> sums_;  // per free vertex, scaled
  std::vector<std::uint32_t> moving_;
  CostQueue queue_;
  std::size_t edge_count_ = 0;
  double base_m_ = 0.0;
  double range_m_ = 1.0;
  double inverse_range_ = 1.0;
  double most_off2_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Tin collapse_edges(const Tin& tin, const TileLattice& lattice, const CollapseOptions& options) {
  return TinCollapse{in_strips(tin), lattice, options}.run();
}

}  // namespace lodestone::terrain
