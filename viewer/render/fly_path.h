// SPDX-License-Identifier: MIT
// A camera that flies over a model, round and round.
#pragma once

#include <lodestone/types.h>
#include <lodestone/view.h>

namespace lodestone::render {

/// Where it is after `turns` rounds (any number, 0.25 = a quarter): on an ellipse above the model's outline, low over
/// one side and high over the other, looking ahead and down. The same place after every whole round.
[[nodiscard]] View fly_view(const Box& bounds, double turns, std::uint32_t width_px, std::uint32_t height_px);

}  // namespace lodestone::render
