// SPDX-License-Identifier: MIT
// Based on: Kada and McKinley 2009, "3D building reconstruction from LiDAR based on a cell decomposition approach"
// (cells between the lines of the main walls; those that the building covers make up its footprint). Differs: lines
// come from the planes of a detailed model, coverage from a raster of its faces seen from above.
#include "facets/footprint.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "facets/ground_cells.h"
#include "facets/height_raster.h"

namespace lodestone::facets {
namespace {

constexpr double vertical_sine = 0.0872;
constexpr double least_wall_share = 0.15;   // of the area; less is no building
constexpr double least_line_share = 0.03;   // of the walls' area
constexpr double same_line_cosine = 0.996;  // 5 degrees
constexpr double same_line_m = 0.6;
constexpr double eaves_m = 1.2;   // a roof that reaches farther than this over the last wall stands on one not there
constexpr double margin_m = 4.0;  // around everything: keeps what overhangs outside
constexpr double least_agreement = 0.6;  // of footprint and coverage: intersection over union
constexpr double corner_price = 0.015;   // of agreement that a corner more must bring
constexpr double least_loop_share = 0.03;
constexpr double annex_ratio = 0.5;  // of the height of what is high: lower is an annex, which a block may leave out
constexpr double least_gain = 0.1;   // of the volume by which block and building differ

// Walls that lie in one line are one; heaviest first. Empty if too little of the area is wall.
std::vector<Line> wall_lines(const Mesh& mesh, const CharacteristicSurfaces& found) {
  const auto count = found.surfaces.size();
  std::vector<glm::dvec3> middles(count, glm::dvec3{0.0});
  for (std::size_t c = 0; c < mesh.indices.size(); ++c) {
    const std::uint32_t s = found.surface_of_face[c / 3];
    if (s == none) continue;
    middles[s] += glm::dvec3{mesh.vertices.positions[mesh.indices[c]]} / (3.0 * found.surfaces[s].face_count);
  }
  std::vector<std::uint32_t> walls;
  double whole = 0.0;
  double wall_area = 0.0;
  for (std::uint32_t s = 0; s < count; ++s) {
    whole += found.surfaces[s].area_m2;
    if (std::abs(found.surfaces[s].normal.z) >= vertical_sine) continue;
    wall_area += found.surfaces[s].area_m2;
    walls.push_back(s);
  }
  if (wall_area < least_wall_share * whole) return {};
  std::stable_sort(walls.begin(), walls.end(), [&](std::uint32_t a, std::uint32_t b) {
    return found.surfaces[a].area_m2 > found.surfaces[b].area_m2;
  });
  std::vector<Line> lines;
  for (const std::uint32_t s : walls) {
    const CharacteristicSurface& surface = found.surfaces[s];
    const glm::dvec2 normal = glm::normalize(glm::dvec2{surface.normal.x, surface.normal.y});
    const glm::dvec2 middle{middles[s].x, middles[s].y};
    const auto at = std::find_if(lines.begin(), lines.end(), [&](const Line& line) {
      return std::abs(glm::dot(line.normal, normal)) > same_line_cosine &&
             std::abs(line.distance(middle)) < same_line_m;
    });
    if (at != lines.end()) {
      at->weight += surface.area_m2 / wall_area;
    } else if (surface.area_m2 > 0.1 * least_line_share * wall_area) {
      lines.push_back({normal, glm::dot(normal, middle), surface.area_m2 / wall_area});
    }
  }
  std::erase_if(lines, [](const Line& line) { return line.weight < least_line_share; });
  std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.weight > b.weight; });
  return lines;
}

// At least half of its area, of which much may lie beyond the raster.
bool covered(const std::vector<glm::dvec2>& points, const std::vector<std::uint32_t>& cell,
             const HeightRaster& raster) {
  std::vector<glm::dvec2> polygon;
  double twice_area_m2 = 0.0;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const glm::dvec2& p = points[cell[i]];
    polygon.push_back(p);
    twice_area_m2 += cross(p - points[cell[0]], points[cell[(i + 1) % cell.size()]] - points[cell[0]]);
  }
  return raster.count_in(polygon) * raster.cell_area_m2() > 0.25 * twice_area_m2;
}

