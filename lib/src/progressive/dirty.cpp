// SPDX-License-Identifier: MIT
#include "progressive/dirty.h"

#include <algorithm>
#include <cstring>

namespace lodestone::progressive {

void DirtyMap::mark(std::uint32_t begin, std::uint32_t end) noexcept {
  if (begin >= end) return;
  const std::size_t first = begin >> shift_;
  std::memset(marks_ + first, 1, ((end - 1) >> shift_) - first + 1);
}

void DirtyMap::clear() noexcept { std::fill_n(marks_, block_count(elements_, shift_), std::uint8_t{0}); }

std::span<const Range> DirtyMap::ranges() noexcept {
  const std::size_t blocks = block_count(elements_, shift_);
  std::size_t count = 0;
  const auto next = [&](std::size_t from, std::uint8_t mark) -> std::size_t {
    const void* found = from < blocks ? std::memchr(marks_ + from, mark, blocks - from) : nullptr;
    return found == nullptr ? blocks : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - marks_);
  };
  for (std::size_t begin = next(0, 1); begin < blocks;) {
    const std::size_t end = next(begin, 0);
    const std::size_t last = std::min<std::size_t>(end << shift_, elements_);
    ranges_[count++] = {static_cast<std::uint32_t>(begin << shift_), static_cast<std::uint32_t>(last)};
    begin = next(end, 1);
  }
  return {ranges_, count};
}

}  // namespace lodestone::progressive
