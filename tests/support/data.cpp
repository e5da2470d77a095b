// SPDX-License-Identifier: MIT
#include "data.h"

#include <unistd.h>

#include <cstdlib>

namespace lodestone::test {

std::optional<std::filesystem::path> data_root() {
  if (const char* env = std::getenv("LODESTONE_DATA"); env != nullptr && *env != '\0') {
    if (std::filesystem::is_directory(env)) return std::filesystem::path{env};
    return std::nullopt;
  }
  const std::filesystem::path beside = std::filesystem::path{LODESTONE_SOURCE_DIR} / ".." / "shared" / "data";
  if (std::filesystem::is_directory(beside)) return std::filesystem::canonical(beside);
  return std::nullopt;
}

std::filesystem::path scratch_folder(const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() / ("lodestone-test-" + std::to_string(::getpid())) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace lodestone::test
