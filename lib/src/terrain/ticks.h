// SPDX-License-Identifier: MIT
// Progress from several threads: one caller at a time, about twenty times a second.
#pragma once

#include <chrono>
#include <mutex>
#include <string_view>

#include <lodestone/context.h>

namespace lodestone::terrain {

class ProgressTicks {
 public:
  void tick(const Context& context, std::string_view stage, double fraction) {
    const std::unique_lock lock{mutex_, std::try_to_lock};
    if (!lock) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds{50}) return;
    last_ = now;
    context.report(stage, fraction);
  }

 private:
  std::mutex mutex_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace lodestone::terrain
