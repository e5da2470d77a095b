// SPDX-License-Identifier: MIT
// Walking around a triangle: corner c of face f is 3 f + c.
#pragma once

#include <lodestone/types.h>

namespace lodestone {

[[nodiscard]] constexpr CornerId next_corner(CornerId corner) noexcept {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}
[[nodiscard]] constexpr CornerId previous_corner(CornerId corner) noexcept {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}

}  // namespace lodestone
