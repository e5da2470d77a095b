// SPDX-License-Identifier: MIT
// Based on: Kada and McKinley 2009, "3D building reconstruction from LiDAR based on a cell decomposition approach"
// (cells between the lines of the main walls; those that the building covers make up its footprint). Differs: lines
// come from the planes of a detailed model, coverage from a raster of its faces seen from above.
#include "facets/footprint.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <utility>

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
constexpr double high_share = 0.8;    // so much of the ground is covered lower than what counts as high
constexpr double lowest_ratio = 0.2;  // of that height: lower is the ground
constexpr double annex_ratio = 0.5;   // lower is an annex, which a block may leave out
constexpr double least_gain = 0.1;    // of the volume by which block and building differ
constexpr int raster_cells = 192;     // along the longer side

struct Line {
  glm::dvec2 normal{0.0};
  double offset_m = 0.0;
  double weight = 0.0;

  [[nodiscard]] double distance(const glm::dvec2& p) const { return glm::dot(normal, p) - offset_m; }
};

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// The highest face over each cell of the ground.
class Raster {
 public:
  explicit Raster(const Mesh& mesh) {
    const Box box = bounds(mesh);
    ground_m_ = box.min.z;
    low_ = {box.min.x, box.min.y};
    const double extent = std::max(box.max.x - box.min.x, box.max.y - box.min.y);
    cell_m_ = std::max(extent / raster_cells, 1e-6);
    nx_ = static_cast<int>((box.max.x - box.min.x) / cell_m_) + 1;
    ny_ = static_cast<int>((box.max.y - box.min.y) / cell_m_) + 1;
    heights_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_), empty_height);
    for (FaceId f = 0; f < mesh.triangle_count(); ++f) draw(mesh, f);
  }
  // Without what is lower than `ground_ratio` of the height: that is no building.
  [[nodiscard]] Raster above(double ground_ratio) const {
    Raster raster = *this;
    raster.forget_ground(ground_ratio);
    raster.count_full();
    return raster;
  }

  // Calls visit(place, height) for all cells; height is `empty_height` where nothing is.
  template <class Visit>
  void visit_all(Visit visit) const {
    for (int y = 0; y < ny_; ++y) {
      for (int x = 0; x < nx_; ++x) visit(middle(x, y), at(x, y));
    }
  }
  // Calls visit(inside, height) for all cells.
  template <class Visit>
  void visit_all(const Footprint& footprint, Visit visit) const {
    std::vector<double> crossings;
    for (int y = 0; y < ny_; ++y) {
      find_crossings(footprint, middle(0, y).y, crossings);
      std::size_t passed = 0;
      for (int x = 0; x < nx_; ++x) {
        while (passed < crossings.size() && crossings[passed] <= middle(x, y).x) ++passed;
        visit((crossings.size() - passed) % 2 != 0, at(x, y));
      }
    }
  }
  // Of cells that are not empty, those whose middles lie in the convex polygon, which turns left.
  [[nodiscard]] int count_in(std::span<const glm::dvec2> polygon) const {
    double low_y = polygon[0].y;
    double high_y = low_y;
    for (const glm::dvec2& p : polygon) {
      low_y = std::min(low_y, p.y);
      high_y = std::max(high_y, p.y);
    }
    int count = 0;
    for (int y = std::max(cell_of({low_.x, low_y}).y, 0); y <= std::min(cell_of({low_.x, high_y}).y, ny_ - 1); ++y) {
      double left = low_.x;
      double right = middle(nx_, y).x;
      const double at_y = middle(0, y).y;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a = polygon[i];
        const glm::dvec2 along = polygon[i + 1 == polygon.size() ? 0 : i + 1] - a;
        const double x = along.y == 0.0 ? 0.0 : a.x + (at_y - a.y) / along.y * along.x;
        if (along.y > 0.0) right = std::min(right, x);
        if (along.y < 0.0) left = std::max(left, x);
        if (along.y == 0.0 && along.x * (at_y - a.y) < 0.0) right = left - 1.0;
      }
      if (left > right) continue;  // sides that hardly rise meet the row very far away
      const int first = std::max(static_cast<int>(std::ceil((left - low_.x) / cell_m_ - 0.5)), 0);
      const int end = std::min(static_cast<int>(std::floor((right - low_.x) / cell_m_ - 0.5)), nx_ - 1) + 1;
      if (first < end) count += full_before(end, y) - full_before(first, y);
    }
    return count;
  }
  [[nodiscard]] double cell_area_m2() const { return cell_m_ * cell_m_; }

  static constexpr double empty_height = -1e30;

 private:
  [[nodiscard]] glm::dvec2 middle(int x, int y) const { return low_ + cell_m_ * (glm::dvec2{x, y} + 0.5); }
  [[nodiscard]] glm::ivec2 cell_of(const glm::dvec2& p) const { return glm::ivec2{glm::floor((p - low_) / cell_m_)}; }
  [[nodiscard]] double at(int x, int y) const {
    return heights_[static_cast<std::size_t>(y) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(x)];
  }

  // Where the outline crosses a row, ascending.
  static void find_crossings(const Footprint& footprint, double y, std::vector<double>& crossings) {
    crossings.clear();
    for (std::size_t loop = 0, first = 0; loop < footprint.loop_ends.size(); first = footprint.loop_ends[loop++]) {
      for (std::size_t i = first, end = footprint.loop_ends[loop]; i < end; ++i) {
        const glm::dvec2 a = footprint.corners[i];
        const glm::dvec2 b = footprint.corners[i + 1 == end ? first : i + 1];
        if ((a.y > y) != (b.y > y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
      }
    }
    std::sort(crossings.begin(), crossings.end());
  }

  // In its row.
  [[nodiscard]] int full_before(int x, int y) const {
    return full_before_[static_cast<std::size_t>(y) * static_cast<std::size_t>(nx_ + 1) + static_cast<std::size_t>(x)];
  }
  void count_full() {
    full_before_.clear();
    for (int y = 0; y < ny_; ++y) {
      int count = 0;
      full_before_.push_back(count);
      for (int x = 0; x < nx_; ++x) full_before_.push_back(count += at(x, y) > empty_height ? 1 : 0);
    }
  }

  // The ground around a building may come with it, as a slab or a terrace.
  void forget_ground(double ground_ratio) {
    std::vector<double> full;
    std::copy_if(heights_.begin(), heights_.end(), std::back_inserter(full), [](double h) { return h > empty_height; });
    if (full.empty()) return;
    const auto high = full.begin() + static_cast<std::ptrdiff_t>(high_share * static_cast<double>(full.size() - 1));
    std::nth_element(full.begin(), high, full.end());
    const double ground_m = ground_m_ + ground_ratio * (*high - ground_m_);
    for (double& h : heights_) h = h < ground_m ? empty_height : h;
  }

  void draw(const Mesh& mesh, FaceId f) {
    std::array<glm::dvec3, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = glm::dvec3{mesh.vertices.positions[mesh.indices[3 * std::size_t{f} + k]]};
    }
    const auto flat = [&](std::size_t k) { return glm::dvec2{p[k].x, p[k].y}; };
    const double area = cross(flat(1) - flat(0), flat(2) - flat(0));
    if (std::abs(area) < 1e-9) return;
    const glm::ivec2 first = cell_of(glm::min(glm::min(flat(0), flat(1)), flat(2)));
    const glm::ivec2 last = cell_of(glm::max(glm::max(flat(0), flat(1)), flat(2)));
    for (int y = std::max(first.y, 0); y <= std::min(last.y, ny_ - 1); ++y) {
      for (int x = std::max(first.x, 0); x <= std::min(last.x, nx_ - 1); ++x) {
        const glm::dvec2 m = middle(x, y);
        const double b = cross(m - flat(0), flat(2) - flat(0)) / area;
        const double c = cross(flat(1) - flat(0), m - flat(0)) / area;
        if (b < 0.0 || c < 0.0 || b + c > 1.0) continue;
        double& height =
            heights_[static_cast<std::size_t>(y) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(x)];
        height = std::max(height, p[0].z + b * (p[1].z - p[0].z) + c * (p[2].z - p[0].z));
      }
    }
  }

  glm::dvec2 low_{0.0};
  double cell_m_ = 1.0;
  double ground_m_ = 0.0;
  int nx_ = 0, ny_ = 0;
  std::vector<double> heights_;
  std::vector<int> full_before_;  // cells of the row that are not empty, per cell and one past the end
};

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

