// SPDX-License-Identifier: MIT
// Programs beside this one that cannot share a process with it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::cli {

// Beside this program, as installed; else in `in_build_tree`, relative to it; else left to the PATH.
[[nodiscard]] std::filesystem::path find_program(const std::string& name, const std::string& in_build_tree);

struct Ended {
  int status = 0;
  std::string last_words;  // last line on stderr
};

// Runs a program to its end; none if it cannot be started.
[[nodiscard]] std::optional<Ended> run_to_end(std::vector<std::string> command);

}  // namespace lodestone::cli
