// SPDX-License-Identifier: MIT
// Independent jobs on a few threads; the first failure ends them.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/result.h>

namespace lodestone {

[[nodiscard]] inline unsigned workers_of(const Context& context) {
  return context.max_workers > 0 ? context.max_workers : std::max(1U, std::thread::hardware_concurrency());
}

// Calls job(i) for each i in [0, count), in order of i as threads become free. Of several errors the one with the
// lowest i is returned, of those met.
template <class Job>
[[nodiscard]] Status run_jobs(std::size_t count, unsigned workers, const Context& context, Job job) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  std::size_t failed_at = count;
  Error failure;
  std::exception_ptr exception;
  const auto work = [&] {
    for (std::size_t i = next++; i < count && !stopped && !context.cancelled(); i = next++) {
      try {
        Status status = job(i);
        if (status) continue;
        const std::scoped_lock lock{mutex};
        if (i < failed_at) {
          failed_at = i;
          failure = status.error();
        }
      } catch (...) {  // memory that ran out goes on to the caller's thread
        const std::scoped_lock lock{mutex};
        exception = std::current_exception();
      }
      stopped = true;
    }
  };
  const auto extra = static_cast<unsigned>(std::min<std::size_t>(workers, count));
  std::vector<std::jthread> threads;
  try {
    for (unsigned t = 1; t < extra; ++t) threads.emplace_back(work);
  } catch (const std::system_error&) {  // no room for another stack: fewer do as well
  }
  work();
  threads.clear();
  if (exception) std::rethrow_exception(exception);
  if (failed_at < count) return failure;
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "writing was cancelled", ""};
  return Done{};
}

}  // namespace lodestone