// Empty if two of them touch in a point.
std::vector<std::vector<glm::dvec2>> covered_loops(const GroundCells& cells, const HeightRaster& raster) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& cell : cells.cells()) {
    if (!covered(cells.points(), cell, raster)) continue;
    for (std::size_t i = 0; i < cell.size(); ++i) edges.emplace(cell[i], cell[(i + 1) % cell.size()]);
  }
  std::vector<std::vector<glm::dvec2>> loops;
  for (const auto& outline : outlines_of(edges)) {
    loops.emplace_back();
    for (const std::uint32_t p : outline) loops.back().push_back(cells.points()[p]);
  }
  return loops;
}

double signed_area_m2(const std::vector<glm::dvec2>& loop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) sum += cross(loop[i], loop[(i + 1) % loop.size()]);
  return 0.5 * sum;
}

// Corners in the middle of a straight side go.
void straighten(std::vector<glm::dvec2>& loop) {
  for (std::size_t i = 0; i < loop.size() && loop.size() > 3;) {
    const glm::dvec2 before = loop[i] - loop[(i + loop.size() - 1) % loop.size()];
    const glm::dvec2 after = loop[(i + 1) % loop.size()] - loop[i];
    if (std::abs(cross(before, after)) > 1e-6 * glm::length(before) * glm::length(after)) {
      ++i;
    } else {
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    }
  }
}

// How far what is covered reaches along a direction.
struct Reach {
  glm::dvec2 along{0.0};
  double low_m = std::numeric_limits<double>::infinity();
  double high_m = -std::numeric_limits<double>::infinity();
};

Reach find_reach(const HeightRaster& raster, const glm::dvec2& along) {
  Reach reach{along};
  raster.visit_all([&](const glm::dvec2& p, double height) {
    if (height == HeightRaster::empty_height) return;
    reach.low_m = std::min(reach.low_m, glm::dot(along, p));
    reach.high_m = std::max(reach.high_m, glm::dot(along, p));
  });
  return reach;
}

// Where the outermost wall line of a direction lies far inside of what is covered, there is a wall missing.
void add_missing_walls(const Reach& reach, std::vector<Line>& lines) {
  for (const double end : {reach.low_m, reach.high_m}) {
    const bool there = std::any_of(lines.begin(), lines.end(), [&](const Line& line) {
      const double cosine = glm::dot(line.normal, reach.along);
      return std::abs(cosine) > same_line_cosine && std::abs(line.offset_m * cosine - end) < eaves_m;
    });
    if (!there) lines.push_back({reach.along, end, 0.0});
  }
}

// The largest loop and the holes in it; false if much lies elsewhere.
bool take_loops(std::vector<std::vector<glm::dvec2>> loops, Footprint& footprint) {
  std::erase_if(loops, [](const auto& loop) { return loop.size() < 3; });
  for (auto& loop : loops) straighten(loop);
  std::stable_sort(loops.begin(), loops.end(),
                   [](const auto& a, const auto& b) { return signed_area_m2(a) > signed_area_m2(b); });
  footprint.corners.clear();
  footprint.loop_ends.clear();
  if (loops.empty()) return false;
  const double largest = signed_area_m2(loops.front());
  for (const auto& loop : loops) {
    const double area = signed_area_m2(loop);
    if (std::abs(area) < least_loop_share * largest) continue;
    if (area > 0.0 && !footprint.corners.empty()) return false;
    footprint.corners.insert(footprint.corners.end(), loop.begin(), loop.end());
    footprint.loop_ends.push_back(footprint.corner_count());
  }
  return true;
}

