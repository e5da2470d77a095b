// SPDX-License-Identifier: MIT
// Everything a .lodg file says before its pages.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/clusters.h>

#include "model_file/envelope.h"

namespace lodestone::cluster_file {

using model_file::Bytes;
using model_file::HeaderFault;

inline constexpr model_file::FileKind lodg_file{{0x89, 'L', 'O', 'D', 'G', '\r', '\n', 0x1A}, 1, ".lodg"};
inline constexpr std::uint64_t max_page_bytes = 128 * 1024;  // unpacked

struct Grid {
  std::uint32_t bits = 16;
  glm::dvec3 corner{0.0};
  double step_m = 0.0;
};

struct PageEntry {
  std::uint64_t offset = 0;  // from the end of the header
  std::uint32_t stored_bytes = 0;
  std::uint32_t raw_bytes = 0;
  bool compressed = false;
  std::uint64_t checksum = 0;  // of the stored bytes
  Range nodes;
};

// The bytes of an image file, behind the pages.
struct TextureEntry {
  std::uint32_t texture = 0;
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;
};

struct Header {
  std::string generator;
  bool normals = false, uvs = false, colors = false;
  Grid grid;
  ClusterGraph outline;  // without vertices, indices and targets
  std::vector<PageEntry> pages;
  std::vector<TextureEntry> textures;  // in file order
};

[[nodiscard]] Bytes write_header(const Header& header);
// `bytes`: prologue and header whole. Checks all counts and the graph.
[[nodiscard]] std::optional<HeaderFault> read_header(std::span<const std::uint8_t> bytes, Header& header);

}  // namespace lodestone::cluster_file
