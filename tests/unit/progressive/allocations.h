// SPDX-License-Identifier: MIT
// Counts every operator new of the test program.
#pragma once

#include <cstddef>

namespace lodestone::test {

[[nodiscard]] std::size_t allocation_count() noexcept;

}  // namespace lodestone::test