// A rectangle cut by lines. Each line cuts all cells, so neighbours share whole edges.
class Cells {
 public:
  Cells(const std::array<glm::dvec2, 4>& rectangle) : points_(rectangle.begin(), rectangle.end()) {
    cells_.push_back({0, 1, 2, 3});
  }

  void cut(const Line& line) {
    std::vector<double> side(points_.size());
    for (std::size_t i = 0; i < side.size(); ++i) {
      side[i] = line.distance(points_[i]);
      if (std::abs(side[i]) < 1e-6) side[i] = 0.0;
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> met;
    const auto meeting = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] = met.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points_.size()));
      if (added) points_.push_back(points_[a] + side[a] / (side[a] - side[b]) * (points_[b] - points_[a]));
      return at->second;
    };
    std::vector<std::vector<std::uint32_t>> after;
    for (const auto& cell : cells_) {
      std::array<std::vector<std::uint32_t>, 2> halves;
      for (std::size_t i = 0; i < cell.size(); ++i) {
        const std::uint32_t a = cell[i];
        const std::uint32_t b = cell[(i + 1) % cell.size()];
        if (side[a] >= 0.0) halves[0].push_back(a);
        if (side[a] <= 0.0) halves[1].push_back(a);
        if (side[a] * side[b] >= 0.0) continue;
        const std::uint32_t m = meeting(a, b);
        halves[0].push_back(m);
        halves[1].push_back(m);
      }
      for (auto& half : halves) {
        if (half.size() >= 3) after.push_back(std::move(half));
      }
    }
    cells_ = std::move(after);
  }

  // The outlines of all cells that are covered, simple loops, the covered side to the left. Empty if two touch in a
  // point.
  [[nodiscard]] std::vector<std::vector<glm::dvec2>> covered_loops(const Raster& raster) const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> edges;
    for (const auto& cell : cells_) {
      if (!covered(cell, raster)) continue;
      for (std::size_t i = 0; i < cell.size(); ++i) edges[{cell[i], cell[(i + 1) % cell.size()]}] = true;
    }
    std::map<std::uint32_t, std::uint32_t> next;
    for (const auto& [edge, used] : edges) {
      if (edges.contains({edge.second, edge.first})) continue;
      if (!next.emplace(edge.first, edge.second).second) return {};
    }
    std::vector<std::vector<glm::dvec2>> loops;
    while (!next.empty()) {
      std::vector<glm::dvec2> loop;
      for (auto at = next.begin(); at != next.end();) {
        loop.push_back(points_[at->first]);
        const std::uint32_t to = at->second;
        next.erase(at);
        at = next.find(to);
      }
      loops.push_back(std::move(loop));
    }
    return loops;
  }

 private:
  // At least half of its area, of which much may lie beyond the raster.
  [[nodiscard]] bool covered(const std::vector<std::uint32_t>& cell, const Raster& raster) const {
    std::vector<glm::dvec2> polygon;
    double twice_area_m2 = 0.0;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const glm::dvec2& p = points_[cell[i]];
      polygon.push_back(p);
      twice_area_m2 += cross(p - points_[cell[0]], points_[cell[(i + 1) % cell.size()]] - points_[cell[0]]);
    }
    return raster.count_in(polygon) * raster.cell_area_m2() > 0.25 * twice_area_m2;
  }

  std::vector<glm::dvec2> points_;
  std::vector<std::vector<std::uint32_t>> cells_;  // convex, turning left
};

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

