// SPDX-License-Identifier: MIT
// Faces sorted by the group that they are in, in two arrays that are used again.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/types.h>

namespace lodestone::facets {

class FaceGroups {
 public:
  // Of so many groups; per face its group or none.
  void sort(std::span<const std::uint32_t> group_of, std::uint32_t count) {
    first_.assign(std::size_t{count} + 1, 0);
    for (const std::uint32_t g : group_of) {
      if (g != none) ++first_[g];
    }
    std::uint32_t end = 0;
    for (std::uint32_t& first : first_) first = end += first;
    faces_.resize(end);
    for (auto f = static_cast<FaceId>(group_of.size()); f-- > 0;) {
      if (group_of[f] != none) faces_[--first_[group_of[f]]] = f;
    }
  }
  [[nodiscard]] std::uint32_t size() const noexcept {
    return first_.empty() ? 0 : static_cast<std::uint32_t>(first_.size() - 1);
  }
  // Ascending.
  [[nodiscard]] std::span<const FaceId> operator[](std::uint32_t group) const noexcept {
    return std::span{faces_}.subspan(first_[group], first_[group + 1] - first_[group]);
  }
  // Of all groups, group by group.
  [[nodiscard]] std::span<const FaceId> faces() const noexcept { return faces_; }

 private:
  std::vector<std::uint32_t> first_;  // per group and one past the end
  std::vector<FaceId> faces_;
};

}  // namespace lodestone::facets
