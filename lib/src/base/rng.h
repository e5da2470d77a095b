// SPDX-License-Identifier: MIT
// Based on: Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators" (SplitMix64).
// Differs: streams are told apart by hashing (seed, stream), so that work item i has its own numbers whatever thread
// runs it. The standard library's distributions differ between platforms; these do not.
#pragma once

#include <cstdint>

#include "base/hash.h"

namespace lodestone {

class Rng {
 public:
  explicit constexpr Rng(std::uint64_t seed, std::uint64_t stream = 0) noexcept : state_(hash_combine(seed, stream)) {}

  [[nodiscard]] constexpr std::uint64_t next() noexcept {
    state_ += 0x9e3779b97f4a7c15ULL;
    return mix64(state_);
  }

  // Uniform in [0, 1).
  [[nodiscard]] constexpr double unit() noexcept { return static_cast<double>(next() >> 11U) * 0x1p-53; }

  // Uniform in [low, high).
  [[nodiscard]] constexpr double uniform(double low, double high) noexcept { return low + (high - low) * unit(); }

  // Uniform in 0..count-1; precondition: count > 0. Bias below count / 2^32.
  [[nodiscard]] constexpr std::uint32_t below(std::uint32_t count) noexcept {
    return static_cast<std::uint32_t>(((next() >> 32U) * count) >> 32U);
  }

 private:
  std::uint64_t state_;
};

}  // namespace lodestone
