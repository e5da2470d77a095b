// SPDX-License-Identifier: MIT
// Which blocks of an array changed since they were last looked at. Marking is one byte store; ranges are gathered only
// when asked for, into memory given at construction.
#pragma once

#include <cstdint>
#include <span>

#include <lodestone/types.h>

namespace lodestone::progressive {

class DirtyMap {
 public:
  DirtyMap() = default;
  // `marks` holds block_count(elements) bytes, `ranges` range_count(elements) elements; both outlive this.
  DirtyMap(std::uint32_t elements, unsigned shift, std::uint8_t* marks, Range* ranges) noexcept
      : marks_(marks), ranges_(ranges), elements_(elements), shift_(shift) {
    mark(0, elements);
  }

  [[nodiscard]] static std::size_t block_count(std::uint32_t elements, unsigned shift) noexcept {
    return (elements + (std::size_t{1} << shift) - 1) >> shift;
  }
  [[nodiscard]] static std::size_t range_count(std::uint32_t elements, unsigned shift) noexcept {
    return (block_count(elements, shift) + 1) / 2;
  }

  // For inner loops: set marks()[element >> shift()] to 1.
  [[nodiscard]] std::uint8_t* marks() const noexcept { return marks_; }
  [[nodiscard]] unsigned shift() const noexcept { return shift_; }

  void mark(std::uint32_t element) noexcept { marks_[element >> shift_] = 1; }
  void mark(std::uint32_t begin, std::uint32_t end) noexcept;
  void clear() noexcept;
  // Sorted, disjoint, cut at the end of the array.
  [[nodiscard]] std::span<const Range> ranges() noexcept;

 private:
  std::uint8_t* marks_ = nullptr;
  Range* ranges_ = nullptr;
  std::uint32_t elements_ = 0;
  unsigned shift_ = 0;
};

}  // namespace lodestone::progressive
