// SPDX-License-Identifier: MIT
// What an earlier build left, looked at before it is kept.
#pragma once

#include <filesystem>

namespace lodestone {

// True if `file` is there and has as many bytes as its head says: a tile (.glb, .b3dm), or else raw pixels behind
// width, height and channels. Files are renamed when they are whole, so what is shorter was cut off later.
[[nodiscard]] bool is_whole_file(const std::filesystem::path& file);

}  // namespace lodestone
