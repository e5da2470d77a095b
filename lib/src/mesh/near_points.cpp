// SPDX-License-Identifier: MIT
// Welding within a tolerance: a grid of cells as wide as the tolerance, so that only 27 cells need a look.
#include <array>
#include <cmath>
#include <unordered_map>

#include "base/hash.h"
#include "geometry/distance.h"
#include "mesh/repair.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

// Cells are kept as floored doubles: they do not overflow, however small the tolerance.
struct CellHash {
  std::size_t operator()(const std::array<double, 3>& c) const noexcept {
    std::uint64_t h = 0;
    for (const double x : c) h = hash_combine(h, std::bit_cast<std::uint64_t>(x + 0.0));
    return h;
  }
};

}  // namespace

std::uint32_t weld_near_points(Mesh& mesh, double tolerance_m) {
  auto& positions = mesh.vertices.positions;
  const Weld weld = weld_by_position(positions);
  // Per cell the kept points inside; they are farther apart than the tolerance, so there are few. Only looked up, never
  // walked through: the order of the table cannot matter.
  std::unordered_map<std::array<double, 3>, std::vector<std::uint32_t>, CellHash> cells;
  std::vector<VertexId> target(weld.point_count());
  std::uint32_t moved = 0;
  for (std::uint32_t point = 0; point < weld.point_count(); ++point) {
    const glm::dvec3 p{positions[weld.first_vertex[point]]};
    const glm::dvec3 cell = glm::floor(p / tolerance_m);
    double best = tolerance_m * tolerance_m;
    std::uint32_t nearest = none;
    for (int i = 0; i < 27; ++i) {
      const glm::ivec3 step{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
      const auto found = cells.find({cell.x + step.x, cell.y + step.y, cell.z + step.z});
      if (found == cells.end()) continue;
      for (const std::uint32_t other : found->second) {
        const double d = squared_length(p - glm::dvec3{positions[weld.first_vertex[other]]});
        if (d < best || (d == best && other < nearest)) {
          best = d;
          nearest = other;
        }
      }
    }
    if (nearest == none) {
      cells[{cell.x, cell.y, cell.z}].push_back(point);
      target[point] = weld.first_vertex[point];
    } else {
      target[point] = weld.first_vertex[nearest];
      ++moved;
    }
  }
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    positions[v] = glm::vec3{positions[target[weld.point_of[v]]]};  // kept points do not move, so order is free
  }
  return moved;
}

}  // namespace lodestone
