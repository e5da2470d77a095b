// SPDX-License-Identifier: MIT
// Based on: Campos et al. 2020, section 4.3.1 (sharp edges as polylines, distance in space), and Dyken, Daehlen and
// Sevaldrud 2009, "Simultaneous curve simplification" (vertices go one by one while the topology stays).
// Differs: no triangulation is asked whether a vertex may go: its two segments and the one that replaces them may not
// enclose a vertex of any line, which is the same to all lines that did not cross before.
#include "terrain/feature_lines.h"

#include <algorithm>
#include <queue>

#include "geometry/distance.h"

namespace lodestone::terrain {
namespace {

constexpr std::array<Post, 6> steps{Post{1, 0}, Post{1, 1}, Post{0, 1}, Post{-1, 0}, Post{-1, -1}, Post{0, -1}};

std::size_t place_of(Post p) { return static_cast<std::size_t>(p.y) * (size + 1) + static_cast<std::size_t>(p.x); }
Post plus(Post p, std::size_t step) { return {p.x + steps[step].x, p.y + steps[step].y}; }
bool inside(Post p) { return p.x > 0 && p.x < size && p.y > 0 && p.y < size; }

class SharpEdges {
 public:
  SharpEdges(const TileLattice& lattice, double angle_rad)
      : lattice_{lattice}, cosine_{std::cos(angle_rad)}, steps_at_(std::size_t{size + 1} * (size + 1)) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (int y = 0; y <= size; ++y) {
      for (int x = 0; x <= size; ++x) {
        if (lattice.at(x, y) < low) low = lattice.at(x, y);
        if (lattice.at(x, y) > high) high = lattice.at(x, y);
      }
    }
    scale_ = high > low ? size / (static_cast<double>(high) - low) : 0.0;
    find();
  }

  [[nodiscard]] std::vector<FeatureLine> lines(std::uint32_t least_edges) {
    std::vector<FeatureLine> found;
    const auto trace_from = [&](bool rings) {
      for (int y = 1; y < size; ++y) {
        for (int x = 1; x < size; ++x) {
          const Post p{x, y};
          if (!rings && meeting_[place_of(p)] == 2) continue;
          for (std::size_t step = 0; step < steps.size(); ++step) {
            if (!has(p, step)) continue;
            FeatureLine line = trace(p, step);
            if (line.size() > least_edges) found.push_back(std::move(line));
          }
        }
      }
    };
    for (const std::uint8_t bits : steps_at_) meeting_.push_back(static_cast<std::uint8_t>(__builtin_popcount(bits)));
    trace_from(false);
    trace_from(true);
    return found;
  }

 private:
  // Slope of the lower (south-eastern) or upper triangle of a cell, scaled; not a number without data.
  [[nodiscard]] glm::dvec2 lower(int x, int y) const {
    return scale_ *
           glm::dvec2{lattice_.at(x + 1, y) - lattice_.at(x, y), lattice_.at(x + 1, y + 1) - lattice_.at(x + 1, y)};
  }
  [[nodiscard]] glm::dvec2 upper(int x, int y) const {
    return scale_ *
           glm::dvec2{lattice_.at(x + 1, y + 1) - lattice_.at(x, y + 1), lattice_.at(x, y + 1) - lattice_.at(x, y)};
  }
  [[nodiscard]] bool sharp(const glm::dvec2& a, const glm::dvec2& b) const {
    return 1.0 + glm::dot(a, b) < cosine_ * std::sqrt((1.0 + glm::dot(a, a)) * (1.0 + glm::dot(b, b)));
  }

  void find() {
    for (int y = 1; y < size; ++y) {
      for (int x = 1; x < size; ++x) {
        if (sharp(lower(x, y), upper(x, y - 1))) mark({x, y}, 0);
        if (sharp(lower(x, y), upper(x, y))) mark({x, y}, 1);
        if (sharp(upper(x, y), lower(x - 1, y))) mark({x, y}, 2);
      }
    }
  }
  void mark(Post p, std::size_t step) {
    const Post q = plus(p, step);
    if (!inside(q)) return;
    steps_at_[place_of(p)] = static_cast<std::uint8_t>(steps_at_[place_of(p)] | 1U << step);
    steps_at_[place_of(q)] = static_cast<std::uint8_t>(steps_at_[place_of(q)] | 1U << (step + 3));
  }
  [[nodiscard]] bool has(Post p, std::size_t step) const { return (steps_at_[place_of(p)] >> step & 1U) != 0; }

  // Takes the edges of the line that it returns.
  [[nodiscard]] FeatureLine trace(Post p, std::size_t step) {
    FeatureLine line{p};
    while (true) {
      const Post q = plus(p, step);
      steps_at_[place_of(p)] = static_cast<std::uint8_t>(steps_at_[place_of(p)] & ~(1U << step));
      steps_at_[place_of(q)] = static_cast<std::uint8_t>(steps_at_[place_of(q)] & ~(1U << (step + 3) % 6));
      line.push_back(q);
      if (meeting_[place_of(q)] != 2 || steps_at_[place_of(q)] == 0) return line;
      p = q;
      for (step = 0; !has(p, step);) ++step;
    }
  }

