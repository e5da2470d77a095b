// SPDX-License-Identifier: MIT
// Making pictures smaller without changing their brightness.
#pragma once

#include <lodestone/image.h>

namespace lodestone {

// Every pixel of the result is the mean, in linear light, of the rectangle of the source that it covers; alpha weighs
// colours. Precondition: width and height are at least 1 and at most the source's.
[[nodiscard]] Image shrink(const Image& source, std::uint32_t width, std::uint32_t height);

// The same in the source's own memory, which the result keeps: for pictures of which there is no room for two.
[[nodiscard]] Image shrink_in_place(Image source, std::uint32_t width, std::uint32_t height);

}  // namespace lodestone
