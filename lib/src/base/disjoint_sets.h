// SPDX-License-Identifier: MIT
// Based on: Tarjan 1975, union-find; path halving.
// Differs: the smaller id always becomes the root, so that a set is named by its first member.
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace lodestone {

class DisjointSets {
 public:
  explicit DisjointSets(std::uint32_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  [[nodiscard]] std::uint32_t find(std::uint32_t x) noexcept {
    while (parent_[x] != x) {
      parent_[x] = parent_[parent_[x]];
      x = parent_[x];
    }
    return x;
  }

  // Returns false if they were in one set already.
  bool join(std::uint32_t a, std::uint32_t b) noexcept {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    if (b < a) std::swap(a, b);
    parent_[b] = a;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace lodestone
