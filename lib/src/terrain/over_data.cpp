// SPDX-License-Identifier: MIT
#include "terrain/over_data.h"

namespace lodestone::terrain {

Tin tin_over_data(const LatticeDelaunay& triangulation, const TileLattice& lattice, std::span<const double> heights_m,
                  double step_m) {
  const std::vector<Post>& posts = triangulation.posts();
  Tin tin;
  tin.vertices.reserve(posts.size());
  tin.triangles.reserve(triangulation.corners().size());
  std::vector<std::uint32_t> name(posts.size(), none);
  for (std::uint32_t t = 0; t < triangulation.triangle_count(); ++t) {
    const std::uint32_t* v = triangulation.corners().data() + 3 * std::size_t{t};
    if (std::isnan(heights_m[v[0]] + heights_m[v[1]] + heights_m[v[2]])) continue;
    // Any cell that it overlaps tells.
    const int x = (posts[v[0]].x + posts[v[1]].x + posts[v[2]].x) / 3;
    const int y = (posts[v[0]].y + posts[v[1]].y + posts[v[2]].y) / 3;
    if (!lattice.cell(cell_of(x), cell_of(y))) continue;
    for (int k = 0; k < 3; ++k) {
      if (name[v[k]] == none) {
        name[v[k]] = static_cast<std::uint32_t>(tin.vertices.size());
        tin.vertices.push_back({posts[v[k]].x, posts[v[k]].y, snapped_m(heights_m[v[k]], step_m)});
      }
      tin.triangles.push_back(name[v[k]]);
    }
  }
  return tin;
}

}  // namespace lodestone::terrain
