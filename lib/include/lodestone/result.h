// SPDX-License-Identifier: MIT
/// \file
/// Errors are values. A function that reads data or does I/O returns Result<T>: either a value, with the
/// warnings met on the way, or one Error. Misuse of the API (an index out of range, a null model) is an assert,
/// never an Error. No exception leaves the library except std::bad_alloc.
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lodestone {

/// What kind of thing went wrong; the programs turn it into an exit code.
enum class ErrorCode {
  NotFound,     ///< A file or folder is not there.
  Unreadable,   ///< The system refused to read or write it (permission, disk full, cut pipe).
  BadData,      ///< It was read, but is not what it claims to be.
  Unsupported,  ///< It is valid, but of a kind or version that this build cannot use.
  TooLarge,     ///< It exceeds a cap on counts or bytes.
  BadArgument,  ///< A value handed in from outside (command line, options file) is out of range.
  Cancelled,    ///< Context::cancelled() became true.
};

/// One thing that went wrong, fit to be shown as one line: "<file>: <message>, <where>".
struct Error {
  ErrorCode code = ErrorCode::BadData;
  std::string message;  ///< What is wrong and what to do, one sentence without a full stop.
  std::string where;    ///< File, and line, byte or element inside it; empty if it has no place.
};

/// Something that was tolerated. Readers collapse repeats: `count` tells how often it was met.
struct Warning {
  std::string message;
  std::string where;  ///< The first place it was met.
  std::size_t count = 1;
};

/// A value with warnings, or an Error. Move-only when T is.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}  // NOLINT(google-explicit-constructor): `return value;`
  Result(T value, std::vector<Warning> warnings) : value_(std::move(value)), warnings_(std::move(warnings)) {}
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor): `return error;`

  [[nodiscard]] bool ok() const noexcept { return value_.has_value(); }
  explicit operator bool() const noexcept { return ok(); }

  /// Precondition of the four accessors below: ok().
  [[nodiscard]] T& value() & {
    assert(ok());
    return *value_;
  }
  [[nodiscard]] const T& value() const& {
    assert(ok());
    return *value_;
  }
  [[nodiscard]] T&& value() && {
    assert(ok());
    return std::move(*value_);
  }
  T* operator->() {
    assert(ok());
    return &*value_;
  }
  const T* operator->() const {
    assert(ok());
    return &*value_;
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }

  /// Precondition: !ok().
  [[nodiscard]] const Error& error() const noexcept {
    assert(!ok());
    return error_;
  }
  [[nodiscard]] const std::vector<Warning>& warnings() const noexcept { return warnings_; }
  [[nodiscard]] std::vector<Warning>& warnings() noexcept { return warnings_; }

 private:
  std::optional<T> value_;
  Error error_;
  std::vector<Warning> warnings_;
};

/// The result of a function that has nothing to return but may fail.
struct Done {};
using Status = Result<Done>;

/// "where: message" as one line for a log or a terminal.
[[nodiscard]] std::string to_line(const Error& error);
[[nodiscard]] std::string to_line(const Warning& warning);

}  // namespace lodestone
