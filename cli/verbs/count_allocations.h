// SPDX-License-Identifier: MIT
// The program counts its own allocations, so that `play` can show that a cursor makes none.
#pragma once

#include <cstdint>

namespace lodestone::cli {

// Calls of operator new since the program started, on all threads.
[[nodiscard]] std::uint64_t allocation_count() noexcept;

}  // namespace lodestone::cli
