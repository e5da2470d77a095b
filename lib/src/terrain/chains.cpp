// SPDX-License-Identifier: MIT
// Based on: the border constraint of Campos et al. 2020, section 4.
// Differs: no border is inherited from a tile that happens to be built first. A chain is made by halving: an interval
// whose posts stand off its chord by more than the tolerance is cut in the middle. A finer zoom sees the same posts and
// more of them, under a smaller tolerance, so it cuts wherever the zoom above does: chains are nested without knowing
// of each other. (Free choice of vertices needs some fewer, but is not nested.)
#include "terrain/chains.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lodestone::terrain {
namespace {

// What cannot be seen of the tolerance when cutting: clients move vertices by up to 1/256 post.
constexpr double share_for_chords = 0.9;

class Divider {
 public:
  Divider(const ChainLine& line, const ChainOptions& options) : line_{line}, options_{options} {}
  [[nodiscard]] std::vector<int>& vertices() noexcept { return vertices_; }

  // Adds the vertices between two posts.
  void divide(int a, int b) {
    if (b - a < 2 || !must_cut(a, b)) return;
    // The roundest number inside: the middle where a and b are ends of such an interval themselves.
    const auto differing = static_cast<unsigned>(a ^ (b - 1));
    const int bit = static_cast<int>(std::bit_floor(differing));
    const int middle = (b - 1) & ~(bit - 1);
    divide(a, middle);
    vertices_.push_back(middle);
    divide(middle, b);
  }

 private:
  // Whether posts stand off the chord between two posts, or off the edge that clients will draw.
  [[nodiscard]] bool must_cut(int a, int b) const {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    const double from_m = line_.post_m[i];
    const double rise_m = (line_.post_m[j] - from_m) / (b - a);
    const double drawn_m = line_.vertex_m[i];
    const double drawn_rise_m = (line_.vertex_m[j] - drawn_m) / (line_.place[j] - line_.place[i]);
    for (int t = a + 1; t < b; ++t) {
      const double h = line_.post_m[static_cast<std::size_t>(t)];
      if (std::fabs(h - (from_m + rise_m * (t - a))) > share_for_chords * options_.tolerance_m) return true;
      const double off_m = std::fabs(h - (drawn_m + drawn_rise_m * (t - line_.place[i])));
      if (off_m > options_.tolerance_m + 0.5 * options_.step_m) return true;
    }
    return false;
  }

  ChainLine line_;
  ChainOptions options_;
  std::vector<int> vertices_;
};

ChainLine line_of(const TileLattice& lattice, Side side, double step_m) {
  ChainLine line;
  for (int t = 0; t <= size; ++t) {
    const Post p = post_of(side, t);
    const auto i = static_cast<std::size_t>(t);
    line.post_m[i] = lattice.at(p.x, p.y);
    line.place[i] = t + quantized_shift(t);
    line.vertex_m[i] = snapped_m(lattice.vertex_height_m(p), step_m);
  }
  return line;
}

class Chain {
 public:
  Chain(const TileLattice& lattice, Side side, const ChainOptions& options)
      : options_{options}, divider_{line_of(lattice, side, options.step_m), options} {
    for (int t = 0; t < size; ++t) {
      const Post a = post_of(side, t);
      const bool along_x = side == Side::South || side == Side::North;
      inner_[t] = lattice.cell(a.x, a.y);
      outer_[t] = along_x ? lattice.cell(a.x, a.y - 1) : lattice.cell(a.x - 1, a.y);
    }
  }

  [[nodiscard]] std::vector<int> vertices() {
    int begin = 0;
    for (int t = 0; t <= size; ++t) {
      if (!required(t)) continue;
      // All segments between required posts are alike.
      if (t > 0 && live(t - 1)) divider_.divide(begin, t);
      if (touches_live(t)) divider_.vertices().push_back(t);
      begin = t;
    }
    return std::move(divider_.vertices());
  }

 private:
  [[nodiscard]] bool live(int segment) const { return inner_[segment] || outer_[segment]; }
  [[nodiscard]] bool touches_live(int t) const { return (t > 0 && live(t - 1)) || (t < size && live(t)); }
  [[nodiscard]] bool required(int t) const {
    if (t == 0 || t == size) return true;
    if (inner_[t - 1] != inner_[t] || outer_[t - 1] != outer_[t]) return true;
    return t % (size / options_.divisions) == 0;
  }
  ChainOptions options_;
  std::array<bool, size> inner_{};  // per segment: the cell east or north of it has data
  std::array<bool, size> outer_{};
  Divider divider_;
};

}  // namespace

std::vector<int> divided_chain(const ChainLine& line, const ChainOptions& options) {
  Divider divider{line, options};
  const int spacing = size / options.divisions;
  for (int begin = 0; begin < size; begin += spacing) {
    divider.vertices().push_back(begin);
    divider.divide(begin, begin + spacing);
  }
  divider.vertices().push_back(size);
  return std::move(divider.vertices());
}

std::vector<int> border_chain(const TileLattice& lattice, Side side, const ChainOptions& options) {
  return Chain{lattice, side, options}.vertices();
}

Tin::Vertex border_vertex(const TileLattice& lattice, Post post, double step_m) {
  return {quantized(post.x), quantized(post.y), snapped_m(lattice.vertex_height_m(post), step_m)};
}

std::vector<Tin::Vertex> border_vertices(const TileLattice& lattice, Side side, const ChainOptions& options) {
  std::vector<Tin::Vertex> vertices;
  for (const int t : border_chain(lattice, side, options)) {
    vertices.push_back(border_vertex(lattice, post_of(side, t), options.step_m));
  }
  return vertices;
}

double border_detail_m(const TileLattice& lattice, Side side) {
  double most_m = 0.0;
  const auto height_m = [&](int t) { return lattice.at(post_of(side, t).x, post_of(side, t).y); };
  for (int t = 1; t < size; t += 2) {
    const double off_m = std::fabs(height_m(t) - 0.5 * (static_cast<double>(height_m(t - 1)) + height_m(t + 1)));
    if (off_m > most_m) most_m = off_m;  // false for posts without data
  }
  return most_m;
}

}  // namespace lodestone::terrain
