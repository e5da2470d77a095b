// SPDX-License-Identifier: MIT
// Where the real data is. It is not part of a clone; a test that needs it says so and is reported as skipped.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lodestone::test {

// $LODESTONE_DATA, else ../shared/data beside the source tree; empty if there is none.
[[nodiscard]] std::optional<std::filesystem::path> data_root();

// An empty folder for this test under the build's temporary folder, removed and made anew.
[[nodiscard]] std::filesystem::path scratch_folder(const std::string& name);

}  // namespace lodestone::test

// First line of a test on real data: leaves it, visibly skipped (ctest matches the text), where the data is absent.
#define LODESTONE_REQUIRE_DATA(root)                                                        \
  const auto root##_optional = lodestone::test::data_root();                                \
  if (!root##_optional) {                                                                   \
    WARN("SKIPPED: real data not found; set LODESTONE_DATA or place it at ../shared/data"); \
    return;                                                                                 \
  }                                                                                         \
  const std::filesystem::path root = *root##_optional
