// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998, "Fast and memory efficient polygonal simplification" (cost and place from the
// triangles as they are, volume kept), with the constraints of Campos et al. 2020, section 4.2, in coordinates scaled
// to the unit cube (section 4.4.1). Differs: begins with a greedy TIN finer than asked instead of all posts; the border
// is a chain that never changes, so that the boundary term is 0; may stop by error, which is measured at every post
// that a collapse touches. A triangle that is not counter-clockwise from above is refused, so there are no vertical
// walls.
#include "terrain/edge_collapse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <queue>

#include "terrain/error.h"

namespace lodestone::terrain {
namespace {

using Vertex = Tin::Vertex;

// Minimises x'Ax/2 - b'x subject to n'x = d: five numbers by elimination with pivots; false if it is singular.
bool solve(std::array<std::array<double, 5>, 4>& m) {
  for (std::size_t k = 0; k < 4; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 4; ++i) {
      if (std::fabs(m[i][k]) > std::fabs(m[pivot][k])) pivot = i;
    }
    if (std::fabs(m[pivot][k]) < 1e-30) return false;
    std::swap(m[k], m[pivot]);
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == k) continue;
      const double factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j < 5; ++j) m[i][j] -= factor * m[k][j];
    }
  }
  for (std::size_t k = 0; k < 4; ++k) m[k][4] /= m[k][k];
  return true;
}

class TinCollapse {
 public:
  TinCollapse(const Tin& tin, const TileLattice& lattice, const CollapseOptions& options)
      : lattice_{lattice}, options_{options}, vertices_{tin.vertices}, corners_{tin.triangles} {
    faces_of_.resize(vertices_.size());
    versions_.assign(vertices_.size(), 0);
    fixed_.assign(vertices_.size(), 0);
    for (std::uint32_t f = 0; f < corners_.size() / 3; ++f) {
      for (std::uint32_t k = 0; k < 3; ++k) faces_of_[corners_[3 * f + k]].push_back(f);
    }
    double low_m = vertices_.front().height_m, high_m = low_m;
    for (const Vertex& v : vertices_) {
      low_m = std::min(low_m, v.height_m);
      high_m = std::max(high_m, v.height_m);
    }
    base_m_ = low_m;
    range_m_ = std::max(high_m - low_m, options.step_m);
    fix_vertices();
  }

