// SPDX-License-Identifier: MIT
#include "terrain/error.h"

#include <cmath>

namespace lodestone::terrain {

namespace {

// Rounding to quantised units has turned the triangle over: it is long and thin, and a post beside it helps.
Post middle_of_longest_edge(const Tin::Vertex& a, const Tin::Vertex& b, const Tin::Vertex& c) {
  const auto length = [](const Tin::Vertex& p, const Tin::Vertex& q) { return std::hypot(p.u - q.u, p.v - q.v); };
  const Tin::Vertex *p = &a, *q = &b;
  if (length(b, c) > length(*p, *q)) p = &b, q = &c;
  if (length(c, a) > length(*p, *q)) p = &c, q = &a;
  const auto post = [](int sum) { return (sum * size + quantized_max) / (2 * quantized_max); };
  return {post(p->u + q->u), post(p->v + q->v)};
}

}  // namespace

TinError measure(const Tin& tin, const TileLattice& lattice, double limit_m) {
  TinError error;
  std::vector<Post> beside;
  std::vector<double> off_m(std::size_t{size + 1} * (size + 1), -1.0);
  for (std::size_t t = 0; t < tin.triangles.size(); t += 3) {
    const Tin::Vertex& a = tin.vertices[tin.triangles[t]];
    const Tin::Vertex& b = tin.vertices[tin.triangles[t + 1]];
    const Tin::Vertex& c = tin.vertices[tin.triangles[t + 2]];
    if (area_of(a, b, c) <= 0) {
      error.sound = false;
      beside.push_back(middle_of_longest_edge(a, b, c));
      continue;
    }
    for_each_post(a, b, c, [&](int x, int y, double height_m) {
      double& off = off_m[static_cast<std::size_t>(y) * (size + 1) + static_cast<std::size_t>(x)];
      const double here = std::fabs(height_m - static_cast<double>(lattice.at(x, y)));
      if (here > off) off = here;
    });
  }
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      const double off = off_m[static_cast<std::size_t>(y) * (size + 1) + static_cast<std::size_t>(x)];
      if (off < 0.0) continue;
      ++error.covered_count;
      error.max_m = std::max(error.max_m, off);
      if (off > limit_m) error.too_far.push_back({x, y});
    }
  }
  error.too_far.insert(error.too_far.end(), beside.begin(), beside.end());
  return error;
}

}  // namespace lodestone::terrain
