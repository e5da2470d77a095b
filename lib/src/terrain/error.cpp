// SPDX-License-Identifier: MIT
#include "terrain/error.h"

#include <cmath>
#include <limits>

namespace lodestone::terrain {

TinError measure(const Tin& tin, const TileLattice& lattice, double limit_m) {
  TinError error;
  constexpr double uncovered = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> off_m(std::size_t{size + 1} * (size + 1), uncovered);
  for (std::size_t t = 0; t < tin.triangles.size(); t += 3) {
    const Tin::Vertex& a = tin.vertices[tin.triangles[t]];
    const Tin::Vertex& b = tin.vertices[tin.triangles[t + 1]];
    const Tin::Vertex& c = tin.vertices[tin.triangles[t + 2]];
    if (area_of(a, b, c) <= 0) {
      error.sound = false;
      continue;
    }
    for_each_post(a, b, c, [&](int x, int y, double height_m) {
      double& off = off_m[static_cast<std::size_t>(y) * (size + 1) + static_cast<std::size_t>(x)];
      const double here = height_m - static_cast<double>(lattice.at(x, y));
      if (!(std::fabs(here) <= std::fabs(off))) off = here;
    });
  }
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      const double off = off_m[static_cast<std::size_t>(y) * (size + 1) + static_cast<std::size_t>(x)];
      if (std::isnan(off)) continue;
      ++error.covered_count;
      error.max_m = std::max(error.max_m, std::fabs(off));
      if (std::fabs(off) > limit_m) error.too_far.push_back({{x, y}, off});
    }
  }
  return error;
}

}  // namespace lodestone::terrain
