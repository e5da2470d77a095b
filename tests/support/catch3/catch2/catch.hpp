// SPDX-License-Identifier: MIT
// Catch2 3 under the names of Catch2 2, which the tests are written for. On the include path only where 3 is found.
#pragma once

#include <catch2/catch_all.hpp>

using Catch::Approx;
namespace Catch {
inline auto Contains(const std::string& part) { return Matchers::ContainsSubstring(part); }
}  // namespace Catch
