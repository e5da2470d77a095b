// SPDX-License-Identifier: MIT
// One run of one verb: the common options, Ctrl-C, progress, warnings and the report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/result.h>

#include "progress_bar.h"
#include "report.h"

namespace lodestone::cli {

// Options that every verb takes.
struct Common {
  bool json = false;
  bool quiet = false;
  bool strict = false;
  std::uint32_t threads = 0;           // 0 = one per core
  std::uint64_t max_memory_bytes = 0;  // 0 = no limit
};

// Raised by Ctrl-C (SIGINT) and SIGTERM; a second one ends the program at once.
void catch_signals();

class Session {
 public:
  explicit Session(const Common& common);

  // For every library call that may take long.
  [[nodiscard]] const Context& context() const noexcept { return context_; }
  [[nodiscard]] Report& report() noexcept { return report_; }

  // Takes over the warnings of a result; they go to stderr and into the report.
  template <class T>
  void keep(Result<T>& result) {
    keep(std::exchange(result.warnings(), {}));
  }
  void keep(std::vector<Warning> warnings);
  // A line for people about what was chosen; not a warning.
  void remark(const std::string& line);

  // Prints the report or the error and says how the program ends.
  [[nodiscard]] int finish(const Status& status);

 private:
  Common common_;
  ProgressBar bar_;
  Context context_;
  Report report_;
  std::vector<Warning> warnings_;
};

// The program's answer to its caller.
namespace exit_code {
inline constexpr int done = 0;
inline constexpr int wrong_arguments = 1;
inline constexpr int bad_data = 2;
inline constexpr int warnings = 3;
inline constexpr int cancelled = 4;
}  // namespace exit_code
[[nodiscard]] int to_exit_code(ErrorCode code) noexcept;

// What a verb that can go on with its folder returns when writing failed: tells how, if it was only cancelled.
[[nodiscard]] Error or_resume(const Error& error, const std::filesystem::path& folder);

}  // namespace lodestone::cli
