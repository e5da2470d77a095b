// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include <lodestone/perception.h>

namespace lodestone::perception {

/// How far two pictures of one size differ at each pixel, in just noticeable differences. O(pixels).
[[nodiscard]] std::vector<float> visible_difference(const Image& a, const Image& b, const VisionModel& vision);

}  // namespace lodestone::perception
