// SPDX-License-Identifier: MIT
// The only file that names Draco.
#include "gltf_draco.h"

#include <draco/compression/decode.h>

#include <cstring>
#include <limits>
#include <memory>
#include <string>

namespace lodestone {
namespace {

using tinygltf::Value;

// Counts what all primitives together unpack to.
struct Room {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
};

int whole_number(const Value& object, const std::string& key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsInt()) return -1;
  return object.Get(key).Get<int>();
}

// An accessor of its own for `bytes`.
int add_accessor(tinygltf::Model& model, const tinygltf::Accessor& like, std::size_t count,
                 std::vector<std::uint8_t> bytes) {
  tinygltf::BufferView view;
  view.buffer = static_cast<int>(model.buffers.size());
  view.byteLength = bytes.size();
  tinygltf::Buffer buffer;
  buffer.data = std::move(bytes);
  model.buffers.push_back(std::move(buffer));
  model.bufferViews.push_back(std::move(view));
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
  accessor.componentType = like.componentType;
  accessor.type = like.type;
  accessor.normalized = like.normalized;
  accessor.count = count;
  model.accessors.push_back(std::move(accessor));
  return static_cast<int>(model.accessors.size()) - 1;
}

template <class T>
bool copy_values(const draco::PointAttribute& from, std::uint32_t points, int components,
                 std::vector<std::uint8_t>& bytes) {
  const std::size_t size = sizeof(T) * static_cast<std::size_t>(components);
  bytes.resize(size * points);
  std::vector<T> element(static_cast<std::size_t>(components));
  for (std::uint32_t p = 0; p < points; ++p) {
    const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex{p});
    if (at.value() >= from.size()) return false;
    if (!from.ConvertValue<T>(at, static_cast<std::int8_t>(components), element.data())) return false;
    std::memcpy(bytes.data() + p * size, element.data(), size);
  }
  return true;
}

// Values as the accessor declares them.
bool copy_attribute(const draco::PointAttribute& from, std::uint32_t points, const tinygltf::Accessor& as,
                    std::vector<std::uint8_t>& bytes) {
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(as.type));
  if (components < 1 || components > 4 || from.num_components() != components) return false;
  switch (as.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return copy_values<std::int8_t>(from, points, components, bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return copy_values<std::uint8_t>(from, points, components, bytes);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return copy_values<std::int16_t>(from, points, components, bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return copy_values<std::uint16_t>(from, points, components, bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return copy_values<std::uint32_t>(from, points, components, bytes);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return copy_values<float>(from, points, components, bytes);
    default:
      return false;
  }
}

std::vector<std::uint8_t> triangle_list(const draco::Mesh& mesh) {
  std::vector<std::uint8_t> bytes(std::size_t{mesh.num_faces()} * 3 * sizeof(std::uint32_t));
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex{f});
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t point = face[c].value();
      std::memcpy(bytes.data() + (3 * std::size_t{f} + c) * sizeof point, &point, sizeof point);
    }
  }
  return bytes;
}

Result<std::unique_ptr<draco::Mesh>> decode(std::span<const std::uint8_t> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  std::string problem;
  try {
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (mesh.ok() && mesh.value() != nullptr) return std::move(mesh).value();
    problem = mesh.status().error_msg_string();
  } catch (const std::exception& thrown) {
    problem = thrown.what();
  }
  return Error{ErrorCode::BadData, "holds Draco data that cannot be unpacked (" + problem + ")", {}};
}

Status unpack(tinygltf::Model& model, tinygltf::Primitive& primitive, const Value& extension,
              const ReadOptions& options, Room& used) {
  auto mesh = decode(view_bytes(model, whole_number(extension, "bufferView")));
  if (!mesh) return mesh.error();
  const std::uint32_t points = (*mesh)->num_points();
  used.vertices += points;
  used.triangles += (*mesh)->num_faces();
  if (used.vertices > options.max_vertices || used.triangles > options.max_triangles) {
    return Error{ErrorCode::TooLarge, "unpacks to more than the limit on counts", {}};
  }
  const Value attributes = extension.Has("attributes") ? extension.Get("attributes") : Value{};
  for (auto& [name, accessor] : primitive.attributes) {
    const int id = whole_number(attributes, name);
    if (id < 0) continue;  // not compressed
    const draco::PointAttribute* from = (*mesh)->GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
    const bool known = accessor >= 0 && static_cast<std::size_t>(accessor) < model.accessors.size();
    std::vector<std::uint8_t> bytes;
    if (from == nullptr || !known || !copy_attribute(*from, points, model.accessors[accessor], bytes)) {
      return Error{ErrorCode::BadData, "has Draco data that do not fit the accessor of " + name, {}};
    }
    const tinygltf::Accessor like = model.accessors[accessor];
    accessor = add_accessor(model, like, points, std::move(bytes));
  }
  tinygltf::Accessor index;
  index.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  index.type = TINYGLTF_TYPE_SCALAR;
  primitive.indices = add_accessor(model, index, std::size_t{(*mesh)->num_faces()} * 3, triangle_list(**mesh));
  primitive.mode = TINYGLTF_MODE_TRIANGLES;  // Draco's faces are triangles, also where the file says strip
  return Done{};
}

}  // namespace

Status unpack_draco(tinygltf::Model& model, const ReadOptions& options) {
  Room used;
  for (std::size_t m = 0; m < model.meshes.size(); ++m) {
    for (std::size_t p = 0; p < model.meshes[m].primitives.size(); ++p) {
      tinygltf::Primitive& primitive = model.meshes[m].primitives[p];
      if (!only_draco(model, primitive)) continue;
      if (auto done = unpack(model, primitive, primitive.extensions.at(draco_extension), options, used); !done) {
        return Error{done.error().code, done.error().message,
                     "mesh " + std::to_string(m) + ", primitive " + std::to_string(p)};
      }
    }
  }
  return Done{};
}

}  // namespace lodestone
