// SPDX-License-Identifier: MIT
// One line on stderr that shows how far a long call is.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace lodestone::cli {

// Draws nothing during the first second, and nothing at all unless stderr is a terminal.
class ProgressBar {
 public:
  // When a bar may be seen at all.
  enum class Show { OnTerminal, Never };

  explicit ProgressBar(Show show);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::string_view stage, double fraction);
  // Takes the bar off the line, before something else is printed.
  void clear();

 private:
  bool enabled_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace lodestone::cli
