// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019, sections 2.1 (types of walls and roofs), 2.3 and 3.2 (bulge and depression, datum plane and
// distances of a parallel family).
// Differs: a side is whatever stands between two planes of a family and touches both, so that sides need be neither
// perpendicular nor whole; what is said of a wall is said of all surfaces of one direction near each other, because the
// windows of surveyed models stand loose in it.
#include <lodestone/facet_shift.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "mesh/edges.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

constexpr double level_cosine = 0.9962;    // flatter than 5 degrees
constexpr double steep_cosine = 0.7072;    // steeper than 45 degrees
constexpr double least_spire_share = 0.5;  // of a roof's area that leads up to one point
constexpr std::uint32_t least_spire_sides = 3;
constexpr double top_m = 0.01;

class Grapher {
 public:
  Grapher(const Mesh& mesh, const FacetGraphOptions& options)
      : mesh_(mesh), options_(options), weld_(weld_by_position(mesh.vertices.positions)) {
    graph_.surfaces = characteristic_surfaces(mesh, options.tolerance);
  }

  FacetGraph run() {
    find_points();
    find_directions();
    find_neighbours();
    find_families();
    find_steps();
    find_roofs();
    return std::move(graph_);
  }

 private:
  using Ids = std::vector<std::uint32_t>;

