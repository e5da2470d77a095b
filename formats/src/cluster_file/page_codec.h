// SPDX-License-Identifier: MIT
// Clusters as columns of small integers. Triangles come in an order in which each lies at an earlier one: what is
// stored is where, and what is new of it; new vertices are predicted across the edge between.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cluster_file/header.h"
#include "model_file/columns.h"

namespace lodestone::cluster_file {

enum Column : std::size_t {
  Neighbour,
  Corner,
  PositionX,
  NormalX = PositionX + 3,
  UvX = NormalX + 2,
  Color = UvX + 2,
  Target,
  ColumnCount
};

using WrittenColumns = std::array<model_file::ColumnWriter, ColumnCount>;
using ReadColumns = std::array<model_file::ColumnReader, ColumnCount>;

// The integers of a vertex.
struct Words {
  std::array<std::uint32_t, 3> position{};
  std::array<std::uint32_t, 2> normal{};
  std::array<std::uint32_t, 2> uv{};
  std::uint32_t color = 0;
};

// What both sides know of the file.
struct Codec {
  Grid grid;
  bool normals = false, uvs = false, colors = false;

  [[nodiscard]] Words words_of(const VertexArrays& vertices, std::uint32_t v) const;
  // Appends the vertex to `out`.
  void append(const Words& words, VertexArrays& out) const;
};

// A cluster: vertices in order of first use, local indices, ends of its sections (in triangles, from 0), and where each
// vertex goes (empty for roots).
struct Piece {
  std::vector<Words> vertices;
  std::vector<std::uint8_t> indices;
  std::vector<std::uint32_t> section_ends;
  std::vector<std::uint32_t> targets;
};

// What carries over from one cluster of a page to the next.
struct Carry {
  Words vertex;
  std::uint32_t target = 0;
};

void encode(const Codec& codec, const Piece& piece, Carry& carry, WrittenColumns& columns);
// `piece`: section_ends given, `vertex_count` and `has_targets` from the header. False if the columns make no sense.
[[nodiscard]] bool decode(const Codec& codec, std::uint32_t vertex_count, bool has_targets, Carry& carry,
                          ReadColumns& columns, Piece& piece);

}  // namespace lodestone::cluster_file
