// SPDX-License-Identifier: MIT
// What the mesh writers share. Each checks its mesh, writes beside the target and renames; textures are written before
// the file that names them, and all that was written is taken away again if the call fails or is cancelled.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/formats.h>

#include "output_file.h"

namespace lodestone {

[[nodiscard]] Status write_obj(const Mesh& mesh, const std::filesystem::path& file, const Context& context);
[[nodiscard]] Status write_ply(const Mesh& mesh, const std::filesystem::path& file, const Context& context);
[[nodiscard]] Status write_glb(const Mesh& mesh, const std::filesystem::path& file, const Context& context);

// One level of MSFT_lod: shown while the model covers at least this share of the screen, 0..1.
struct GltfLevel {
  const Mesh* mesh = nullptr;
  double least_coverage = 0.0;
};
// How a renderer shall treat textured materials.
enum class GltfLook : std::uint8_t {
  Lit,
  Photograph,  // light is in the picture already (KHR_materials_unlit), and it does not repeat
};
// Under EXT_meshopt_compression, with KHR_mesh_quantization for normals: positions and uvs become whole multiples of
// powers of two. Meshes that shall meet need the same exponents.
struct GltfPacking {
  int position_exponent = 0;
  int uv_exponent = 0;
};
struct GltfStyle {
  GltfLook look = GltfLook::Lit;
  std::optional<GltfPacking> packing = std::nullopt;
};
// A GLB; the finest level first. Precondition: at least one, all levels of one model.
[[nodiscard]] Status write_gltf_levels(std::span<const GltfLevel> levels, const std::filesystem::path& file,
                                       const Context& context, const GltfStyle& style = {});

// An OutputFile behind a block of memory, watched by a Context.
class BlockWriter {
 public:
  BlockWriter(OutputFile file, std::string name, const Context& context, std::uint64_t expected_bytes)
      : file_{std::move(file)}, name_{std::move(name)}, context_{context}, expected_bytes_{expected_bytes} {}

  void text(std::string_view words) { block_.append(words); }
  template <class Number>
  void number(Number value) {
    char digits[32];
    block_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }
  template <class Value>
  void raw(const Value& value) {
    block_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  // Call between lines or elements; false once cancelled.
  [[nodiscard]] bool pass() {
    constexpr std::size_t block_bytes = 1U << 20;
    if (block_.size() >= block_bytes) flush();
    return !cancelled_;
  }
  // All is on its way to the disk, or an error; commit() then only renames.
  [[nodiscard]] Status finish();
  [[nodiscard]] Status commit();

 private:
  void flush();
  OutputFile file_;
  std::string name_;
  const Context& context_;
  std::uint64_t expected_bytes_;
  std::uint64_t done_bytes_ = 0;
  std::string block_;
  bool cancelled_ = false;
  bool finished_ = false;
};

// A texture's bytes as a file would hold them: those it came with, those on disk, or its pixels as PNG.
struct EncodedTexture {
  std::vector<std::uint8_t> bytes;
  std::string mime_type;
};
[[nodiscard]] Result<EncodedTexture> encoded_texture(const Texture& texture);

// Textures written beside a mesh, in the folder "<stem>_textures".
class TextureFiles {
 public:
  TextureFiles() = default;
  TextureFiles(const TextureFiles&) = delete;
  TextureFiles& operator=(const TextureFiles&) = delete;
  ~TextureFiles();  // without keep(): removes them again

  // Writes all; one that cannot be had is a warning and gets no name.
  [[nodiscard]] Status write(const Mesh& mesh, const std::filesystem::path& mesh_file, std::vector<Warning>& warnings);
  // Relative to the mesh's file, with '/'; empty if it could not be written.
  [[nodiscard]] const std::string& name(std::uint32_t texture) const { return names_[texture]; }
  void keep() noexcept { kept_ = true; }

 private:
  std::vector<std::string> names_;
  std::vector<std::filesystem::path> written_;
  std::filesystem::path new_folder_;
  bool kept_ = false;
};

}  // namespace lodestone
