// SPDX-License-Identifier: MIT
#include "session.h"

#include <malloc.h>
#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <thread>

#include "version.h"

namespace lodestone::cli {
namespace {

const auto program_start = std::chrono::steady_clock::now();
std::atomic<bool> cancel_requested{false};

extern "C" void on_signal(int) { cancel_requested.store(true, std::memory_order_relaxed); }

double seconds_since_start() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - program_start).count();
}

// Of this program alone: getrusage() begins with what the process was before it became this program.
std::uint64_t peak_rss_bytes() {
  std::ifstream status{"/proc/self/status"};
  for (std::string word; status >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
  }
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// The last resort where a verb did not foresee what it would take: memory a fifth beyond the limit is refused by the
// system, and the program ends with one line. The system counts what is reserved, whole stacks of threads too, of which
// hardly a page is ever used: they come on top. Pages of the program's own files it does not count. What is freed goes
// back at once, so that it counts no longer.
void limit_memory(std::uint64_t bytes, unsigned threads) {
  if (bytes == 0) return;
  constexpr std::uint64_t program_file_bytes = 35'000'000;
  constexpr int kept_bytes = 1 << 18;
  ::mallopt(M_ARENA_MAX, 1);
  ::mallopt(M_MMAP_THRESHOLD, kept_bytes);
  ::mallopt(M_TRIM_THRESHOLD, kept_bytes);
  constexpr std::uint64_t own_stack_bytes = 2U << 20U;
  constexpr std::uint64_t scheduler_stack_bytes = 4U << 20U;  // oneTBB's choice
  pthread_attr_t attributes;
  if (::pthread_getattr_default_np(&attributes) == 0) {
    ::pthread_attr_setstacksize(&attributes, own_stack_bytes);
    ::pthread_setattr_default_np(&attributes);
    ::pthread_attr_destroy(&attributes);
  }
  const unsigned workers = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
  const std::uint64_t most = bytes + bytes / 5;
  const std::uint64_t reserved =
      most - std::min(program_file_bytes, most / 2) + workers * (own_stack_bytes + scheduler_stack_bytes);
  const rlimit limit{reserved, reserved};
  ::setrlimit(RLIMIT_DATA, &limit);
}

void print_line(const std::string& line) { std::fprintf(stderr, "lodestone: %s\n", line.c_str()); }

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A reader that went away and a file-size limit show as a failed write, which is reported like a full disk.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

Session::Session(const Common& common)
    : common_(common), bar_(common.quiet ? ProgressBar::Show::Never : ProgressBar::Show::OnTerminal) {
  limit_memory(common.max_memory_bytes, common.threads);
  context_.cancel = &cancel_requested;
  context_.max_workers = common.threads;
  context_.max_memory_bytes = common.max_memory_bytes;
  context_.progress = [this](std::string_view stage, double fraction) { bar_.update(stage, fraction); };
  report_.set("lodestone", version);
}

void Session::keep(std::vector<Warning> warnings) {
  bar_.clear();
  for (Warning& warning : warnings) {
    if (!common_.quiet) print_line("warning: " + to_line(warning));
    warnings_.push_back(std::move(warning));
  }
}

void Session::remark(const std::string& line) {
  bar_.clear();
  if (!common_.quiet) print_line(line);
}

int Session::finish(const Status& status) {
  keep(status.warnings());
  bar_.clear();
  int code = exit_code::done;
  if (!status) {
    code = to_exit_code(status.error().code);
    report_.set_error(status.error());
    print_line(to_line(status.error()));
  } else if (common_.strict && !warnings_.empty()) {
    code = exit_code::warnings;
  }
  report_.set("seconds", seconds_since_start());
  report_.set("peak_rss_bytes", peak_rss_bytes());
  report_.set_warnings(warnings_);
  const std::string text = common_.json ? report_.to_json() + "\n" : (status ? report_.to_lines() : "");
  const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  if (!written) {
    print_line("standard output: the report could not be written, check the disk or the pipe");
    return exit_code::bad_data;
  }
  return code;
}

int to_exit_code(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::BadArgument:
      return exit_code::wrong_arguments;
    case ErrorCode::Cancelled:
      return exit_code::cancelled;
    case ErrorCode::NotFound:
    case ErrorCode::Unreadable:
    case ErrorCode::BadData:
    case ErrorCode::Unsupported:
    case ErrorCode::TooLarge:
      break;
  }
  return exit_code::bad_data;
}

Error or_resume(const Error& error, const std::filesystem::path& folder) {
  if (error.code != ErrorCode::Cancelled) return error;
  std::error_code fault;
  const bool begun = std::filesystem::exists(folder, fault) && !std::filesystem::is_empty(folder, fault);
  if (!begun) return {ErrorCode::Cancelled, "cancelled before anything was written", folder.string()};
  return {ErrorCode::Cancelled, "cancelled, the same command with --resume goes on from here", folder.string()};
}

}  // namespace lodestone::cli
