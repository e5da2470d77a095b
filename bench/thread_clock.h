// SPDX-License-Identifier: MIT
// Processor time of the calling thread: what a busy machine disturbs least.
#pragma once

#include <time.h>

namespace lodestone {

[[nodiscard]] inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace lodestone
