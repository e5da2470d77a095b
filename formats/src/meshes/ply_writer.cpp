// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>

#include "header_comments.h"
#include "writers.h"

namespace lodestone {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written as it lies in memory");

// The number of a face's texture among the files that the header lists; one past the last for faces without.
std::uint32_t texture_number(const Mesh& mesh, FaceId f) {
  const std::uint32_t texture = mesh.materials[mesh.face_material(f)].texture;
  return texture == none ? static_cast<std::uint32_t>(mesh.textures.size()) : texture;
}

void write_header(const Mesh& mesh, const TextureFiles& textures, bool far, bool numbered, BlockWriter& out) {
  const VertexArrays& v = mesh.vertices;
  out.text("ply\nformat binary_little_endian 1.0\ncomment Lodestone\n");
  out.text(place_comments(mesh, "comment "));
  for (std::uint32_t i = 0; i < mesh.textures.size(); ++i) {
    const std::string& name = textures.name(i);
    out.text("comment TextureFile " + (name.empty() ? std::string{"missing"} : name) + "\n");
  }
  out.text("element vertex " + std::to_string(v.positions.size()) + "\n");
  for (const char* name : {"x", "y", "z"})
    out.text(std::string{far ? "property double " : "property float "} + name + "\n");
  if (!v.normals.empty()) out.text("property float nx\nproperty float ny\nproperty float nz\n");
  if (!v.uvs.empty()) out.text("property float s\nproperty float t\n");
  if (!v.colors.empty())
    out.text("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n");
  out.text("element face " + std::to_string(mesh.triangle_count()) + "\nproperty list uchar int vertex_indices\n");
  if (numbered) out.text("property int texnumber\n");
  out.text("end_header\n");
}

}  // namespace

// Materials become texture numbers; their colours and names have no place in a PLY file.
Status write_ply(const Mesh& mesh, const std::filesystem::path& file, const Context& context) {
  std::vector<Warning> warnings;
  TextureFiles textures;
  if (auto done = textures.write(mesh, file, warnings); !done) return done;
  auto created = OutputFile::create(file);
  if (!created) return created.error();
  const VertexArrays& v = mesh.vertices;
  const std::uint64_t expected_bytes = 36ULL * v.positions.size() + 13ULL * mesh.triangle_count();
  BlockWriter out{std::move(*created), file.string(), context, expected_bytes};
  const bool far = mesh.origin != glm::dvec3{0.0};
  bool numbered = false;
  for (FaceId f = 0; f < mesh.triangle_count(); ++f) numbered |= texture_number(mesh, f) != 0;
  numbered = numbered && !mesh.textures.empty();
  write_header(mesh, textures, far, numbered, out);
  for (std::size_t i = 0; i < v.positions.size() && out.pass(); ++i) {
    if (far) {
      out.raw(mesh.origin + glm::dvec3{v.positions[i]});
    } else {
      out.raw(v.positions[i]);
    }
    if (!v.normals.empty()) out.raw(v.normals[i]);
    if (!v.uvs.empty()) out.raw(v.uvs[i]);
    if (!v.colors.empty()) out.raw(v.colors[i]);
  }
  for (FaceId f = 0; f < mesh.triangle_count() && out.pass(); ++f) {
    out.raw(std::uint8_t{3});
    for (int c = 0; c < 3; ++c) out.raw(mesh.indices[3 * std::size_t{f} + c]);
    if (numbered) out.raw(texture_number(mesh, f));
  }
  if (auto done = out.commit(); !done) return done;
  textures.keep();
  return {Done{}, std::move(warnings)};
}

}  // namespace lodestone
