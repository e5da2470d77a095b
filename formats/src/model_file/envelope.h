// SPDX-License-Identifier: MIT
// The front of our binary files: magic, version, sizes and a checksum around a packed header. docs/FILE_FORMAT.md.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <lodestone/result.h>

#include "columns.h"

namespace lodestone::model_file {

// Magic, u32 version, u32 stored header bytes, u32 raw header bytes, u32 compressed, u64 checksum.
inline constexpr std::size_t prologue_bytes = 32;

// What tells one kind of file from another.
struct FileKind {
  std::uint8_t magic[8];  // the 0x89 and the line ends show when a transfer took the file for text
  std::uint32_t version = 1;
  const char* name = "";  // ".lode"
};

struct HeaderFault {
  ErrorCode code = ErrorCode::BadData;
  std::string message;
};

inline constexpr const char* damaged_header = "the header is damaged; copy the file again";

// Prologue and header as they stand at the front of a file.
[[nodiscard]] Bytes seal(const FileKind& kind, const Bytes& header);
// How many bytes prologue and header take together, told from the first prologue_bytes.
[[nodiscard]] std::optional<HeaderFault> sealed_size(const FileKind& kind, std::span<const std::uint8_t> prologue,
                                                     std::uint64_t& bytes);
// `bytes`: prologue and header whole.
[[nodiscard]] std::optional<HeaderFault> unseal(std::span<const std::uint8_t> bytes, Bytes& header);

}  // namespace lodestone::model_file