  // What was refused may fit once its surroundings have changed: in another pass.
  [[nodiscard]] Tin run() {
    constexpr int most_passes = 2;
    constexpr std::size_t worth_a_pass = 100;  // one more if one edge in so many went
    for (int pass = 0; pass < most_passes; ++pass) {
      const std::size_t before = edge_count_;
      for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
        for (const std::uint32_t n : neighbours(v)) {
          if (v < n) push(v, n);
        }
      }
      while (!queue_.empty() && !reached()) {
        const Candidate candidate = queue_.top();
        queue_.pop();
        if (candidate.version == version(candidate.a, candidate.b)) try_collapse(candidate.a, candidate.b);
      }
      if (reached() || before - edge_count_ < before / worth_a_pass) break;
    }
    return result();
  }

 private:
  struct Candidate {
    double cost = 0.0;
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint64_t version = 0;
    friend bool operator<(const Candidate& x, const Candidate& y) noexcept {  // the cheapest is on top
      if (x.cost != y.cost) return x.cost > y.cost;
      return x.a != y.a ? x.a > y.a : x.b > y.b;
    }
  };

  [[nodiscard]] bool reached() const { return options_.target_edges != 0 && edge_count_ <= options_.target_edges; }
  [[nodiscard]] std::uint64_t version(std::uint32_t a, std::uint32_t b) const {
    return std::uint64_t{versions_[a]} << 32U | versions_[b];
  }
  [[nodiscard]] glm::dvec3 scaled(const Vertex& v) const {
    return {static_cast<double>(v.u) / quantized_max, static_cast<double>(v.v) / quantized_max,
            (v.height_m - base_m_) / range_m_};
  }

  // Everything on an edge of one triangle stays (borders, rims of voids), and the given posts.
  void fix_vertices() {
    std::size_t open = 0;
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      for (const std::uint32_t n : neighbours(v)) {
        const auto shared =
            std::count_if(faces_of_[v].begin(), faces_of_[v].end(), [&](std::uint32_t f) { return has(f, n); });
        if (shared != 1) continue;
        fixed_[v] = 1;
        ++open;  // met from both ends
      }
    }
    edge_count_ = (corners_.size() + open / 2) / 2;
    std::vector<std::uint8_t> given(std::size_t{size + 1} * (size + 1));
    for (const Post p : options_.fixed) given[static_cast<std::size_t>(p.y * (size + 1) + p.x)] = 1;
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      const int x = (vertices_[v].u + 64) / 128, y = (vertices_[v].v + 64) / 128;
      if (given[static_cast<std::size_t>(y * (size + 1) + x)] != 0) fixed_[v] = 1;
    }
  }

  [[nodiscard]] bool has(std::uint32_t face, std::uint32_t vertex) const {
    return corners_[3 * face] == vertex || corners_[3 * face + 1] == vertex || corners_[3 * face + 2] == vertex;
  }
  [[nodiscard]] std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t f : faces_of_[v]) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (corners_[3 * f + k] != v) found.push_back(corners_[3 * f + k]);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  // Faces at either end, each once, those at both last.
  struct Star {
    std::vector<std::uint32_t> faces;
    std::vector<std::uint32_t> vanishing;
  };
  [[nodiscard]] Star star_of(std::uint32_t a, std::uint32_t b) const {
    Star star;
    for (const std::uint32_t f : faces_of_[a]) (has(f, b) ? star.vanishing : star.faces).push_back(f);
    for (const std::uint32_t f : faces_of_[b]) {
      if (!has(f, a)) star.faces.push_back(f);
    }
    return star;
  }

  struct Placed {
    glm::dvec3 place{0.0};  // scaled
    double cost = 0.0;
  };
  // Where the squared volumes between old and new triangles are least, their sum being 0; or at the end that stays.
  [[nodiscard]] Placed place(std::uint32_t a, std::uint32_t b) const {
    const glm::dvec3 pa = scaled(vertices_[a]), pb = scaled(vertices_[b]), middle = 0.5 * (pa + pb);
    const Star star = star_of(a, b);
    glm::dmat3 volume{0.0};
    glm::dvec3 linear{0.0}, normals{0.0};
    double constant = 0.0, sum = 0.0;
    const auto add = [&](std::uint32_t f) {
      const glm::dvec3 p = scaled(vertices_[corners_[3 * f]]) - middle,
                       q = scaled(vertices_[corners_[3 * f + 1]]) - middle,
                       r = scaled(vertices_[corners_[3 * f + 2]]) - middle;
      const glm::dvec3 n = glm::cross(q - p, r - p);
      const double d = glm::dot(n, p);
      volume += glm::outerProduct(n, n);
      linear += n * d;
      constant += d * d;
      normals += n;
      sum += d;
    };
    for (const std::uint32_t f : star.faces) add(f);
    for (const std::uint32_t f : star.vanishing) add(f);
    glm::dvec3 at{0.0};
    if (fixed_[a] != 0 || fixed_[b] != 0) {
      at = (fixed_[a] != 0 ? pa : pb) - middle;
    } else {
      // The shape term draws towards the middle of the edge, which is the origin here.
      const double pull = options_.shape_weight + 1e-12 * (volume[0][0] + volume[1][1] + volume[2][2]);
      std::array<std::array<double, 5>, 4> m{};
      for (int i = 0; i < 3; ++i) {
        const auto row = static_cast<std::size_t>(i);
        for (int j = 0; j < 3; ++j)
          m[row][static_cast<std::size_t>(j)] = options_.volume_weight * volume[j][i] + (i == j ? pull : 0.0);
        m[row][3] = m[3][row] = normals[i];
        m[row][4] = options_.volume_weight * linear[i];
      }
      m[3][4] = sum;
      if (solve(m)) at = {m[0][4], m[1][4], m[2][4]};
      const double reach = glm::length(glm::dvec2{pb - pa});
      if (!(glm::length(glm::dvec2{at}) <= 2.0 * reach)) at = glm::dvec3{0.0};
    }
    const double cost = options_.volume_weight * (glm::dot(at, volume * at) - 2.0 * glm::dot(linear, at) + constant) +
                        options_.shape_weight * glm::dot(at, at);
    return {at + middle, std::max(cost, 0.0)};
  }

  void push(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    if (fixed_[a] != 0 && fixed_[b] != 0) return;
    queue_.push({place(a, b).cost, a, b, version(a, b)});
  }

  [[nodiscard]] Vertex rounded(const glm::dvec3& at) const {
    const auto whole = [](double x) {
      return static_cast<int>(std::clamp(std::floor(x * quantized_max + 0.5), 1.0, quantized_max - 1.0));
    };
    return {whole(at.x), whole(at.y), snapped_m(base_m_ + at.z * range_m_, options_.step_m)};
  }

  // The triangles that stay, with the vertex at `at`, are sound and near enough to all their posts.
  [[nodiscard]] bool fits(const Star& star, std::uint32_t a, std::uint32_t b, const Vertex& at) const {
    const auto corner = [&](std::uint32_t f, std::uint32_t k) -> const Vertex& {
      const std::uint32_t v = corners_[3 * f + k];
      return v == a || v == b ? at : vertices_[v];
    };
    for (const std::uint32_t f : star.faces) {
      if (area_of(corner(f, 0), corner(f, 1), corner(f, 2)) <= 0) return false;
    }
    if (options_.target_edges > 0) return true;
    bool near = true;
    for (const std::uint32_t f : star.faces) {
      for_each_post(corner(f, 0), corner(f, 1), corner(f, 2), [&](int x, int y, double height_m) {
        near = near && std::fabs(height_m - static_cast<double>(lattice_.at(x, y))) <= options_.limit_m;
      });
      if (!near) return false;
    }
    return true;
  }

  void try_collapse(std::uint32_t a, std::uint32_t b) {
    const Star star = star_of(a, b);
    if (star.vanishing.size() != 2) return;
    const std::vector<std::uint32_t> around_a = neighbours(a), around_b = neighbours(b);
    std::vector<std::uint32_t> common;
    std::set_intersection(around_a.begin(), around_a.end(), around_b.begin(), around_b.end(),
                          std::back_inserter(common));
    if (common.size() != 2) return;
    if (const auto at = choose(star, a, b)) apply(star, a, b, *at);
  }

  [[nodiscard]] std::optional<Vertex> choose(const Star& star, std::uint32_t a, std::uint32_t b) const {
    if (fixed_[a] != 0 || fixed_[b] != 0) {
      const Vertex& stays = vertices_[fixed_[a] != 0 ? a : b];
      return fits(star, a, b, stays) ? std::optional{stays} : std::nullopt;
    }
    const Vertex best = rounded(place(a, b).place);
    if (fits(star, a, b, best)) return best;
    for (const std::uint32_t end : {a, b}) {
      if (fits(star, a, b, vertices_[end])) return vertices_[end];
    }
    return std::nullopt;
  }

  void apply(const Star& star, std::uint32_t a, std::uint32_t b, const Vertex& at) {
    const std::uint32_t stays = fixed_[b] != 0 ? b : a, goes = stays == a ? b : a;
    for (const std::uint32_t f : star.vanishing) {
      for (std::uint32_t k = 0; k < 3; ++k) std::erase(faces_of_[corners_[3 * f + k]], f);
      corners_[3 * f] = corners_[3 * f + 1] = corners_[3 * f + 2] = none;
    }
    for (const std::uint32_t f : faces_of_[goes]) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (corners_[3 * f + k] == goes) corners_[3 * f + k] = stays;
      }
      faces_of_[stays].push_back(f);
    }
    faces_of_[goes].clear();
    vertices_[stays] = at;
    ++versions_[stays];
    ++versions_[goes];
    edge_count_ -= 3;
    for (const std::uint32_t n : neighbours(stays)) push(stays, n);
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
  std::vector<std::vector<std::uint32_t>> faces_of_;
  std::vector<std::uint32_t> versions_;
  std::vector<std::uint8_t> fixed_;
  std::priority_queue<Candidate> queue_;
  std::size_t edge_count_ = 0;
  double base_m_ = 0.0;
  double range_m_ = 1.0;
};

}  // namespace

Tin collapse_edges(const Tin& tin, const TileLattice& lattice, const CollapseOptions& options) {
  return TinCollapse{tin, lattice, options}.run();
}

}  // namespace lodestone::terrain
