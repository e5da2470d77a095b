// SPDX-License-Identifier: MIT
#include "count_allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace lodestone::cli {
namespace {

std::atomic<std::uint64_t> allocations{0};

void* counted_or_null(std::size_t bytes) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return std::malloc(bytes == 0 ? 1 : bytes);
}

void* counted(std::size_t bytes) {
  if (void* memory = counted_or_null(bytes)) return memory;
  throw std::bad_alloc{};
}

void* counted(std::size_t bytes, std::align_val_t alignment) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  const auto boundary = static_cast<std::size_t>(alignment);
  const std::size_t rounded = (bytes + boundary - 1) / boundary * boundary;
  if (void* memory = std::aligned_alloc(boundary, rounded)) return memory;
  throw std::bad_alloc{};
}

}  // namespace

std::uint64_t allocation_count() noexcept { return allocations.load(std::memory_order_relaxed); }

}  // namespace lodestone::cli

// Every form, so that none is left to a sanitizer, which would take the pair for a mismatch. The array forms of the
// standard library end in these, those of a sanitizer do not.
void* operator new(std::size_t bytes) { return lodestone::cli::counted(bytes); }
void* operator new[](std::size_t bytes) { return lodestone::cli::counted(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) { return lodestone::cli::counted(bytes, alignment); }
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return lodestone::cli::counted(bytes, alignment);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept { return lodestone::cli::counted_or_null(bytes); }
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return lodestone::cli::counted_or_null(bytes);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
