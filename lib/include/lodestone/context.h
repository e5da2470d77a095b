// SPDX-License-Identifier: MIT
/// \file
/// How an embedder watches, stops and limits a long call. Every builder and reader takes an optional Context.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string_view>

namespace lodestone {

/// Thread contract: `cancel` may be raised from any thread (and from a signal handler); `progress` is called from one
/// thread at a time, at most about twenty times a second.
struct Context {
  /// Raise to stop; the call returns ErrorCode::Cancelled soon (within about 50 ms) and leaves nothing behind.
  const std::atomic<bool>* cancel = nullptr;

  /// Called with the stage's name and its share done, 0..1.
  std::function<void(std::string_view stage, double fraction)> progress;

  /// Most worker threads a builder may use; 0 = one per core. The bytes produced do not depend on it.
  unsigned max_workers = 0;

  /// Most bytes that out-of-core stages should hold; 0 = no limit.
  std::size_t max_memory_bytes = 0;

  [[nodiscard]] bool cancelled() const noexcept { return cancel != nullptr && cancel->load(std::memory_order_relaxed); }
  void report(std::string_view stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
};

}  // namespace lodestone
