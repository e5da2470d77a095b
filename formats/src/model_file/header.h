// SPDX-License-Identifier: MIT
// Everything a .lode file says before its blocks: what the model is about, and where each block lies.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/progressive_model.h>

#include "columns.h"
#include "envelope.h"
#include "values.h"

namespace lodestone::model_file {

inline constexpr FileKind lode_file{{0x89, 'L', 'O', 'D', 'E', '\r', '\n', 0x1A}, 1, ".lode"};

enum class BlockKind : std::uint8_t { Base = 0, Records = 1, Texture = 2 };

struct BlockEntry {
  BlockKind kind = BlockKind::Base;
  bool compressed = false;
  std::uint32_t count = 0;  // records; for a texture its index
  std::uint64_t stored_bytes = 0;
  std::uint64_t raw_bytes = 0;
  std::uint64_t checksum = 0;  // of the stored bytes
};

struct Header {
  std::string generator;
  Surroundings surroundings;  // textures without pixels and bytes
  std::string method;
  std::vector<NamedLevel> named_levels;
  bool normals = false, uvs = false, colors = false, features = false;
  Grid grid;
  std::uint32_t records = 0, vertices = 0, faces = 0;  // of the whole file
  std::vector<BlockEntry> blocks;                      // in file order, without gaps
};

// Prologue and header as they stand at the front of a file.
[[nodiscard]] Bytes write_header(const Header& header);

// How many bytes prologue and header take together, told from the first prologue_bytes.
[[nodiscard]] std::optional<HeaderFault> header_size(std::span<const std::uint8_t> prologue, std::uint64_t& bytes);
// `bytes`: prologue and header whole.
[[nodiscard]] std::optional<HeaderFault> read_header(std::span<const std::uint8_t> bytes, Header& header);

}  // namespace lodestone::model_file
