// SPDX-License-Identifier: MIT
// Based on: LSD radix sort, 11 bits a pass. Stable, so ties keep their order.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace lodestone {

struct Keyed {
  std::uint32_t key = 0;
  std::uint32_t value = 0;
};

// By key, ascending. `T` has a member `key` of 32 bits. O(n).
template <class T>
void radix_sort(std::vector<T>& items) {
  constexpr std::uint32_t bits = 11;
  constexpr std::uint32_t mask = (1U << bits) - 1;
  std::array<std::array<std::uint32_t, 1U << bits>, 3> counts{};
  for (const T& item : items) {
    for (std::uint32_t pass = 0; pass < 3; ++pass) ++counts[pass][(item.key >> (pass * bits)) & mask];
  }
  std::vector<T> other(items.size());
  for (std::uint32_t pass = 0; pass < 3; ++pass) {
    auto& count = counts[pass];
    std::uint32_t sum = 0;
    for (std::uint32_t& n : count) {
      const std::uint32_t here = n;
      n = sum;
      sum += here;
    }
    for (const T& item : items) other[count[(item.key >> (pass * bits)) & mask]++] = item;
    items.swap(other);
  }
}

// By the upper 12 bits of the key only, which for a non-negative float are its exponent and 3 bits of mantissa: steps
// of an eighth. Equal ones keep their order. O(n).
template <class T>
void coarse_sort(std::vector<T>& items) {
  constexpr std::uint32_t shift = 20;
  std::vector<std::uint32_t> at((std::size_t{1} << (32 - shift)) + 1, 0);
  for (const T& item : items) ++at[(item.key >> shift) + 1];
  for (std::size_t i = 1; i < at.size(); ++i) at[i] += at[i - 1];
  std::vector<T> other(items.size());
  for (const T& item : items) other[at[item.key >> shift]++] = item;
  items.swap(other);
}

}  // namespace lodestone
