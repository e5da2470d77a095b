// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "header_comments.h"
#include "writers.h"

namespace lodestone {
namespace {

// Numbers the distinct values of an array, bit for bit, in order of first use: what OBJ indexes.
template <std::size_t Words>
class DistinctValues {
 public:
  using Key = std::array<std::uint32_t, Words>;

  explicit DistinctValues(std::size_t expected) : table_(std::bit_ceil(2 * expected + 2), none) {}

  // The value's number, and whether it is a new one. At most `expected` distinct values.
  std::pair<std::uint32_t, bool> add(const Key& key) {
    std::uint64_t hash = 0x9E3779B97F4A7C15ULL;
    for (const std::uint32_t word : key) {
      hash = (hash ^ word) * 0xBF58476D1CE4E5B9ULL;
      hash ^= hash >> 29;
    }
    const std::size_t mask = table_.size() - 1;
    for (std::size_t at = hash & mask;; at = (at + 1) & mask) {
      if (table_[at] == none) {
        table_[at] = static_cast<std::uint32_t>(keys_.size());
        keys_.push_back(key);
        return {table_[at], true};
      }
      if (keys_[table_[at]] == key) return {table_[at], false};
    }
  }

 private:
  std::vector<std::uint32_t> table_;
  std::vector<Key> keys_;
};

std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }

// One line of text: names must not break it.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\\'; }, '_');
  return text.empty() ? "unnamed" : text;
}

// Names that are distinct, since OBJ knows materials by name only.
std::vector<std::string> material_names(const Mesh& mesh) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    std::string name = one_line(mesh.materials[i].name);
    if (std::find(names.begin(), names.end(), name) != names.end()) name += '_' + std::to_string(i);
    names.push_back(std::move(name));
  }
  return names;
}

class ObjWriter {
 public:
  ObjWriter(const Mesh& mesh, BlockWriter& out) : mesh_{mesh}, out_{out} {}
  void write(const std::string& library);

 private:
  void write_positions();
  void write_normals();
  void write_uvs();
  void write_faces();

  const Mesh& mesh_;
  BlockWriter& out_;
  std::vector<std::string> materials_;
  std::vector<std::uint32_t> position_of_;
  std::vector<std::uint32_t> normal_of_;
  std::vector<std::uint32_t> uv_of_;
};

void ObjWriter::write_positions() {
  const VertexArrays& v = mesh_.vertices;
  DistinctValues<4> distinct{v.positions.size()};
  for (std::size_t i = 0; i < v.positions.size() && out_.pass(); ++i) {
    const glm::vec3& p = v.positions[i];
    const std::uint32_t color = v.colors.empty() ? 0 : std::bit_cast<std::uint32_t>(v.colors[i]);
    const auto [number, is_new] = distinct.add({bits(p.x), bits(p.y), bits(p.z), color});
    position_of_.push_back(number);
    if (!is_new) continue;
    out_.text("v");
    for (int a = 0; a < 3; ++a) {
      out_.text(" ");
      // The shortest text that reads back to the same number.
      if (mesh_.origin[a] == 0.0) {
        out_.number(p[a]);
      } else {
        out_.number(mesh_.origin[a] + static_cast<double>(p[a]));
      }
    }
    if (!v.colors.empty()) {
      for (int c = 0; c < 3; ++c) {
        out_.text(" ");
        out_.number(static_cast<float>(v.colors[i][c]) / 255.0F);
      }
    }
    out_.text("\n");
  }
}

void ObjWriter::write_normals() {
  const auto& normals = mesh_.vertices.normals;
  DistinctValues<3> distinct{normals.size()};
  for (std::size_t i = 0; i < normals.size() && out_.pass(); ++i) {
    const glm::vec3& n = normals[i];
    const auto [number, is_new] = distinct.add({bits(n.x), bits(n.y), bits(n.z)});
    normal_of_.push_back(number);
    if (!is_new) continue;
    out_.text("vn");
    for (int a = 0; a < 3; ++a) {
      out_.text(" ");
      out_.number(n[a]);
    }
    out_.text("\n");
  }
}