  const TileLattice& lattice_;
  double cosine_;
  double scale_ = 0.0;
  std::vector<std::uint8_t> steps_at_;  // per post, a bit for each way that a sharp edge leaves it
  std::vector<std::uint8_t> meeting_;   // per post: how many did at first
};

class LineSimplifier {
 public:
  LineSimplifier(std::vector<FeatureLine>& lines, const TileLattice& lattice, const glm::dvec2& spacing_m)
      : lines_{lines}, lattice_{lattice}, spacing_m_{spacing_m}, taken_(std::size_t{size + 1} * (size + 1)) {}

  void run(std::span<const Post> others, double tolerance_m) {
    for (const Post p : others) taken_[place_of(p)] = other;
    for (const FeatureLine& line : lines_) {
      for (const Post p : line) taken_[place_of(p)] |= of_line;
      auto& links = links_.emplace_back(line.size());
      for (std::uint32_t i = 0; i < line.size(); ++i) links[i] = {i - 1, i + 1, 0};
    }
    for (std::uint32_t k = 0; k < lines_.size(); ++k) {
      for (std::uint32_t i = 1; i + 1 < lines_[k].size(); ++i) push(k, i);
    }
    while (!queue_.empty() && queue_.top().error_m <= tolerance_m) {
      const Candidate top = queue_.top();
      queue_.pop();
      if (links_[top.line][top.at].version == top.version && may_go(top)) remove(top);
    }
    for (std::uint32_t k = 0; k < lines_.size(); ++k) {
      FeatureLine left;
      for (std::uint32_t i = 0; i < lines_[k].size(); i = links_[k][i].next) left.push_back(lines_[k][i]);
      lines_[k] = std::move(left);
    }
  }

 private:
  struct Link {
    std::uint32_t previous = 0;
    std::uint32_t next = 0;
    std::uint32_t version = 0;
  };
  struct Candidate {
    double error_m = 0.0;
    std::uint32_t line = 0;
    std::uint32_t at = 0;
    std::uint32_t version = 0;
    friend bool operator<(const Candidate& a, const Candidate& b) noexcept {  // the smallest error is on top
      if (a.error_m != b.error_m) return a.error_m > b.error_m;
      return a.line != b.line ? a.line > b.line : a.at > b.at;
    }
  };

  [[nodiscard]] glm::dvec3 place_m(Post p) const {
    return {p.x * spacing_m_.x, p.y * spacing_m_.y, lattice_.at(p.x, p.y)};
  }

  // How far the posts between its neighbours would be off the segment between these.
  void push(std::uint32_t line, std::uint32_t at) {
    const Link& link = links_[line][at];
    const glm::dvec3 a = place_m(lines_[line][link.previous]), b = place_m(lines_[line][link.next]);
    double most2 = 0.0;
    for (std::uint32_t i = link.previous + 1; i < link.next; ++i) {
      most2 = std::max(most2, squared_distance_to_segment(place_m(lines_[line][i]), a, b));
    }
    queue_.push({std::sqrt(most2), line, at, link.version});
  }

  [[nodiscard]] bool may_go(const Candidate& candidate) const {
    const Link& link = links_[candidate.line][candidate.at];
    const FeatureLine& line = lines_[candidate.line];
    const Post a = line[link.previous], p = line[candidate.at], b = line[link.next];
    if (a == b) return false;
    const auto decoded = [](Post q) { return Post{quantized(q.x), quantized(q.y)}; };
    Post u = decoded(a), v = decoded(p), w = decoded(b);
    if (cross(u, v, w) < 0) std::swap(u, w);
    for (int y = std::min({a.y, p.y, b.y}); y <= std::max({a.y, p.y, b.y}); ++y) {
      for (int x = std::min({a.x, p.x, b.x}); x <= std::max({a.x, p.x, b.x}); ++x) {
        const Post q{x, y};
        if (taken_[place_of(q)] == 0 || q == a || q == p || q == b) continue;
        const Post at = decoded(q);
        if (cross(u, v, at) >= 0 && cross(v, w, at) >= 0 && cross(w, u, at) >= 0) return false;
      }
    }
    return true;
  }

  void remove(const Candidate& candidate) {
    auto& links = links_[candidate.line];
    const Link link = links[candidate.at];
    taken_[place_of(lines_[candidate.line][candidate.at])] &= other;
    links[link.previous].next = link.next;
    links[link.next].previous = link.previous;
    for (const std::uint32_t beside : {link.previous, link.next}) {
      ++links[beside].version;
      if (beside > 0 && beside + 1 < links.size()) push(candidate.line, beside);
    }
  }

  std::vector<FeatureLine>& lines_;
  const TileLattice& lattice_;
  glm::dvec2 spacing_m_;
  static constexpr std::uint8_t of_line = 1, other = 2;
  std::vector<std::uint8_t> taken_;  // per post: of what it is a vertex
  std::vector<std::vector<Link>> links_;
  std::priority_queue<Candidate> queue_;
};

}  // namespace

std::vector<FeatureLine> feature_lines(const TileLattice& lattice, double angle_rad, std::uint32_t least_edges) {
  return SharpEdges{lattice, angle_rad}.lines(least_edges);
}

void simplify_lines(std::vector<FeatureLine>& lines, const TileLattice& lattice, const glm::dvec2& spacing_m,
                    std::span<const Post> others, double tolerance_m) {
  LineSimplifier{lines, lattice, spacing_m}.run(others, tolerance_m);
}

}  // namespace lodestone::terrain
