// SPDX-License-Identifier: MIT
// The two ways in which a PLY file holds its values, behind one face: `bool value(PlyType, double&)`.
#pragma once

#include <bit>
#include <cstring>
#include <vector>

#include "line_reader.h"

namespace lodestone {

enum class PlyType : std::uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

[[nodiscard]] constexpr std::size_t size_bytes(PlyType type) noexcept {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

// Numbers as words; line ends do not matter.
class PlyText {
 public:
  explicit PlyText(LineReader& lines) : lines_{lines} {}
  [[nodiscard]] bool value(PlyType type, double& out) {
    for (;;) {
      words_.skip_blanks();
      if (words_.position() != words_.end()) break;
      std::string_view line;
      if (!lines_.next(line)) return false;
      words_ = Words{line};
    }
    if (type != PlyType::Float32) return words_.number(out);
    float rounded_once = 0.0F;
    if (!words_.number(rounded_once)) return false;
    out = rounded_once;
    return true;
  }
  [[nodiscard]] std::string place() const { return lines_.place(); }
  [[nodiscard]] bool cancelled() const { return !lines_.status(); }
  [[nodiscard]] Error error() const { return lines_.status().error(); }

 private:
  LineReader& lines_;
  Words words_{{}};
};

class PlyBinary {
 public:
  PlyBinary(const Input& input, const Context& context, std::uint64_t offset, std::endian order)
      : input_{input}, context_{context}, offset_{offset}, swap_{order != std::endian::native}, buffer_(1U << 20) {}

  [[nodiscard]] bool value(PlyType type, double& out) {
    const std::size_t size = size_bytes(type);
    if (end_ - begin_ < size && !refill(size)) return false;
    std::uint8_t bytes[8];
    std::memcpy(bytes, &buffer_[begin_], 8 <= buffer_.size() - begin_ ? 8 : size);
    begin_ += size;
    if (swap_) {
      for (std::size_t i = 0; i < size / 2; ++i) std::swap(bytes[i], bytes[size - 1 - i]);
    }
    switch (type) {
      case PlyType::Int8:
        out = as<std::int8_t>(bytes);
        break;
      case PlyType::UInt8:
        out = as<std::uint8_t>(bytes);
        break;
      case PlyType::Int16:
        out = as<std::int16_t>(bytes);
        break;
      case PlyType::UInt16:
        out = as<std::uint16_t>(bytes);
        break;
      case PlyType::Int32:
        out = as<std::int32_t>(bytes);
        break;
      case PlyType::UInt32:
        out = as<std::uint32_t>(bytes);
        break;
      case PlyType::Float32:
        out = static_cast<double>(as<float>(bytes));
        break;
      case PlyType::Float64:
        out = as<double>(bytes);
        break;
    }
    return true;
  }
  [[nodiscard]] std::string place() const {
    return input_.name() + ", byte " + std::to_string(offset_ - (end_ - begin_));
  }
  [[nodiscard]] bool cancelled() const { return context_.cancelled(); }
  [[nodiscard]] Error error() const { return Error{ErrorCode::Cancelled, "reading was cancelled", input_.name()}; }

 private:
  template <class T>
  [[nodiscard]] static T as(const std::uint8_t* bytes) noexcept {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
  [[nodiscard]] bool refill(std::size_t needed) {
    if (context_.cancelled()) return false;
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    const std::size_t got = input_.read(offset_, std::span{buffer_}.subspan(end_));
    end_ += got;
    offset_ += got;
    context_.report("reading", static_cast<double>(offset_) / static_cast<double>(input_.size()));
    return end_ >= needed;
  }

  const Input& input_;
  const Context& context_;
  std::uint64_t offset_;
  bool swap_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace lodestone
