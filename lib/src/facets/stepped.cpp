// SPDX-License-Identifier: MIT
// Based on: Kada and McKinley 2009 (cells between walls, each with its height). Differs: two heights, and one or two
// cuts, so that there are hardly more faces than a prism has; sides that lie flush are one facet.
#include "facets/stepped.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "facets/ground_cells.h"
#include "facets/height_raster.h"

namespace lodestone::facets {
namespace {

constexpr double upright_sine = 0.05;
constexpr double least_wall_share = 0.01;  // of the area of all walls: to be cut along
constexpr double same_line_cosine = 0.999;
constexpr double same_line_m = 1.0;
constexpr std::size_t most_lines = 10;
constexpr double least_gain = 0.3;         // of the volume by which prism and building differ
constexpr double second_gain = 0.2;        // that a second cut must bring more
constexpr double least_step_ratio = 0.12;  // of the height
constexpr double least_part_ratio = 0.08;  // of the ground
constexpr double margin_m = 1.0;

struct Sample {
  glm::dvec2 at{0.0};
  double height_m = 0.0;
};

// Where it is high: to the left of all of these lines.
struct Cut {
  std::vector<Line> lines;
  double low_m = 0.0, high_m = 0.0;
  double difference = 0.0;  // per sample, metres

  [[nodiscard]] bool is_high(const glm::dvec2& p) const {
    return std::all_of(lines.begin(), lines.end(), [&](const Line& l) { return l.distance(p) > 0.0; });
  }
};

bool contains(const Footprint& footprint, const glm::dvec2& p) {
  bool inside = false;
  for (std::size_t loop = 0, first = 0; loop < footprint.loop_ends.size(); first = footprint.loop_ends[loop++]) {
    for (std::size_t i = first, end = footprint.loop_ends[loop]; i < end; ++i) {
      const glm::dvec2 a = footprint.corners[i];
      const glm::dvec2 b = footprint.corners[i + 1 == end ? first : i + 1];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
    }
  }
  return inside;
}

std::vector<Sample> heights_inside(const HeightRaster& raster, const Footprint& footprint) {
  std::vector<Sample> samples;
  raster.visit_all([&](const glm::dvec2& p, double height) {
    if (contains(footprint, p)) samples.push_back({p, std::max(height, footprint.low_m)});
  });
  return samples;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// False if one of the parts is small or the step is low.
bool measure(const std::vector<Sample>& samples, double floor_m, Cut& cut) {
  std::vector<double> low;
  std::vector<double> high;
  for (const Sample& s : samples) (cut.is_high(s.at) ? high : low).push_back(s.height_m);
  const double least = least_part_ratio * static_cast<double>(samples.size());
  if (static_cast<double>(std::min(low.size(), high.size())) < least) return false;
  cut.low_m = median(low);
  cut.high_m = median(high);
  if (cut.high_m - cut.low_m < least_step_ratio * (cut.high_m - floor_m) || cut.low_m <= floor_m) return false;
  double sum = 0.0;
  for (const double h : low) sum += std::abs(h - cut.low_m);
  for (const double h : high) sum += std::abs(h - cut.high_m);
  cut.difference = sum / static_cast<double>(samples.size());
  return true;
}

// Both ways round, largest wall first.
std::vector<Line> lines_of(const Mesh& mesh, const CharacteristicSurfaces& found) {
  std::vector<std::uint32_t> walls;
  double whole_m2 = 0.0;
  for (std::uint32_t s = 0; s < found.surfaces.size(); ++s) {
    if (std::abs(found.surfaces[s].normal.z) > upright_sine) continue;
    walls.push_back(s);
    whole_m2 += found.surfaces[s].area_m2;
  }
  std::stable_sort(walls.begin(), walls.end(),
                   [&](auto a, auto b) { return found.surfaces[a].area_m2 > found.surfaces[b].area_m2; });
  std::vector<FaceId> face_of(found.surfaces.size(), none);
  for (FaceId f = 0; f < found.surface_of_face.size(); ++f) {
    if (found.surface_of_face[f] != none) face_of[found.surface_of_face[f]] = f;
  }
  std::vector<Line> lines;
  for (const std::uint32_t s : walls) {
    const CharacteristicSurface& wall = found.surfaces[s];
    if (wall.area_m2 < least_wall_share * whole_m2 || face_of[s] == none) break;
    const glm::dvec2 normal = glm::normalize(glm::dvec2{wall.normal.x, wall.normal.y});
    const glm::vec3& p = mesh.vertices.positions[mesh.indices[3 * std::size_t{face_of[s]}]];
    const double offset_m = glm::dot(normal, glm::dvec2{p.x, p.y});
    const bool known = std::any_of(lines.begin(), lines.end(), [&](const Line& l) {
      const double cosine = glm::dot(l.normal, normal);
      return std::abs(cosine) > same_line_cosine && std::abs(l.offset_m - cosine * offset_m) < same_line_m;
    });
    if (known) continue;
    lines.push_back({normal, offset_m, 0.0});
    if (lines.size() == most_lines) break;
  }
  const std::size_t count = lines.size();
  for (std::size_t i = 0; i < count; ++i) lines.push_back({-lines[i].normal, -lines[i].offset_m, 0.0});
  return lines;
}

std::optional<Cut> best_cut(const std::vector<Line>& lines, const std::vector<Sample>& samples, double floor_m) {
  std::optional<Cut> one;
  std::optional<Cut> two;
  const auto consider = [&](std::optional<Cut>& best, Cut cut) {
    if (measure(samples, floor_m, cut) && (!best || cut.difference < best->difference)) best = std::move(cut);
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    consider(one, {.lines = {lines[i]}});
    for (std::size_t j = i + 1; j < lines.size(); ++j) consider(two, {.lines = {lines[i], lines[j]}});
  }
  return two && (!one || two->difference < (1.0 - second_gain) * one->difference) ? two : one;
}

// Its cells, each point once, and the facets that they make.
class Builder {
 public:
  Builder(const Footprint& footprint, const Cut& cut)
      : footprint_(footprint), cut_(cut), cells_(cut_up(footprint, cut)) {
    for (const auto& cell : cells_.cells()) {
      glm::dvec2 middle{0.0};
      for (const std::uint32_t p : cell) middle += cells_.points()[p] / static_cast<double>(cell.size());
      if (!contains(footprint, middle)) continue;
      const double height_m = cut.is_high(middle) ? cut.high_m : cut.low_m;
      for (std::size_t i = 0; i < cell.size(); ++i) {
        height_[{cell[i], cell[(i + 1) % cell.size()]}] = height_m;
      }
    }
  }

  [[nodiscard]] std::optional<SteppedShape> run() {
    add_level(SteppedFacet::Kind::Bottom, footprint_.low_m, [](double) { return true; });
    add_level(SteppedFacet::Kind::Top, cut_.low_m, [&](double h) { return h == cut_.low_m; });
    add_level(SteppedFacet::Kind::Top, cut_.high_m, [&](double h) { return h == cut_.high_m; });
    add_sides();
    if (torn_) return std::nullopt;
    close_joints();
    return std::move(shape_);
  }

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  // What stands over an edge of the ground, seen from its right.
  struct Wall {
    std::uint32_t from = none, to = none;
    double low_m = 0.0, high_m = 0.0;
  };

  static GroundCells cut_up(const Footprint& footprint, const Cut& cut) {
    glm::dvec2 low = footprint.corners[0];
    glm::dvec2 high = low;
    for (const glm::dvec2& c : footprint.corners) {
      low = glm::min(low, c);
      high = glm::max(high, c);
    }
    low -= margin_m;
    high += margin_m;
    GroundCells cells{{low, glm::dvec2{high.x, low.y}, high, glm::dvec2{low.x, high.y}}};
    for (std::size_t loop = 0, first = 0; loop < footprint.loop_ends.size(); first = footprint.loop_ends[loop++]) {
      for (std::size_t i = first, end = footprint.loop_ends[loop]; i < end; ++i) {
        const glm::dvec2 along = glm::normalize(footprint.corners[i + 1 == end ? first : i + 1] - footprint.corners[i]);
        const glm::dvec2 normal{along.y, -along.x};
        cells.cut({normal, glm::dot(normal, footprint.corners[i]), 0.0});
      }
    }
    for (const Line& line : cut.lines) cells.cut(line);
    return cells;
  }

  [[nodiscard]] glm::dvec2 at(std::uint32_t p) const { return cells_.points()[p]; }
  [[nodiscard]] bool straight(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const glm::dvec2 before = at(b) - at(a);
    const glm::dvec2 after = at(c) - at(b);
    return glm::dot(before, after) > 0.0 &&
           std::abs(cross(before, after)) < 1e-6 * glm::length(before) * glm::length(after);
  }
  std::uint32_t corner(std::uint32_t p, double z) {
    const auto [known, added] = corner_.try_emplace({p, z}, static_cast<std::uint32_t>(shape_.corners.size()));
    if (added) shape_.corners.emplace_back(at(p).x, at(p).y, z);
    return known->second;
  }

  // The loops around the cells of these heights, each a facet of its own with the holes in it.
  template <class Wanted>
  void add_level(SteppedFacet::Kind kind, double z, Wanted wanted) {
    std::set<Edge> edges;
    for (const auto& [edge, height_m] : height_) {
      if (wanted(height_m)) edges.insert(edge);
    }
    std::vector<std::vector<std::uint32_t>> loops;
    for (const auto& loop : outlines_of(edges)) loops.push_back(straightened(loop));
    add_facets(kind, z, loops);
  }

  [[nodiscard]] std::vector<std::uint32_t> straightened(const std::vector<std::uint32_t>& loop) const {
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (!straight(loop[(i + loop.size() - 1) % loop.size()], loop[i], loop[(i + 1) % loop.size()]))
        corners.push_back(loop[i]);
    }
    return corners;
  }

  [[nodiscard]] double area_m2(const std::vector<std::uint32_t>& loop) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) sum += cross(at(loop[i]), at(loop[(i + 1) % loop.size()]));
    return 0.5 * sum;
  }

