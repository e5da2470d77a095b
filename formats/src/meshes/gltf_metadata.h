// SPDX-License-Identifier: MIT
// Features of faces as glTF carries them: an id per vertex (EXT_mesh_features) and a table of what the ids are
// (EXT_structural_metadata).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone {

// Which features go into the file, in the order of the mesh: those that faces have, and all that these belong to.
struct FeatureRows {
  std::vector<FeatureId> features;  // by row
  std::vector<std::uint32_t> rows;  // by feature; `none` for those left out
  [[nodiscard]] bool empty() const noexcept { return features.empty(); }
  // What a face without a feature has.
  [[nodiscard]] std::uint32_t no_row() const noexcept { return static_cast<std::uint32_t>(features.size()); }
};
[[nodiscard]] FeatureRows rows_of(const Mesh& mesh);

// A mesh in which no two features share a vertex, and the row of every vertex.
struct FeatureVertices {
  Mesh mesh;
  std::vector<std::uint32_t> vertex_rows;
};
[[nodiscard]] FeatureVertices split_by_feature(const Mesh& mesh, const FeatureRows& rows);

// One column of the table: all values one after the other, and where each begins.
struct StringColumn {
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint32_t> offsets;
};
[[nodiscard]] StringColumn column_of(const Mesh& mesh, const FeatureRows& rows, std::string Feature::*text);

// Row of each feature's parent, -1 for those that belong to nothing.
[[nodiscard]] std::vector<std::int32_t> parents_of(const Mesh& mesh, const FeatureRows& rows);

}  // namespace lodestone
