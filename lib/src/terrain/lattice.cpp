// SPDX-License-Identifier: MIT
#include "terrain/lattice.h"

#include <algorithm>

namespace lodestone::terrain {

bool TileLattice::complete() const noexcept {
  for (int y = 0; y <= size; ++y) {
    for (int x = 0; x <= size; ++x) {
      if (!valid(x, y)) return false;
    }
  }
  return true;
}

double TileLattice::vertex_height_m(Post p) const noexcept {
  const double height_m = at(p.x, p.y);
  const auto lean = [&](double shift, float before, float after) {
    const float behind = shift > 0.0 ? before : after;
    return std::isnan(behind) ? 0.0 : std::fabs(shift) * (height_m - static_cast<double>(behind));
  };
  // Corners are exact; on a border the other coordinate's shift is 0.
  return height_m + lean(quantized_shift(p.x), at(p.x - 1, p.y), at(p.x + 1, p.y)) +
         lean(quantized_shift(p.y), at(p.x, p.y - 1), at(p.x, p.y + 1));
}

}  // namespace lodestone::terrain