  // A level of several pieces with holes would have to be sorted out: there is none then.
  void add_facets(SteppedFacet::Kind kind, double z, const std::vector<std::vector<std::uint32_t>>& loops) {
    const auto outer = std::count_if(loops.begin(), loops.end(), [&](const auto& l) { return area_m2(l) > 0.0; });
    torn_ = torn_ || outer == 0 || (outer > 1 && static_cast<std::size_t>(outer) < loops.size());
    if (torn_) return;
    const auto add = [&](SteppedFacet& facet, const std::vector<std::uint32_t>& loop) {
      for (const std::uint32_t p : loop) facet.corners.push_back(corner(p, z));
      facet.loop_ends.push_back(static_cast<std::uint32_t>(facet.corners.size()));
    };
    for (const auto& loop : loops) {
      if (area_m2(loop) <= 0.0) continue;
      SteppedFacet facet{.kind = kind, .corners = {}, .loop_ends = {}};
      add(facet, loop);
      for (const auto& hole : loops) {
        if (area_m2(hole) <= 0.0) add(facet, hole);
      }
      shape_.facets.push_back(std::move(facet));
    }
  }

  // What is left and right of an edge differs in height: walls that lie in one line and touch are one facet.
  void add_sides() {
    std::map<Edge, Wall> walls;
    for (const auto& [edge, height_m] : height_) {
      const auto across = height_.find({edge.second, edge.first});
      const double other_m = across == height_.end() ? footprint_.low_m : across->second;
      if (height_m > other_m) walls[edge] = {edge.first, edge.second, other_m, height_m};
    }
    while (!walls.empty()) {
      std::vector<Wall> row{walls.begin()->second};
      walls.erase(walls.begin());
      for (bool grown = true; grown;) {
        grown = false;
        for (auto w = walls.begin(); w != walls.end() && !grown; ++w) {
          const bool after = w->second.from == row.back().to && touch(row.back(), w->second) &&
                             straight(row.back().from, row.back().to, w->second.to);
          const bool before = w->second.to == row.front().from && touch(row.front(), w->second) &&
                              straight(w->second.from, row.front().from, row.front().to);
          if (!after && !before) continue;
          row.insert(after ? row.end() : row.begin(), w->second);
          walls.erase(w);
          grown = true;
          break;
        }
      }
      add_side(row);
    }
  }
  static bool touch(const Wall& a, const Wall& b) { return a.low_m < b.high_m && b.low_m < a.high_m; }

