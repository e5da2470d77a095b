// SPDX-License-Identifier: MIT
#include "progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lodestone::cli {

using namespace std::chrono_literals;

ProgressBar::ProgressBar(Show show) : enabled_(show == Show::OnTerminal && ::isatty(STDERR_FILENO) != 0) {}

void ProgressBar::update(std::string_view stage, double fraction) {
  const auto now = std::chrono::steady_clock::now();
  if (!enabled_ || now - start_ < 1s || now - last_ < 50ms) return;
  last_ = now;
  constexpr int width = 32;
  const double done = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(done * width);
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(width, '.');
  std::fprintf(stderr, "\r\033[K[%s] %3.0f %% %.*s", bar.c_str(), 100.0 * done, static_cast<int>(stage.size()),
               stage.data());
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace lodestone::cli
