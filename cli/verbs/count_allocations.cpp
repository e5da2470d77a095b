// SPDX-License-Identifier: MIT
#include "count_allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace lodestone::cli {
namespace {

std::atomic<std::uint64_t> allocations{0};

void* counted(std::size_t bytes) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
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

// The array and nothrow forms of the standard library end in these.
void* operator new(std::size_t bytes) { return lodestone::cli::counted(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) { return lodestone::cli::counted(bytes, alignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