  [[nodiscard]] const std::vector<CharacteristicSurface>& surfaces() const { return graph_.surfaces.surfaces; }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(surfaces().size()); }
  [[nodiscard]] glm::dvec3 at(std::uint32_t point) const {
    return glm::dvec3{mesh_.vertices.positions[weld_.first_vertex[point]]};
  }

  static void make_set(Ids& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  }

  void find_points() {
    points_.resize(count());
    for (std::size_t c = 0; c < mesh_.indices.size(); ++c) {
      const std::uint32_t s = graph_.surfaces.surface_of_face[c / 3];
      if (s != none) points_[s].push_back(weld_.point_of[mesh_.indices[c]]);
    }
    for (Ids& points : points_) make_set(points);
  }

  // The directions of the larger surfaces, each led by the largest of it; the others have none.
  void find_directions() {
    double whole = 0.0;
    for (const CharacteristicSurface& s : surfaces()) whole += s.area_m2;
    for (std::uint32_t s = 0; s < count(); ++s) {
      if (surfaces()[s].area_m2 >= options_.least_area_ratio * whole) by_area_.push_back(s);
    }
    std::stable_sort(by_area_.begin(), by_area_.end(),
                     [&](auto a, auto b) { return surfaces()[a].area_m2 > surfaces()[b].area_m2; });
    direction_of_.assign(count(), none);
    const double least_cosine = std::cos(options_.tolerance.angle_rad);
    for (const std::uint32_t s : by_area_) {
      const auto found = std::find_if(directions_.begin(), directions_.end(), [&](const glm::dvec3& d) {
        return glm::dot(d, surfaces()[s].normal) >= least_cosine;
      });
      direction_of_[s] = static_cast<std::uint32_t>(found - directions_.begin());
      if (found == directions_.end()) directions_.push_back(surfaces()[s].normal);
    }
  }

  void find_neighbours() {
    neighbours_.resize(count());
    const EdgeTable edges = find_edges(mesh_, weld_);
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      const auto uses = edges.uses_of(e);
      for (const EdgeUse& a : uses) {
        for (const EdgeUse& b : uses) {
          const std::uint32_t s = graph_.surfaces.surface_of_face[a.corner / 3];
          const std::uint32_t t = graph_.surfaces.surface_of_face[b.corner / 3];
          if (s != t && s != none && t != none) neighbours_[s].push_back(t);
        }
      }
    }
    for (Ids& ids : neighbours_) make_set(ids);
  }

  // Where a surface lies along a direction: its own points say so better than its own, slightly turned, normal.
  [[nodiscard]] std::pair<double, double> extent_m(std::uint32_t surface, const glm::dvec3& along) const {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const std::uint32_t p : points_[surface]) {
      low = std::min(low, glm::dot(along, at(p)));
      high = std::max(high, glm::dot(along, at(p)));
    }
    return {low, high};
  }
  [[nodiscard]] double height_m(std::uint32_t surface, const glm::dvec3& along) const {
    const auto [low, high] = extent_m(surface, along);
    return 0.5 * (low + high);
  }

  void find_families() {
    std::vector<Ids> members(directions_.size());
    for (const std::uint32_t s : by_area_) members[direction_of_[s]].push_back(s);
    for (std::size_t d = 0; d < members.size(); ++d) {
      std::vector<std::pair<double, std::uint32_t>> order;
      for (const std::uint32_t s : members[d]) order.emplace_back(height_m(s, directions_[d]), s);
      std::sort(order.begin(), order.end());
      for (std::size_t first = 0; first < order.size();) {
        std::size_t end = first + 1;
        while (end < order.size() && order[end].first - order[end - 1].first <= options_.family_gap_m) ++end;
        add_family(
            {order.begin() + static_cast<std::ptrdiff_t>(first), order.begin() + static_cast<std::ptrdiff_t>(end)});
        first = end;
      }
    }
    std::stable_sort(graph_.families.begin(), graph_.families.end(), [&](const FacetFamily& a, const FacetFamily& b) {
      return surfaces()[a.datum].area_m2 > surfaces()[b.datum].area_m2;
    });
  }

  void add_family(const std::vector<std::pair<double, std::uint32_t>>& members) {
    FacetFamily family;
    double datum_height_m = 0.0;
    for (const auto& [height, s] : members) {
      if (family.datum != none && surfaces()[s].area_m2 <= surfaces()[family.datum].area_m2) continue;
      family.datum = s;
      datum_height_m = height;
    }
    family.kind = surfaces()[family.datum].kind;
    bool before = false;
    bool behind = false;
    for (const auto& [height, s] : members) {
      family.surfaces.push_back(s);
      family.distance_m.push_back(height - datum_height_m);
      before = before || height - datum_height_m > flat_m();
      behind = behind || height - datum_height_m < -flat_m();
    }
    if (before || behind) family.wall = before && behind ? WallType::UnevenBothSides : WallType::UnevenOneSide;
    graph_.families.push_back(std::move(family));
  }

  // Two surfaces nearer than this lie in one plane.
  [[nodiscard]] double flat_m() const { return 2.0 * options_.tolerance.offset_m; }

  void find_steps() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, FacetStep> steps;
    for (std::uint32_t side = 0; side < count(); ++side) {
      Ids directions;
      for (const std::uint32_t s : neighbours_[side]) {
        if (direction_of_[s] != none && direction_of_[s] != direction_of_[side]) directions.push_back(direction_of_[s]);
      }
      make_set(directions);
      for (const std::uint32_t d : directions) add_steps(side, d, steps);
    }
    for (auto& [ends, step] : steps) graph_.steps.push_back(std::move(step));
  }

  // A side reaches from one plane to the other and no farther.
  void add_steps(std::uint32_t side, std::uint32_t direction,
                 std::map<std::pair<std::uint32_t, std::uint32_t>, FacetStep>& steps) const {
    const glm::dvec3& along = directions_[direction];
    const auto [low, high] = extent_m(side, along);
    if (high - low <= flat_m()) return;
    Ids inner, outer;
    for (const std::uint32_t s : neighbours_[side]) {
      if (direction_of_[s] != direction) continue;
      const double height = height_m(s, along);
      if (std::abs(height - low) <= flat_m()) inner.push_back(s);
      if (std::abs(height - high) <= flat_m()) outer.push_back(s);
    }
    for (const std::uint32_t a : inner) {
      for (const std::uint32_t b : outer) {
        const bool sinks = surfaces()[b].area_m2 <= surfaces()[a].area_m2;
        const std::uint32_t lesser = sinks ? b : a;
        const std::uint32_t greater = sinks ? a : b;
        FacetStep& step = steps[{lesser, greater}];
        step.lesser = lesser;
        step.greater = greater;
        step.height_m = sinks ? high - low : low - high;
        step.sides.push_back(side);
      }
    }
  }

  void find_roofs() {
    const auto is_roof = [&](std::uint32_t s) {
      return direction_of_[s] != none && surfaces()[s].kind == SurfaceClass::Roof;
    };
    DisjointSets sets{count()};
    for (std::uint32_t s = 0; s < count(); ++s) {
      for (const std::uint32_t t : neighbours_[s]) {
        if (is_roof(s) && is_roof(t)) sets.join(s, t);
      }
    }
    std::map<std::uint32_t, RoofPart> parts;
    for (std::uint32_t s = 0; s < count(); ++s) {
      if (is_roof(s)) parts[sets.find(s)].surfaces.push_back(s);
    }
    for (auto& [root, part] : parts) {
      double level = 0.0;
      for (const std::uint32_t s : part.surfaces) {
        const CharacteristicSurface& surface = surfaces()[s];
        part.area_m2 += surface.area_m2;
        part.pitch_rad += surface.area_m2 * std::acos(std::clamp(surface.normal.z, -1.0, 1.0));
        level += surface.normal.z > level_cosine ? surface.area_m2 : 0.0;
      }
      part.pitch_rad /= part.area_m2;
      part.type = 2.0 * level > part.area_m2 ? RoofType::Flat : is_spire(part) ? RoofType::Spire : RoofType::Sloped;
      graph_.roofs.push_back(std::move(part));
    }
    std::stable_sort(graph_.roofs.begin(), graph_.roofs.end(),
                     [](const RoofPart& a, const RoofPart& b) { return a.area_m2 > b.area_m2; });
  }

  // Steep surfaces that share their one highest point.
  [[nodiscard]] bool is_spire(const RoofPart& part) const {
    struct Apex {
      std::uint32_t sides = 0;
      double area_m2 = 0.0;
    };
    std::map<std::uint32_t, Apex> apexes;
    for (const std::uint32_t s : part.surfaces) {
      if (surfaces()[s].normal.z > steep_cosine) continue;
      const auto [low, high] = extent_m(s, {0.0, 0.0, 1.0});
      Ids top;
      for (const std::uint32_t p : points_[s]) {
        if (at(p).z > high - top_m) top.push_back(p);
      }
      if (top.size() != 1) continue;
      Apex& apex = apexes[top.front()];
      ++apex.sides;
      apex.area_m2 += surfaces()[s].area_m2;
    }
    return std::any_of(apexes.begin(), apexes.end(), [&](const auto& entry) {
      return entry.second.sides >= least_spire_sides && entry.second.area_m2 >= least_spire_share * part.area_m2;
    });
  }

  const Mesh& mesh_;
  const FacetGraphOptions& options_;
  Weld weld_;
  FacetGraph graph_;
  std::vector<Ids> points_;             // per surface
  Ids by_area_;                         // the larger surfaces
  std::vector<glm::dvec3> directions_;  // of families
  Ids direction_of_;                    // per surface
  std::vector<Ids> neighbours_;         // per surface: those that share an edge with it
};

}  // namespace

FacetGraph facet_graph(const Mesh& mesh, const FacetGraphOptions& options) { return Grapher{mesh, options}.run(); }

}  // namespace lodestone
