// SPDX-License-Identifier: MIT
// Between levels: how far a tile's border may gape beside a neighbour of another level.
#include <algorithm>
#include <set>
#include <tuple>

#include <catch2/catch.hpp>

#include "fixture.h"
#include "geometry/bvh.h"

namespace lodestone::test {

TEST_CASE("Beside a neighbour one level coarser a border gapes by no more than the coarser tile's error") {
  const auto pyramid = pyramid_of(small_cliff(), small_tiles());
  using Point = std::tuple<float, float, float>;
  std::size_t tried = 0;
  for (std::uint32_t coarse = 0; coarse < pyramid->tiles().size(); ++coarse) {
    const OutcropTile& tile = pyramid->tiles()[coarse];
    if (tile.children.empty() || tile.parent == none) continue;
    // The finer tiles' vertices on the border with tiles below other parents must lie near the coarse tile's surface.
    std::set<Point> mine;
    for (const std::uint32_t child : tile.children) {
      for (const glm::vec3& p : pyramid->content(child).mesh.vertices.positions) mine.emplace(p.x, p.y, p.z);
    }
    const Mesh surface = pyramid->content(coarse).mesh;
    const TriangleBvh nearest{surface.vertices.positions, surface.indices};
    for (std::uint32_t other = 0; other < pyramid->tiles().size(); ++other) {
      const OutcropTile& neighbour = pyramid->tiles()[other];
      if (neighbour.level + 1 != tile.level || neighbour.parent == coarse) continue;
      if (glm::any(glm::lessThan(neighbour.bounds.max, tile.bounds.min)) ||
          glm::any(glm::greaterThan(neighbour.bounds.min, tile.bounds.max)))
        continue;
      for (const glm::vec3& p : pyramid->content(other).mesh.vertices.positions) {
        if (!mine.contains({p.x, p.y, p.z})) continue;
        ++tried;
        CHECK(std::sqrt(nearest.nearest(glm::dvec3{p}).squared_distance) <= tile.error_m);
      }
    }
  }
  CHECK(tried > 100);
}

}  // namespace lodestone::test
