// SPDX-License-Identifier: MIT
// Processor time: what a busy machine disturbs least.
#pragma once

#include <time.h>

namespace lodestone {

[[nodiscard]] inline double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

[[nodiscard]] inline double thread_seconds() { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }
[[nodiscard]] inline double processor_seconds() { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }  // of all threads

}  // namespace lodestone