void ObjWriter::write_uvs() {
  const auto& uvs = mesh_.vertices.uvs;
  DistinctValues<2> distinct{uvs.size()};
  for (std::size_t i = 0; i < uvs.size() && out_.pass(); ++i) {
    const auto [number, is_new] = distinct.add({bits(uvs[i].x), bits(uvs[i].y)});
    uv_of_.push_back(number);
    if (!is_new) continue;
    out_.text("vt ");
    out_.number(uvs[i].x);
    out_.text(" ");
    out_.number(uvs[i].y);
    out_.text("\n");
  }
}

void ObjWriter::write_faces() {
  MaterialId material = none;
  FeatureId feature = none;
  for (FaceId f = 0; f < mesh_.triangle_count() && out_.pass(); ++f) {
    if (mesh_.face_feature(f) != feature) {
      feature = mesh_.face_feature(f);
      out_.text("g ");
      out_.text(feature == none ? "default" : one_line(mesh_.features[feature].id));
      out_.text("\n");
    }
    if (mesh_.face_material(f) != material) {
      material = mesh_.face_material(f);
      out_.text("usemtl ");
      out_.text(materials_[material]);
      out_.text("\n");
    }
    out_.text("f");
    for (int c = 0; c < 3; ++c) {
      const VertexId v = mesh_.indices[3 * std::size_t{f} + c];
      out_.text(" ");
      out_.number(position_of_[v] + 1);
      if (!uv_of_.empty() || !normal_of_.empty()) out_.text("/");
      if (!uv_of_.empty()) out_.number(uv_of_[v] + 1);
      if (normal_of_.empty()) continue;
      out_.text("/");
      out_.number(normal_of_[v] + 1);
    }
    out_.text("\n");
  }
}

void ObjWriter::write(const std::string& library) {
  materials_ = material_names(mesh_);
  out_.text("# Lodestone\n");
  out_.text(place_comments(mesh_, "# "));
  out_.text("mtllib " + library + "\n");
  write_positions();
  write_uvs();
  write_normals();
  write_faces();
}

void write_color(BlockWriter& out, const glm::vec4& color) {
  out.text("Kd");
  for (int c = 0; c < 3; ++c) {
    out.text(" ");
    out.number(color[c]);
  }
  out.text("\n");
  if (color.a < 1.0F) {
    out.text("d ");
    out.number(color.a);
    out.text("\n");
  }
}

void write_library(const Mesh& mesh, const TextureFiles& textures, BlockWriter& out) {
  const auto names = material_names(mesh);
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const Material& material = mesh.materials[i];
    out.text("newmtl " + names[i] + "\n");
    write_color(out, material.base_color);
    if (material.texture != none && !textures.name(material.texture).empty()) {
      out.text("map_Kd " + textures.name(material.texture) + "\n");
      if (material.alpha_cutoff > 0.0F) out.text("map_d " + textures.name(material.texture) + "\n");
    }
    out.text("\n");
  }
}

}  // namespace

Status write_obj(const Mesh& mesh, const std::filesystem::path& file, const Context& context) {
  std::vector<Warning> warnings;
  TextureFiles textures;
  if (auto done = textures.write(mesh, file, warnings); !done) return done;
  std::filesystem::path library = file;
  library.replace_extension(".mtl");
  auto mtl_file = OutputFile::create(library);
  if (!mtl_file) return mtl_file.error();
  auto obj_file = OutputFile::create(file);
  if (!obj_file) return obj_file.error();
  constexpr std::uint64_t bytes_per_vertex = 80;
  BlockWriter obj{std::move(*obj_file), file.string(), context, bytes_per_vertex * mesh.vertex_count()};
  ObjWriter{mesh, obj}.write(library.filename().string());
  BlockWriter mtl{std::move(*mtl_file), library.string(), context, 0};
  write_library(mesh, textures, mtl);
  if (auto done = obj.finish(); !done) return done;
  // The library first: an OBJ in its place is then always whole.
  if (auto done = mtl.commit(); !done) return done;
  if (auto done = obj.commit(); !done) return done;
  textures.keep();
  return {Done{}, std::move(warnings)};
}

}  // namespace lodestone
