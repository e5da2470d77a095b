// SPDX-License-Identifier: MIT
// oneTBB behind a Context: at most Context::max_workers threads, stops soon after Context::cancel is raised.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <optional>

#include <lodestone/context.h>

#if defined(__SANITIZE_THREAD__)
#include <atomic>
#include <thread>
#include <vector>
#endif

namespace lodestone {

// Number of threads that parallel_chunks() will use.
[[nodiscard]] inline int worker_count(const Context& context) {
  const int cores = tbb::this_task_arena::max_concurrency();
  return context.max_workers == 0 ? cores : static_cast<int>(context.max_workers);
}

// Calls work() where parallel loops may use so many threads. Those inside of it that are told 0 workers stay there.
template <class Work>
void with_workers(unsigned workers, Work work) {
  if (workers == 0) return work();
  // More threads than cores need a licence, or the scheduler complains on stderr.
  std::optional<tbb::global_control> licence;
  if (static_cast<int>(workers) > tbb::this_task_arena::max_concurrency()) {
    licence.emplace(tbb::global_control::max_allowed_parallelism, std::size_t{workers});
  }
  tbb::task_arena arena{static_cast<int>(workers)};
  arena.execute(work);
}

// Calls work(begin, end) for consecutive chunks of [0, count), each of `chunk` elements but the last. Chunks do not
// depend on the number of threads, so a reduction over their results in order gives the same bits always. Chunks not
// yet begun are left out when the context is cancelled: ask context.cancelled() afterwards.
template <class Work>
void parallel_chunks(std::size_t count, std::size_t chunk, const Context& context, Work work) {
  const std::size_t chunks = (count + chunk - 1) / chunk;
  const auto run = [&](std::size_t i) {
    if (!context.cancelled()) work(i * chunk, std::min(count, (i + 1) * chunk));
  };
  if (worker_count(context) == 1 || chunks <= 1) {
    for (std::size_t i = 0; i < chunks; ++i) run(i);
    return;
  }
#if defined(__SANITIZE_THREAD__)  // cannot see into the scheduler, which is built without it: threads take its place
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < worker_count(context); ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < chunks; i = next++) run(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
#else
  with_workers(context.max_workers, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>{0, chunks, 1}, [&](const tbb::blocked_range<std::size_t>& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) run(i);
    });
  });
#endif
}

// Calls first(context) and second(context), at the same time where there are workers for it; each gets the context that
// shares them. Threads that wait inside `first`, the longer one, do not turn to the other.
template <class First, class Second>
void parallel_both(const Context& context, First first, Second second) {
  if (worker_count(context) == 1) {
    first(context);
    second(context);
    return;
  }
  Context shared = context;
  shared.max_workers = 0;
#if defined(__SANITIZE_THREAD__)
  std::thread beside{[&] { second(shared); }};
  first(shared);
  beside.join();
#else
  with_workers(context.max_workers, [&] {
    tbb::parallel_invoke([&] { tbb::this_task_arena::isolate([&] { first(shared); }); }, [&] { second(shared); });
  });
#endif
}

// Calls work(i) for each i in [0, count), `chunk` of them at a time on one thread.
template <class Work>
void parallel_for_each(std::size_t count, std::size_t chunk, const Context& context, Work work) {
  parallel_chunks(count, chunk, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) work(i);
  });
}

}  // namespace lodestone
