// SPDX-License-Identifier: MIT
// The bytes of a file that is named by a path, or by an address of the web.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <lodestone/result.h>

namespace lodestone {

// "http://" or "https://".
[[nodiscard]] bool is_address(const std::filesystem::path& file);

// Whole, of at most so many bytes. Errors: NotFound (also for the server's 404), Unreadable with what failed, TooLarge.
// Waits as long as something comes, but no longer than half a minute for the next kilobyte. Any thread.
[[nodiscard]] Result<std::vector<std::uint8_t>> fetch(const std::filesystem::path& file, std::uint64_t most_bytes);

}  // namespace lodestone
