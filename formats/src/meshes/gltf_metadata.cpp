// SPDX-License-Identifier: MIT
#include "gltf_metadata.h"

#include <map>

namespace lodestone {

FeatureRows rows_of(const Mesh& mesh) {
  FeatureRows result;
  std::vector<bool> used(mesh.features.size(), false);
  for (const FeatureId face : mesh.face_features) {
    for (FeatureId f = face; f != none && !used[f]; f = mesh.features[f].parent) used[f] = true;
  }
  result.rows.assign(mesh.features.size(), none);
  for (FeatureId f = 0; f < used.size(); ++f) {
    if (!used[f]) continue;
    result.rows[f] = result.no_row();
    result.features.push_back(f);
  }
  return result;
}

FeatureVertices split_by_feature(const Mesh& mesh, const FeatureRows& rows) {
  FeatureVertices result{mesh, std::vector<std::uint32_t>(mesh.vertex_count(), none)};
  VertexArrays& v = result.mesh.vertices;
  std::map<std::pair<VertexId, std::uint32_t>, VertexId> copies;
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
    const VertexId vertex = mesh.indices[corner];
    const FeatureId feature = mesh.face_feature(static_cast<FaceId>(corner / 3));
    const std::uint32_t row = feature == none ? rows.no_row() : rows.rows[feature];
    if (result.vertex_rows[vertex] == none) result.vertex_rows[vertex] = row;
    if (result.vertex_rows[vertex] == row) continue;
    const auto [copy, is_new] = copies.try_emplace({vertex, row}, v.size());
    result.mesh.indices[corner] = copy->second;
    if (!is_new) continue;
    v.positions.push_back(glm::vec3{v.positions[vertex]});
    if (!v.normals.empty()) v.normals.push_back(glm::vec3{v.normals[vertex]});
    if (!v.uvs.empty()) v.uvs.push_back(glm::vec2{v.uvs[vertex]});
    if (!v.colors.empty()) v.colors.push_back(glm::u8vec4{v.colors[vertex]});
    result.vertex_rows.push_back(row);
  }
  for (std::uint32_t& row : result.vertex_rows) row = row == none ? rows.no_row() : row;  // vertices of no face
  return result;
}

StringColumn column_of(const Mesh& mesh, const FeatureRows& rows, std::string Feature::*text) {
  StringColumn column;
  column.offsets.push_back(0);
  for (const FeatureId feature : rows.features) {
    const std::string& value = mesh.features[feature].*text;
    column.bytes.insert(column.bytes.end(), value.begin(), value.end());
    column.offsets.push_back(static_cast<std::uint32_t>(column.bytes.size()));
  }
  return column;
}

std::vector<std::int32_t> parents_of(const Mesh& mesh, const FeatureRows& rows) {
  std::vector<std::int32_t> parents;
  for (const FeatureId feature : rows.features) {
    const FeatureId parent = mesh.features[feature].parent;
    parents.push_back(parent == none ? -1 : static_cast<std::int32_t>(rows.rows[parent]));
  }
  return parents;
}

}  // namespace lodestone
