// SPDX-License-Identifier: MIT
// Between levels: how far a tile's border may gape beside a neighbour of another level.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include <catch2/catch.hpp>

#include "fixture.h"
#include "geometry/bvh.h"
#include "mesh/weld.h"
#include "outcrop/borders.h"

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

TEST_CASE(
    "Behind the rim of an open wall skirts are no deeper than a quarter of the way to it, whatever errors are told") {
  Mesh mesh = small_cliff();  // in strips of two photographs by turns, so that chains between tiles vanish
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) {
    const float x = mesh.vertices.positions[mesh.indices[3 * std::size_t{f}]].x;
    mesh.face_materials[f] = static_cast<MaterialId>(static_cast<int>(std::floor(x)) & 1);
  }
  const Weld weld = weld_by_position(mesh.vertices.positions);
  const std::vector<std::uint32_t> one_tile(mesh.triangle_count(), 0);
  std::vector<glm::dvec3> rim;
  for (const std::uint32_t point : outcrop::find_borders(mesh.indices, weld, one_tile).open_points) {
    rim.emplace_back(mesh.vertices.positions[weld.first_vertex[point]]);
  }
  REQUIRE(rim.size() > 100);
  const auto pyramid = pyramid_of(mesh, small_tiles());
  double deepest_m = 0.0;
  for (std::uint32_t i = 0; i < pyramid->levels().front().tiles; ++i) {
    Mesh tile = pyramid->content(i).mesh;
    pyramid->add_skirt(i, tile);
    const auto at = [&](FaceId f, std::size_t k) {
      return tile.origin - mesh.origin + glm::dvec3{tile.vertices.positions[tile.indices[3 * std::size_t{f} + k]]};
    };
    // Skirts are pairs of triangles; the first has the border's b and a, then what hangs below a.
    for (FaceId f = surface_triangle_count(tile); f < tile.triangle_count(); f += 2) {
      double from_rim_m = std::numeric_limits<double>::infinity();
      for (const glm::dvec3& r : rim) from_rim_m = std::min(from_rim_m, glm::distance(r, at(f, 1)));
      const double deep_m = glm::distance(at(f, 1), at(f, 2));
      CHECK(deep_m <= 0.25 * from_rim_m + 1e-4);
      deepest_m = std::max(deepest_m, deep_m);
    }
  }
  CHECK(deepest_m > 0.1);
}

}  // namespace lodestone::test