  void add_side(const std::vector<Wall>& row) {
    SteppedFacet facet;
    const auto add = [&](std::uint32_t p, double z) { facet.corners.push_back(corner(p, z)); };
    add(row.front().from, row.front().low_m);
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      if (row[i].low_m == row[i + 1].low_m) continue;
      add(row[i].to, row[i].low_m);
      add(row[i].to, row[i + 1].low_m);
    }
    add(row.back().to, row.back().low_m);
    add(row.back().to, row.back().high_m);
    for (std::size_t i = row.size() - 1; i > 0; --i) {
      if (row[i].high_m == row[i - 1].high_m) continue;
      add(row[i].from, row[i].high_m);
      add(row[i].from, row[i - 1].high_m);
    }
    add(row.front().from, row.front().high_m);
    facet.loop_ends.push_back(static_cast<std::uint32_t>(facet.corners.size()));
    shape_.facets.push_back(std::move(facet));
  }

  // Corners of others that lie on a side become corners.
  void close_joints() {
    for (SteppedFacet& facet : shape_.facets) {
      std::vector<std::uint32_t> corners;
      std::vector<std::uint32_t> ends;
      for (std::size_t loop = 0, first = 0; loop < facet.loop_ends.size(); first = facet.loop_ends[loop++]) {
        for (std::size_t i = first, end = facet.loop_ends[loop]; i < end; ++i) {
          corners.push_back(facet.corners[i]);
          for (const std::uint32_t c : between(facet.corners[i], facet.corners[i + 1 == end ? first : i + 1]))
            corners.push_back(c);
        }
        ends.push_back(static_cast<std::uint32_t>(corners.size()));
      }
      facet.corners = std::move(corners);
      facet.loop_ends = std::move(ends);
    }
  }

  // In the order of the way from a to b.
  [[nodiscard]] std::vector<std::uint32_t> between(std::uint32_t a, std::uint32_t b) const {
    const glm::dvec3 from = shape_.corners[a];
    const glm::dvec3 way = shape_.corners[b] - from;
    const double length2 = glm::dot(way, way);
    std::vector<std::pair<double, std::uint32_t>> found;
    for (std::uint32_t c = 0; c < shape_.corners.size(); ++c) {
      const glm::dvec3 there = shape_.corners[c] - from;
      const double t = glm::dot(there, way) / length2;
      if (c == a || c == b || t <= 0.0 || t >= 1.0) continue;
      if (glm::length(there - t * way) < 1e-6) found.emplace_back(t, c);
    }
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> corners;
    corners.reserve(found.size());
    for (const auto& [t, c] : found) corners.push_back(c);
    return corners;
  }

  const Footprint& footprint_;
  const Cut& cut_;
  GroundCells cells_;
  std::map<Edge, double> height_;  // of the cell to the left of each edge
  std::map<std::pair<std::uint32_t, double>, std::uint32_t> corner_;
  SteppedShape shape_;
  bool torn_ = false;
};

}  // namespace

std::optional<SteppedShape> find_step(const Mesh& mesh, const CharacteristicSurfaces& surfaces,
                                      const Footprint& footprint) {
  const std::vector<Sample> samples = heights_inside(HeightRaster{mesh}.above(lowest_ratio), footprint);
  if (samples.empty()) return std::nullopt;
  double prism = 0.0;
  for (const Sample& s : samples)
    prism += std::abs(s.height_m - footprint.high_m) / static_cast<double>(samples.size());
  const auto cut = best_cut(lines_of(mesh, surfaces), samples, footprint.low_m);
  if (!cut || cut->difference > (1.0 - least_gain) * prism) return std::nullopt;
  return Builder{footprint, *cut}.run();
}

}  // namespace lodestone::facets
