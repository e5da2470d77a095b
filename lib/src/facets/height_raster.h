// SPDX-License-Identifier: MIT
// The building seen from above.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

#include <lodestone/mesh.h>

#include "facets/footprint.h"
#include "facets/ground_cells.h"

namespace lodestone::facets {

inline constexpr double lowest_ratio = 0.2;  // of the height: lower is the ground

// The highest face over each cell of the ground.
class HeightRaster {
 public:
  explicit HeightRaster(const Mesh& mesh) {
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
  [[nodiscard]] HeightRaster above(double ground_ratio) const {
    HeightRaster raster = *this;
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
  static constexpr int raster_cells = 192;   // along the longer side
  static constexpr double high_share = 0.8;  // so much of the ground is covered lower than what counts as high

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

}  // namespace lodestone::facets