// Intersection over union of the footprint and what is covered; and the height that half of it reaches.
double agreement(const HeightRaster& raster, Footprint& footprint) {
  double both = 0.0;
  double any = 0.0;
  std::vector<double> heights;
  raster.visit_all(footprint, [&](bool inside, double height) {
    const bool full = height > HeightRaster::empty_height;
    both += full && inside ? 1.0 : 0.0;
    any += full || inside ? 1.0 : 0.0;
    if (full && inside) heights.push_back(height);
  });
  if (heights.empty()) return 0.0;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  footprint.high_m = *middle;
  return both / any;
}

}  // namespace

namespace {

// What either has and the other has not.
double difference_m3(const HeightRaster& raster, const Footprint& footprint) {
  double sum = 0.0;
  raster.visit_all(footprint, [&](bool inside, double height) {
    const double block_m = inside ? footprint.high_m : footprint.low_m;
    sum += std::abs(std::max(height, footprint.low_m) - block_m) * raster.cell_area_m2();
  });
  return sum;
}

Footprint find_on(const HeightRaster& raster, const std::vector<Line>& lines, std::uint32_t most_corners) {
  Footprint footprint;
  const glm::dvec2 along = lines.front().normal;
  const glm::dvec2 across{-along.y, along.x};
  const Reach reach_a = find_reach(raster, along);
  const Reach reach_b = find_reach(raster, across);
  if (!(reach_a.low_m < reach_a.high_m) || !(reach_b.low_m < reach_b.high_m)) {
    footprint.sentence = "nothing lies over the ground between the walls";
    return footprint;
  }
  const std::array<double, 4> a{reach_a.low_m - margin_m, reach_a.high_m + margin_m, reach_a.high_m + margin_m,
                                reach_a.low_m - margin_m};
  const std::array<double, 4> b{reach_b.low_m - margin_m, reach_b.low_m - margin_m, reach_b.high_m + margin_m,
                                reach_b.high_m + margin_m};
  std::array<glm::dvec2, 4> rectangle{};
  for (std::size_t i = 0; i < 4; ++i) rectangle[i] = a[i] * along + b[i] * across;
  double best = -std::numeric_limits<double>::infinity();
  // With fewer lines there are fewer corners; the ends of what is covered always make a rectangle.
  for (std::size_t most_lines : {16U, 12U, 8U, 6U, 4U, 0U}) {
    std::vector<Line> used{lines.begin(),
                           lines.begin() + static_cast<std::ptrdiff_t>(std::min(most_lines, lines.size()))};
    add_missing_walls(reach_a, used);
    add_missing_walls(reach_b, used);
    GroundCells cells{rectangle};
    for (const Line& line : used) cells.cut(line);
    Footprint found;
    if (!take_loops(covered_loops(cells, raster), found) || found.corner_count() > most_corners) continue;
    const double share = agreement(raster, found);
    const double worth = share - corner_price * found.corner_count();
    if (share < least_agreement || worth <= best) continue;
    best = worth;
    footprint = std::move(found);
  }
  if (footprint.corners.empty()) {
    footprint.sentence = "what it covers of the ground is not one piece between its walls";
  }
  return footprint;
}

}  // namespace

Footprint find_footprint(const Mesh& mesh, const CharacteristicSurfaces& surfaces, std::uint32_t most_corners) {
  const std::vector<Line> lines = wall_lines(mesh, surfaces);
  if (lines.empty()) {
    Footprint nothing;
    nothing.sentence = "there are no walls to stand a block on";
    return nothing;
  }
  const HeightRaster all{mesh};
  const HeightRaster raster = all.above(lowest_ratio);
  Footprint whole = find_on(raster, lines, most_corners);
  Footprint body = find_on(all.above(annex_ratio), lines, most_corners);
  whole.low_m = body.low_m = bounds(mesh).min.z;
  if (!whole.sentence.empty() || !body.sentence.empty()) return whole;
  const bool better = difference_m3(raster, body) < (1.0 - least_gain) * difference_m3(raster, whole);
  return better ? body : whole;
}

}  // namespace lodestone::facets
