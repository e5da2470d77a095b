// SPDX-License-Identifier: MIT
// Based on: Daubechies and Sweldens 1998 (factoring wavelet transforms into lifting steps), the biorthogonal 9/7 pair
// of Cohen, Daubechies and Feauveau 1992.
#pragma once

#include <cstddef>
#include <vector>

namespace lodestone::perception {

// One level in place on the first `width` x `height` samples of `plane` (rows `stride` apart): afterwards the low band
// lies in the first (n + 1) / 2 samples of each direction, the high band behind it. Sizes may be odd; 1 is left alone.
void wavelet_forward(std::vector<float>& plane, std::size_t stride, std::size_t width, std::size_t height);
void wavelet_inverse(std::vector<float>& plane, std::size_t stride, std::size_t width, std::size_t height);

}  // namespace lodestone::perception
