// SPDX-License-Identifier: MIT
#include "gltf_features.h"

#include <cstring>

namespace lodestone {
namespace {

using tinygltf::Value;

const Value* member(const Value& object, const char* key) {
  return object.IsObject() && object.Has(key) ? &object.Get(key) : nullptr;
}

int whole(const Value& object, const char* key, int fallback) {
  const Value* value = member(object, key);
  if (value == nullptr || !value->IsNumber()) return fallback;
  const double number = value->GetNumberAsDouble();
  return number >= 0.0 && number < 2147483647.0 ? static_cast<int>(number) : fallback;
}

const Value* first_of(const Value& object, const char* key, int index = 0) {
  const Value* list = member(object, key);
  if (list == nullptr || !list->IsArray() || index < 0 || list->ArrayLen() <= static_cast<std::size_t>(index)) {
    return nullptr;
  }
  return &list->Get(index);
}

}  // namespace

// Values of a column of strings; empty if there is none of that name, or it is not as it should be.
std::vector<std::string> GltfFeatures::strings(const Value& properties, const char* name, std::size_t rows) const {
  const Value* property = member(properties, name);
  if (property == nullptr) return {};
  if (const Value* type = member(*property, "stringOffsetType");
      type != nullptr && (!type->IsString() || type->Get<std::string>() != "UINT32")) {
    return {};
  }
  const auto text = view_bytes(model_, whole(*property, "values", -1));
  const auto offsets = view_bytes(model_, whole(*property, "stringOffsets", -1));
  if (offsets.size() / 4 <= rows) return {};
  std::vector<std::string> values;
  std::uint32_t begin = 0;
  std::memcpy(&begin, offsets.data(), 4);
  for (std::size_t row = 0; row < rows; ++row) {
    std::uint32_t end = 0;
    std::memcpy(&end, offsets.data() + 4 * (row + 1), 4);
    if (end < begin || end > text.size()) return {};
    values.emplace_back(reinterpret_cast<const char*>(text.data()) + begin, end - begin);
    begin = end;
  }
  return values;
}

std::vector<std::int32_t> GltfFeatures::parents(const Value& properties, std::size_t rows) const {
  const Value* property = member(properties, "parent");
  if (property == nullptr) return {};
  const auto bytes = view_bytes(model_, whole(*property, "values", -1));
  if (bytes.size() / 4 < rows) return {};
  std::vector<std::int32_t> values(rows);
  if (rows > 0) std::memcpy(values.data(), bytes.data(), 4 * rows);
  return values;
}

const std::vector<FeatureId>* GltfFeatures::table(int index, FeatureId parent, Mesh& mesh, Warnings& warnings) {
  const Key key{index, parent};
  if (const auto found = tables_.find(key); found != tables_.end()) return &found->second;
  const auto metadata = model_.extensions.find("EXT_structural_metadata");
  if (metadata == model_.extensions.end()) return nullptr;
  const Value* description = first_of(metadata->second, "propertyTables", index);
  if (description == nullptr) return nullptr;
  const auto rows = static_cast<std::size_t>(whole(*description, "count", 0));
  const Value* properties = member(*description, "properties");
  if (properties == nullptr || rows + mesh.features.size() > most_features_) return nullptr;
  auto ids = strings(*properties, "id", rows);
  if (ids.empty()) ids = strings(*properties, "name", rows);
  if (ids.empty()) {
    warnings.add("a table of features has neither ids nor names; they are numbered");
    return nullptr;
  }
  const auto classes = strings(*properties, "class", rows);
  const auto above = parents(*properties, rows);
  std::vector<FeatureId>& made = tables_[key];
  const auto first = static_cast<FeatureId>(mesh.features.size());
  for (std::size_t row = 0; row < rows; ++row) {
    // What belongs to a later row, or to itself, could go in circles.
    const bool has_parent = row < above.size() && above[row] >= 0 && static_cast<std::size_t>(above[row]) < row;
    made.push_back(first + static_cast<FeatureId>(row));
    mesh.features.push_back({std::move(ids[row]), row < classes.size() ? classes[row] : std::string{},
                             has_parent ? first + static_cast<FeatureId>(above[row]) : parent});
  }
  return &made;
}

bool GltfFeatures::read(const tinygltf::Primitive& primitive, std::uint32_t count, FeatureId parent, Mesh& mesh,
                        Warnings& warnings, std::vector<FeatureId>& out) {
  const auto extension = primitive.extensions.find("EXT_mesh_features");
  if (extension == primitive.extensions.end()) return false;
  const Value* set = first_of(extension->second, "featureIds");
  if (set == nullptr) return false;
  if (set->Has("texture")) {
    warnings.add("feature ids in textures are left out");
    return false;
  }
  ids_.clear();
  if (const int attribute = whole(*set, "attribute", -1); attribute >= 0) {
    const auto named = primitive.attributes.find("_FEATURE_ID_" + std::to_string(attribute));
    if (named == primitive.attributes.end() || !read_floats(model_, named->second, 1, count, ids_).ok() ||
        ids_.size() != count) {
      warnings.add("feature ids that do not fit their mesh are left out");
      return false;
    }
  }
  const int described_by = whole(*set, "propertyTable", -1);
  const std::vector<FeatureId>* known = described_by >= 0 ? table(described_by, parent, mesh, warnings) : nullptr;
  const int null_id = whole(*set, "nullFeatureId", -1);
  out.assign(count, parent);
  for (std::uint32_t v = 0; v < count; ++v) {
    const float id = ids_.empty() ? static_cast<float>(v) : ids_[v];
    if (!(id >= 0.0F) || id >= 16777216.0F || static_cast<int>(id) == null_id) continue;
    const auto row = static_cast<std::uint32_t>(id);
    if (known != nullptr) {
      if (row < known->size()) out[v] = (*known)[row];
      continue;
    }
    if (mesh.features.size() >= most_features_) continue;
    const auto [bare, is_new] =
        bare_.try_emplace({{described_by, parent}, row}, static_cast<FeatureId>(mesh.features.size()));
    if (is_new) mesh.features.push_back({"feature" + std::to_string(row), {}, parent});
    out[v] = bare->second;
  }
  return true;
}

}  // namespace lodestone
