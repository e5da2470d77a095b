// SPDX-License-Identifier: MIT
// Hashes of small values, and the one way of finding equal elements of an array: flat open addressing, ids in order
// of first appearance, so that nothing depends on the order of a table.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

namespace lodestone {

// Finaliser of SplitMix64: every input bit reaches every output bit.
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t x) noexcept {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

[[nodiscard]] constexpr std::uint64_t hash_combine(std::uint64_t seed, std::uint64_t value) noexcept {
  return mix64(seed * 0x9e3779b97f4a7c15ULL + value);
}

// The bits that identify a coordinate: -0 is taken as 0.
[[nodiscard]] inline std::uint32_t coordinate_bits(float x) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return bits == 0x80000000U ? 0U : bits;
}

[[nodiscard]] inline std::uint64_t position_hash(const glm::vec3& p) noexcept {
  const std::uint64_t xy = std::uint64_t{coordinate_bits(p.x)} << 32U | coordinate_bits(p.y);
  return mix64(xy * 0x9e3779b97f4a7c15ULL ^ (coordinate_bits(p.z) * 0xc2b2ae3d27d4eb4fULL));
}

[[nodiscard]] inline bool same_position(const glm::vec3& a, const glm::vec3& b) noexcept {
  return coordinate_bits(a.x) == coordinate_bits(b.x) && coordinate_bits(a.y) == coordinate_bits(b.y) &&
         coordinate_bits(a.z) == coordinate_bits(b.z);
}

// Classes of equal elements.
struct UniqueIds {
  std::vector<std::uint32_t> id_of;  // per element: its class, numbered by first appearance
  std::vector<std::uint32_t> first;  // per class: the first element of it
};

// A place in the table below: a class, and 32 more hash bits so that most probes never touch the elements.
struct UniqueSlot {
  static constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t id = empty;
  std::uint32_t tag = 0;
};

// `hash(i)` gives 64 well-mixed bits, `equal(i, j)` tells whether elements i and j are the same. O(count) expected.
template <class Hash, class Equal>
[[nodiscard]] UniqueIds unique_ids(std::uint32_t count, Hash hash, Equal equal) {
  UniqueIds result;
  result.id_of.resize(count);
  const std::size_t capacity = std::bit_ceil(std::size_t{count} + count / 2 + 8);
  const std::size_t mask = capacity - 1;
  std::vector<UniqueSlot> table(capacity);
  // Hashes are made some elements ahead, so that their places in the table are on the way from memory meanwhile.
  constexpr std::uint32_t ahead = 16;
  std::array<std::uint64_t, ahead> hashes{};
  for (std::uint32_t i = 0; i < std::min(ahead, count); ++i) hashes[i] = hash(i);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t h = hashes[i % ahead];
    if (count - i > ahead) {
      hashes[i % ahead] = hash(i + ahead);
      __builtin_prefetch(&table[hashes[i % ahead] & mask]);
    }
    const auto tag = static_cast<std::uint32_t>(h >> 32U);
    std::size_t at = h & mask;
    while (table[at].id != UniqueSlot::empty && !(table[at].tag == tag && equal(result.first[table[at].id], i))) {
      at = (at + 1) & mask;
    }
    if (table[at].id == UniqueSlot::empty) {
      table[at] = {static_cast<std::uint32_t>(result.first.size()), tag};
      result.first.push_back(i);
    }
    result.id_of[i] = table[at].id;
  }
  return result;
}

}  // namespace lodestone
