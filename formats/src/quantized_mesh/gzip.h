// SPDX-License-Identifier: MIT
// The gzip container, without time or name in it, so that equal bytes in give equal bytes out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/result.h>

namespace lodestone {

[[nodiscard]] std::vector<std::uint8_t> to_gzip(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<std::vector<std::uint8_t>> from_gzip(std::span<const std::uint8_t> bytes, std::size_t max_bytes);
[[nodiscard]] bool is_gzip(std::span<const std::uint8_t> bytes);

}  // namespace lodestone
