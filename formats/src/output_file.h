// SPDX-License-Identifier: MIT
// A file that appears whole or not at all: written beside its name and renamed at the end.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <lodestone/result.h>

namespace lodestone {

class OutputFile {
 public:
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& file);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();  // without commit(): removes what was written

  // Failures (a full disk) are remembered and told by commit().
  void write(const void* data, std::size_t size_bytes) noexcept;
  void write(std::string_view text) noexcept { write(text.data(), text.size()); }

  // Flushes and puts the file in its place.
  [[nodiscard]] Status commit();

 private:
  OutputFile() = default;
  void discard() noexcept;
  std::FILE* stream_ = nullptr;
  std::filesystem::path file_;
  std::filesystem::path beside_;
  bool failed_ = false;
};

// All of a small file in one call.
[[nodiscard]] Status write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace lodestone
