// SPDX-License-Identifier: MIT
// Inventing the pixels that nobody sees, so that filters that reach for them do no harm.
#pragma once

#include <vector>

#include <lodestone/image.h>

namespace lodestone {

// Gives every pixel that is not `known` (row by row) a smooth mixture of the known ones around it. Without any known
// pixel nothing changes. O(pixels).
void fill_unknown(Image& image, const std::vector<bool>& known);

// Makes the known part `rings` pixels wider (eight neighbours).
void widen(std::vector<bool>& known, std::uint32_t width, std::uint32_t height, int rings);

}  // namespace lodestone
