// SPDX-License-Identifier: MIT
#include "line_reader.h"

#include <charconv>
#include <cstring>
#include <limits>

namespace lodestone {
namespace {

constexpr std::size_t block_bytes = 1U << 20;
constexpr std::size_t max_line_bytes = 256U << 20;

}  // namespace

std::string LineReader::place() const { return input_.name() + ", line " + std::to_string(line_number_); }

bool LineReader::refill() {
  if (context_.cancelled()) {
    status_ = Error{ErrorCode::Cancelled, "reading was cancelled", input_.name()};
    return false;
  }
  if (file_offset_ >= input_.size()) return false;
  if (end_ > begin_) std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (buffer_.size() - end_ < block_bytes) {
    if (end_ > max_line_bytes) {
      status_ = Error{ErrorCode::TooLarge, "has a line of more than 256 MB", place()};
      return false;
    }
    buffer_.resize(end_ < block_bytes ? 2 * block_bytes : 2 * end_ + block_bytes);
  }
  const std::size_t got =
      input_.read(file_offset_, {reinterpret_cast<std::uint8_t*>(buffer_.data()) + end_, block_bytes});
  if (got == 0) {
    status_ = Error{ErrorCode::Unreadable, "could not be read to its end", input_.name()};
    return false;
  }
  if (file_offset_ == 0 && std::memchr(buffer_.data(), '\n', got) == nullptr &&
      std::memchr(buffer_.data(), '\r', got) != nullptr) {
    line_end_ = '\r';
  }
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (file_offset_ == 0 && std::string_view{buffer_.data(), got}.starts_with(byte_order_mark)) {
    begin_ = byte_order_mark.size();
  }
  end_ += got;
  file_offset_ += got;
  context_.report("reading", static_cast<double>(file_offset_) / static_cast<double>(input_.size()));
  return true;
}

bool LineReader::raw_line(std::string_view& line) {
  std::size_t searched = begin_;
  for (;;) {
    const char* first = buffer_.data() + searched;
    const char* found =
        end_ > searched ? static_cast<const char*>(std::memchr(first, line_end_, end_ - searched)) : nullptr;
    if (found != nullptr) {
      line = {buffer_.data() + begin_, static_cast<std::size_t>(found - buffer_.data()) - begin_};
      begin_ = static_cast<std::size_t>(found - buffer_.data()) + 1;
      break;
    }
    const std::size_t pending = end_ - begin_;
    if (refill()) {
      searched = begin_ + pending;
      continue;
    }
    if (!status_ || pending == 0) return false;
    line = {buffer_.data() + begin_, pending};  // the last line has no end
    begin_ = end_;
    break;
  }
  ++line_number_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

bool LineReader::next(std::string_view& line) {
  if (!raw_line(line)) return false;
  if (line.empty() || line.back() != '\\') return true;
  joined_.clear();
  while (!line.empty() && line.back() == '\\') {
    joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
    if (joined_.size() > max_line_bytes) {
      status_ = Error{ErrorCode::TooLarge, "has a line of more than 256 MB", place()};
      return false;
    }
    if (!raw_line(line)) {
      line = joined_;
      return status_.ok();
    }
  }
  joined_.append(line);
  line = joined_;
  return true;
}

std::string_view Words::rest() noexcept {
  skip_blanks();
  const char* last = end_;
  while (last != at_ && is_blank(last[-1])) --last;
  const std::string_view text{at_, static_cast<std::size_t>(last - at_)};
  at_ = end_;
  return text;
}

std::string_view Words::file_name() noexcept {
  const std::string_view text = rest();
  const std::size_t end = text.empty() || text.front() != '"' ? text.npos : text.find('"', 1);
  return end == text.npos ? text : text.substr(1, end - 1);
}

template <class Number>
bool Words::parse(Number& value) noexcept {
  skip_blanks();
  const char* first = at_;
  if (first != end_ && *first == '+') ++first;
  const auto [last, error] = std::from_chars(first, end_, value);
  if (error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) {
    const std::string_view text{first, static_cast<std::size_t>(last - first)};
    const bool tiny =
        text.find("e-") != text.npos || text.find("E-") != text.npos || text.find_first_of("eE") == text.npos;
    value = tiny ? Number{0} : std::numeric_limits<Number>::infinity();
  }
  at_ = last;
  while (at_ != end_ && !is_blank(*at_)) ++at_;  // "1.0f" and "1,5" are forgiven
  return true;
}

bool Words::number(float& value) noexcept { return parse(value); }
bool Words::number(double& value) noexcept { return parse(value); }

}  // namespace lodestone
