// SPDX-License-Identifier: MIT
// The building's points in a coarse lattice, with the time of the last change in each cell.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "facets/facet_mesh.h"
#include "facets/float_box.h"

namespace lodestone::facets {

class PointCells {
 public:
  explicit PointCells(const FacetMesh& mesh);

  // Says which faces have changed since the last call.
  void update(const std::vector<FaceId>& changed);
  [[nodiscard]] std::uint64_t last_change(const FloatBox& box) const;

  // Calls visit(point) for all points that were in the box at the last update.
  template <class Visit>
  void visit_points(const FloatBox& box, Visit visit) const {
    visit_cells(box, [&](std::size_t cell) {
      for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        if (box.contains(at_[i])) visit(points_[i]);
      }
    });
  }

 private:
  template <class Visit>
  void visit_cells(const FloatBox& box, Visit visit) const {
    const glm::ivec3 low = cell_of(box.low);
    const glm::ivec3 high = cell_of(box.high);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) visit(index_of({x, y, z}));
      }
    }
  }
  [[nodiscard]] glm::ivec3 cell_of(const glm::vec3& p) const noexcept {
    return glm::clamp(glm::ivec3{(glm::clamp(p, low_, high_) - low_) * scale_}, glm::ivec3{0}, count_ - 1);
  }
  [[nodiscard]] std::size_t index_of(const glm::ivec3& c) const noexcept {
    return (static_cast<std::size_t>(c.z) * static_cast<std::size_t>(count_.y) + static_cast<std::size_t>(c.y)) *
               static_cast<std::size_t>(count_.x) +
           static_cast<std::size_t>(c.x);
  }
  void sort_points();

  const FacetMesh& mesh_;
  glm::vec3 low_{0.0F};
  glm::vec3 high_{0.0F};
  float scale_ = 1.0F;
  glm::ivec3 count_{1};
  std::vector<std::uint32_t> first_;       // per cell and one past the end
  std::vector<std::uint32_t> points_;      // by cell
  std::vector<std::uint32_t> cell_;        // per point that is used
  std::vector<glm::vec3> at_;              // of these, where they were at the last update
  std::vector<std::uint32_t> changed_at_;  // per cell
  std::vector<glm::vec3> seen_at_;         // per point, at the last update
  std::uint32_t now_ = 0;
};

}  // namespace lodestone::facets
