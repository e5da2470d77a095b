// SPDX-License-Identifier: MIT
// Reads EXT_mesh_features and EXT_structural_metadata: which feature each vertex of a primitive belongs to, and what
// the features are called. Every number comes from a file and is checked.
#pragma once

#include <map>

#include <lodestone/mesh.h>

#include "gltf_accessors.h"
#include "reader.h"

namespace lodestone {

class GltfFeatures {
 public:
  GltfFeatures(const tinygltf::Model& model, std::uint64_t most_features)
      : model_{model}, most_features_{most_features} {}

  // The feature of each of the primitive's `count` vertices, into `out`; false if the primitive says nothing that can
  // be read. New features are added to the mesh; those without a parent of their own belong to `parent`.
  [[nodiscard]] bool read(const tinygltf::Primitive& primitive, std::uint32_t count, FeatureId parent, Mesh& mesh,
                          Warnings& warnings, std::vector<FeatureId>& out);

 private:
  using Key = std::pair<int, FeatureId>;  // table, and the instance that it is used in
  [[nodiscard]] const std::vector<FeatureId>* table(int index, FeatureId parent, Mesh& mesh, Warnings& warnings);
  [[nodiscard]] std::vector<std::string> strings(const tinygltf::Value& properties, const char* name,
                                                 std::size_t rows) const;
  [[nodiscard]] std::vector<std::int32_t> parents(const tinygltf::Value& properties, std::size_t rows) const;

  const tinygltf::Model& model_;
  std::uint64_t most_features_;
  std::map<Key, std::vector<FeatureId>> tables_;
  std::map<std::pair<Key, std::uint32_t>, FeatureId> bare_;  // ids that no table describes
  std::vector<float> ids_;
};

}  // namespace lodestone
