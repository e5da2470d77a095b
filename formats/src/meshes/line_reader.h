// SPDX-License-Identifier: MIT
// Lines of a text file through one block of memory, whatever the size of the file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "reader.h"

namespace lodestone {

class LineReader {
 public:
  LineReader(const Input& input, const Context& context) : input_{input}, context_{context} {}

  // The next line without its end; lines that end in a backslash are joined. Valid until the next call. False at the
  // end of the file or when status() has become an error.
  [[nodiscard]] bool next(std::string_view& line);

  // Cancelled, TooLarge (a line of over 256 MB) or Unreadable; checked after the last line.
  [[nodiscard]] const Status& status() const noexcept { return status_; }
  [[nodiscard]] std::uint64_t line_number() const noexcept { return line_number_; }
  // "model.obj, line 12"
  [[nodiscard]] std::string place() const;
  // Offset in the file of the byte after the line last returned.
  [[nodiscard]] std::uint64_t offset() const noexcept { return file_offset_ - (end_ - begin_); }

 private:
  [[nodiscard]] bool raw_line(std::string_view& line);
  [[nodiscard]] bool refill();

  const Input& input_;
  const Context& context_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t file_offset_ = 0;
  std::uint64_t line_number_ = 0;
  char line_end_ = '\n';  // '\r' in files of old Macs
  std::string joined_;
  Status status_ = Done{};
};

// A cursor over the words of one line.
class Words {
 public:
  explicit Words(std::string_view line) noexcept : at_{line.data()}, end_{line.data() + line.size()} {}

  // The next word; empty at the end of the line.
  [[nodiscard]] std::string_view next() noexcept {
    skip_blanks();
    const char* first = at_;
    while (at_ != end_ && !is_blank(*at_)) ++at_;
    return {first, static_cast<std::size_t>(at_ - first)};
  }
  // Everything that is left, without blanks around it.
  [[nodiscard]] std::string_view rest() noexcept;
  // The file's name that is left: what stands in quotes, else the rest.
  [[nodiscard]] std::string_view file_name() noexcept;
  // The next word as a number; false, and nothing consumed, if it is none. Infinite where out of range.
  [[nodiscard]] bool number(float& value) noexcept;
  [[nodiscard]] bool number(double& value) noexcept;

  void skip_blanks() noexcept {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }
  [[nodiscard]] const char* position() const noexcept { return at_; }
  [[nodiscard]] const char* end() const noexcept { return end_; }

 private:
  [[nodiscard]] static bool is_blank(char c) noexcept { return c == ' ' || c == '\t' || c == '\r'; }
  template <class Number>
  [[nodiscard]] bool parse(Number& value) noexcept;

  const char* at_;
  const char* end_;
};

}  // namespace lodestone
