// SPDX-License-Identifier: MIT
// Meshes on their way from one process to another, or back.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <lodestone/mesh.h>

namespace lodestone {

// Both directions of the way through a file: one list of fields serves writing and reading.
class Packer {
 public:
  explicit Packer(std::FILE* file) : file_{file} {}
  template <class T>
  void plain(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    good_ = good_ && std::fwrite(&value, sizeof value, 1, file_) == 1;
  }
  template <class Array>
  void array(Array& values) {
    std::uint64_t count = values.size();
    plain(count);
    if (count == 0) return;  // an empty array may have no address
    good_ = good_ && std::fwrite(values.data(), sizeof values[0], count, file_) == count;
  }
  template <class List, class Field>
  void list(List& values, const Field& field) {
    std::uint64_t count = values.size();
    plain(count);
    for (auto& value : values) field(value);
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  std::FILE* file_;
  bool good_ = true;
};

class Unpacker {
 public:
  Unpacker(std::FILE* file, std::uint64_t size_bytes) : file_{file}, left_{size_bytes} {}
  template <class T>
  void plain(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (!take(sizeof value) || std::fread(&value, sizeof value, 1, file_) != 1) good_ = false;
  }
  template <class Array>
  void array(Array& values) {
    std::uint64_t count = 0;
    plain(count);
    if (!good_ || count > left_ / sizeof values[0] || !take(count * sizeof values[0])) {
      good_ = false;
      return;
    }
    values.resize(count);
    if (count == 0) return;
    good_ = std::fread(values.data(), sizeof values[0], count, file_) == count;
  }
  template <class List, class Field>
  void list(List& values, const Field& field) {
    std::uint64_t count = 0;
    plain(count);
    if (count > left_) good_ = false;
    for (std::uint64_t i = 0; good_ && i < count; ++i) {
      values.emplace_back();
      field(values.back());
    }
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  bool take(std::uint64_t bytes) {
    if (bytes > left_)
      good_ = false;
    else
      left_ -= bytes;
    return good_;
  }
  std::FILE* file_;
  std::uint64_t left_;
  bool good_ = true;
};

template <class Archive>
void texture_fields(Archive& archive, Texture& texture) {
  archive.array(texture.name);
  archive.array(texture.path);
  archive.array(texture.mime_type);
  std::vector<std::uint8_t> encoded = texture.encoded ? *texture.encoded : std::vector<std::uint8_t>{};
  archive.array(encoded);
  if (!encoded.empty()) texture.encoded = std::make_shared<const std::vector<std::uint8_t>>(std::move(encoded));
  Image image = texture.image ? *texture.image : Image{};
  archive.plain(image.width);
  archive.plain(image.height);
  archive.plain(image.channels);
  archive.array(image.pixels);
  if (!image.empty()) texture.image = std::make_shared<const Image>(std::move(image));
}

template <class Archive>
void mesh_fields(Archive& archive, Mesh& mesh) {
  archive.plain(mesh.origin);
  archive.array(mesh.crs);
  archive.list(mesh.materials, [&](Material& m) {
    archive.array(m.name);
    archive.plain(m.base_color);
    archive.plain(m.texture);
    archive.plain(m.alpha_cutoff);
    archive.plain(m.double_sided);
  });
  archive.list(mesh.textures, [&](Texture& t) { texture_fields(archive, t); });
  archive.list(mesh.features, [&](Feature& f) {
    archive.array(f.id);
    archive.array(f.semantic_class);
    archive.plain(f.parent);
  });
  archive.array(mesh.vertices.positions);
  archive.array(mesh.vertices.normals);
  archive.array(mesh.vertices.uvs);
  archive.array(mesh.vertices.colors);
  archive.array(mesh.indices);
  archive.array(mesh.face_materials);
  archive.array(mesh.face_features);
}

}  // namespace lodestone