Reach find_reach(const Raster& raster, const glm::dvec2& along) {
  Reach reach{along};
  raster.visit_all([&](const glm::dvec2& p, double height) {
    if (height == Raster::empty_height) return;
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
double agreement(const Raster& raster, Footprint& footprint) {
  double both = 0.0;
  double any = 0.0;
  std::vector<double> heights;
  raster.visit_all(footprint, [&](bool inside, double height) {
    const bool full = height > Raster::empty_height;
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
double difference_m3(const Raster& raster, const Footprint& footprint) {
  double sum = 0.0;
  raster.visit_all(footprint, [&](bool inside, double height) {
    const double block_m = inside ? footprint.high_m : footprint.low_m;
    sum += std::abs(std::max(height, footprint.low_m) - block_m) * raster.cell_area_m2();
  });
  return sum;
}

Footprint find_on(const Raster& raster, const std::vector<Line>& lines, std::uint32_t most_corners) {
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
    Cells cells{rectangle};
    for (const Line& line : used) cells.cut(line);
    Footprint found;
    if (!take_loops(cells.covered_loops(raster), found) || found.corner_count() > most_corners) continue;
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
  const Raster all{mesh};
  const Raster raster = all.above(lowest_ratio);
  Footprint whole = find_on(raster, lines, most_corners);
  Footprint body = find_on(all.above(annex_ratio), lines, most_corners);
  whole.low_m = body.low_m = bounds(mesh).min.z;
  if (!whole.sentence.empty() || !body.sentence.empty()) return whole;
  const bool better = difference_m3(raster, body) < (1.0 - least_gain) * difference_m3(raster, whole);
  return better ? body : whole;
}

}  // namespace lodestone::facets
