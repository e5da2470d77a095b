// SPDX-License-Identifier: MIT
// The ground, cut along lines.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <lodestone/types.h>

namespace lodestone::facets {

[[nodiscard]] inline double cross(const glm::dvec2& a, const glm::dvec2& b) noexcept { return a.x * b.y - a.y * b.x; }

struct Line {
  glm::dvec2 normal{0.0};
  double offset_m = 0.0;
  double weight = 0.0;

  [[nodiscard]] double distance(const glm::dvec2& p) const { return glm::dot(normal, p) - offset_m; }
};

// A rectangle cut by lines. Each line cuts all cells, so neighbours share whole edges.
class GroundCells {
 public:
  explicit GroundCells(const std::array<glm::dvec2, 4>& rectangle) : points_(rectangle.begin(), rectangle.end()) {
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

  [[nodiscard]] const std::vector<glm::dvec2>& points() const noexcept { return points_; }
  // Convex, turning left.
  [[nodiscard]] const std::vector<std::vector<std::uint32_t>>& cells() const noexcept { return cells_; }

 private:
  std::vector<glm::dvec2> points_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

// The outlines of some cells, given by all edges of these, each with its cell to the left: simple loops of points, the
// cells to the left. Empty if two of them touch in a point.
[[nodiscard]] inline std::vector<std::vector<std::uint32_t>> outlines_of(
    const std::set<std::pair<std::uint32_t, std::uint32_t>>& edges) {
  std::map<std::uint32_t, std::uint32_t> next;
  for (const auto& [from, to] : edges) {
    if (!edges.contains({to, from}) && !next.emplace(from, to).second) return {};
  }
  std::vector<std::vector<std::uint32_t>> loops;
  while (!next.empty()) {
    std::vector<std::uint32_t> loop;
    for (auto at = next.begin(); at != next.end();) {
      loop.push_back(at->first);
      const std::uint32_t to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace lodestone::facets
