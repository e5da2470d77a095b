// SPDX-License-Identifier: MIT
// Integers in columns: the only packing a .lode block knows. A block is a fixed number of columns; a column is a run of
// one-byte tokens and a run of extra bits; zstd squeezes each run with tables of its own.
//
// A value below 64 is its own token. A larger one with highest bit e (6..31) has token 64 + 2 (e - 6) + (the bit below
// the highest), and its remaining e - 1 bits go to the extra bits, lowest first.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace lodestone::model_file {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::uint32_t direct_tokens = 64;
inline constexpr std::uint32_t direct_bits = 6;

// Small magnitudes of either sign become small unsigned values: 0, -1, 1, -2, ...
[[nodiscard]] inline std::uint32_t zigzag(std::uint32_t difference) noexcept {
  return (difference << 1) ^ (0U - (difference >> 31));
}
[[nodiscard]] inline std::uint32_t unzigzag(std::uint32_t value) noexcept { return (value >> 1) ^ (0U - (value & 1U)); }

class ColumnWriter {
 public:
  void put(std::uint32_t value) {
    if (value < direct_tokens) {
      tokens_.push_back(static_cast<std::uint8_t>(value));
      return;
    }
    const auto highest = static_cast<std::uint32_t>(std::bit_width(value) - 1);
    const std::uint32_t below = (value >> (highest - 1)) & 1U;
    tokens_.push_back(static_cast<std::uint8_t>(direct_tokens + 2 * (highest - direct_bits) + below));
    put_bits(value & ((1U << (highest - 1)) - 1), highest - 1);
  }

  [[nodiscard]] const Bytes& tokens() const noexcept { return tokens_; }
  // The extra bits so far, the last byte filled up with zeros.
  [[nodiscard]] Bytes extra() const;
  void clear() noexcept;
  // At least what it will take in a block.
  [[nodiscard]] std::size_t size_bytes() const noexcept { return tokens_.size() + extra_.size() + 16; }

 private:
  void put_bits(std::uint32_t bits, std::uint32_t count) {
    pending_ |= static_cast<std::uint64_t>(bits) << pending_count_;
    pending_count_ += count;
    while (pending_count_ >= 8) {
      extra_.push_back(static_cast<std::uint8_t>(pending_));
      pending_ >>= 8;
      pending_count_ -= 8;
    }
  }

  Bytes tokens_, extra_;
  std::uint64_t pending_ = 0;
  std::uint32_t pending_count_ = 0;
};

// Reads what a ColumnWriter wrote. Past the end it gives zeros and remembers that it did.
class ColumnReader {
 public:
  ColumnReader() = default;
  ColumnReader(std::span<const std::uint8_t> tokens, std::span<const std::uint8_t> extra) noexcept
      : token_(tokens.data()),
        token_end_(tokens.data() + tokens.size()),
        extra_(extra.data()),
        extra_end_(extra.data() + extra.size()) {}

  [[nodiscard]] std::uint32_t get() noexcept {
    if (token_ == token_end_) {
      overrun_ = true;
      return 0;
    }
    const std::uint32_t token = *token_++;
    if (token < direct_tokens) return token;
    const std::uint32_t highest = direct_bits + ((token - direct_tokens) >> 1);
    if (highest > 31) {
      overrun_ = true;
      return 0;
    }
    return (2U | (token & 1U)) << (highest - 1) | get_bits(highest - 1);
  }

  [[nodiscard]] bool overrun() const noexcept { return overrun_; }
  [[nodiscard]] std::size_t left() const noexcept { return static_cast<std::size_t>(token_end_ - token_); }

 private:
  [[nodiscard]] std::uint32_t get_bits(std::uint32_t count) noexcept {
    if (pending_count_ < count) refill(count);
    const auto bits = static_cast<std::uint32_t>(pending_ & ((1ULL << count) - 1));
    pending_ >>= count;
    pending_count_ -= count;
    return bits;
  }
  void refill(std::uint32_t count) noexcept {
    if (extra_end_ - extra_ >= 4) {
      std::uint32_t word = 0;
      std::memcpy(&word, extra_, 4);
      if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap32(word);
      pending_ |= static_cast<std::uint64_t>(word) << pending_count_;
      pending_count_ += 32;
      extra_ += 4;
      return;
    }
    while (pending_count_ < count) {
      if (extra_ == extra_end_) {
        overrun_ = true;
        pending_count_ = count;
        return;
      }
      pending_ |= static_cast<std::uint64_t>(*extra_++) << pending_count_;
      pending_count_ += 8;
    }
  }

  const std::uint8_t* token_ = nullptr;
  const std::uint8_t* token_end_ = nullptr;
  const std::uint8_t* extra_ = nullptr;
  const std::uint8_t* extra_end_ = nullptr;
  std::uint64_t pending_ = 0;
  std::uint32_t pending_count_ = 0;
  bool overrun_ = false;
};

// A block as stored: packed with zstd, or as it is where that would be no smaller (or suspiciously small, see
// `unpack_is_sane`).
struct PackedBlock {
  Bytes bytes;
  std::uint64_t raw_bytes = 0;
  bool compressed = false;
};

// The guard against blocks that unpack to far more than was stored: writer and reader keep the same bound.
[[nodiscard]] inline bool unpack_is_sane(std::uint64_t raw_bytes, std::uint64_t stored_bytes) noexcept {
  return raw_bytes <= 1000 * stored_bytes + 4096;
}

// Packs parts one after the other as one zstd frame; each part gets entropy tables of its own.
[[nodiscard]] PackedBlock pack(std::span<const Bytes> parts);
// False if the bytes are not a frame of exactly `raw.size()` bytes.
[[nodiscard]] bool unpack(std::span<const std::uint8_t> stored, std::span<std::uint8_t> raw) noexcept;

[[nodiscard]] std::uint64_t checksum(std::span<const std::uint8_t> bytes) noexcept;

// The raw form of a block of columns: per column u32 token count and u32 extra byte count, then per column its tokens
// and its extra bits.
[[nodiscard]] PackedBlock pack_columns(std::span<const ColumnWriter> columns);
// False if the table at the front does not describe exactly these bytes.
[[nodiscard]] bool split_columns(std::span<const std::uint8_t> raw, std::span<ColumnReader> columns) noexcept;

}  // namespace lodestone::model_file
