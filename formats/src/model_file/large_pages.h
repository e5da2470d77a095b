// SPDX-License-Identifier: MIT
// Memory for arrays that are read all over: in pages of 2 MB where the system has them (Linux), because looking up the
// places of small pages costs as much as the reads themselves.
#pragma once

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace lodestone::model_file {

template <class T>
struct LargePageAllocator {
  using value_type = T;
  LargePageAllocator() = default;
  template <class Other>
  LargePageAllocator(const LargePageAllocator<Other>& /*other*/) noexcept {}

  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc{};
    const std::size_t bytes = count * sizeof(T);
    const bool large = bytes >= 2 * page_bytes;
    void* memory =
        large ? std::aligned_alloc(page_bytes, (bytes + page_bytes - 1) / page_bytes * page_bytes) : std::malloc(bytes);
    if (memory == nullptr) throw std::bad_alloc{};
#ifdef __linux__
    // Only advice: where it is not taken, pages are small.
    if (large) static_cast<void>(::madvise(memory, bytes, MADV_HUGEPAGE));
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*count*/) noexcept { std::free(memory); }
  friend bool operator==(LargePageAllocator /*a*/, LargePageAllocator /*b*/) noexcept { return true; }

 private:
  static constexpr std::size_t page_bytes = std::size_t{1} << 21U;
};

template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

}  // namespace lodestone::model_file
