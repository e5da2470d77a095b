// SPDX-License-Identifier: MIT
// Based on: hierarchical spatial hash grids (Eitz and Gu 2007): each face is kept in one cell of the lattice whose
// cells are as large as the face, so that it costs the same to move one whatever its size.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "facets/facet_mesh.h"

namespace lodestone::facets {

class FaceIndex {
 public:
  // Empty.
  explicit FaceIndex(const FacetMesh& mesh);

  void clear();
  // Where it is now, whether it was in or not.
  void put(FaceId f);
  void take(FaceId f);

  // How many cells or faces a visit would look into.
  [[nodiscard]] double work(const glm::dvec3& low, const glm::dvec3& high) const noexcept {
    double sum = 0.0;
    for (int level = 0; level < level_count; ++level) {
      if (count_[level] != 0) sum += std::min(cells_of(level, low, high).count, static_cast<double>(count_[level]));
    }
    return sum;
  }

  // Calls visit(face) for all live faces whose boxes touch this one, some of them twice; visit returns false to stop.
  template <class Visit>
  void visit(const glm::dvec3& low, const glm::dvec3& high, Visit visit) const {
    for (int level = 0; level < level_count; ++level) {
      if (count_[level] == 0) continue;
      const auto [from, to, cell_count] = cells_of(level, low, high);
      if (cell_count > count_[level]) {
        // There are fewer faces than cells.
        for (FaceId f = first_[level]; f != none; f = links_[f].next_of_level) {
          if (touches(f, low, high) && !visit(f)) return;
        }
        continue;
      }
      for (double z = from.z; z <= to.z; ++z) {
        for (double y = from.y; y <= to.y; ++y) {
          for (double x = from.x; x <= to.x; ++x) {
            for (FaceId f = heads_[bucket_of(level, {x, y, z})]; f != none; f = links_[f].next) {
              if (links_[f].level == level && touches(f, low, high) && !visit(f)) return;
            }
          }
        }
      }
    }
  }

 private:
  static constexpr int level_count = 9;  // cells of 6 cm to 4 km, each four times the one before
  static constexpr std::uint8_t nowhere = 255;
  struct Links {
    FaceId next = none, previous = none;  // in the bucket
    FaceId next_of_level = none, previous_of_level = none;
    std::uint32_t bucket = 0;
    std::uint8_t level = nowhere;
    glm::vec3 low{0.0F}, high{0.0F};
  };
  struct Cells {
    glm::dvec3 from, to;
    double count;
  };
  // Whose faces may touch the box.
  [[nodiscard]] static Cells cells_of(int level, const glm::dvec3& low, const glm::dvec3& high) noexcept {
    const glm::dvec3 from = glm::floor(low / size_of(level) - 0.5);
    const glm::dvec3 to = glm::floor(high / size_of(level) + 0.5);
    const glm::dvec3 counts = to - from + 1.0;
    return {from, to, counts.x * counts.y * counts.z};
  }
  [[nodiscard]] static double size_of(int level) noexcept { return std::ldexp(1.0, 2 * level - 4); }
  [[nodiscard]] std::uint32_t bucket_of(int level, const glm::dvec3& cell) const noexcept;
  [[nodiscard]] bool touches(FaceId f, const glm::dvec3& low, const glm::dvec3& high) const noexcept {
    const Links& l = links_[f];
    return l.low.x <= high.x && l.high.x >= low.x && l.low.y <= high.y && l.high.y >= low.y && l.low.z <= high.z &&
           l.high.z >= low.z;
  }

  const FacetMesh& mesh_;
  std::vector<Links> links_;   // per face
  std::vector<FaceId> heads_;  // per bucket
  std::vector<FaceId> first_;  // per level
  std::vector<std::uint32_t> count_;
};

}  // namespace lodestone::facets
