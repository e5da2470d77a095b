// SPDX-License-Identifier: MIT
#include "writers.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "reader.h"

namespace lodestone {
namespace {

// A file name that every system takes: letters, digits, and a few signs.
std::string plain_name(const Texture& texture, std::size_t index) {
  std::string from = texture.path.empty() ? texture.name : texture.path;
  std::replace(from.begin(), from.end(), '\\', '/');
  std::string name = std::filesystem::path{from}.stem().string();
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  }
  constexpr std::size_t longest = 80;
  if (name.empty()) name = "texture" + std::to_string(index);
  return name.substr(0, longest);
}

std::string extension_of(const std::string& mime_type) {
  if (mime_type == "image/jpeg") return ".jpg";
  if (mime_type == "image/webp") return ".webp";
  if (mime_type == "image/gif") return ".gif";
  if (mime_type == "image/bmp") return ".bmp";
  return ".png";
}

}  // namespace

void BlockWriter::flush() {
  if (context_.cancelled()) cancelled_ = true;
  if (!cancelled_) file_.write(block_);
  done_bytes_ += block_.size();
  block_.clear();
  if (expected_bytes_ > 0) {
    context_.report("writing", std::min(1.0, static_cast<double>(done_bytes_) / static_cast<double>(expected_bytes_)));
  }
}

Status BlockWriter::finish() {
  flush();
  finished_ = true;
  if (cancelled_) return Error{ErrorCode::Cancelled, "writing was cancelled", name_};
  return Done{};
}

Status BlockWriter::commit() {
  if (!finished_) {
    if (auto done = finish(); !done) return done;
  }
  return file_.commit();
}

Result<EncodedTexture> encoded_texture(const Texture& texture) {
  if (texture.encoded && !texture.encoded->empty()) {
    const std::string type = image_mime_type(*texture.encoded);
    if (!type.empty()) return EncodedTexture{*texture.encoded, type};
  }
  if (!texture.image && !texture.path.empty()) {
    constexpr std::uint64_t max_bytes = 1ULL << 30;
    auto input = Input::open(texture.path, max_bytes);
    auto bytes = input ? input->read_all() : Result<std::vector<std::uint8_t>>{input.error()};
    if (!bytes) return bytes.error();
    std::string type = image_mime_type(*bytes);
    if (!type.empty()) return EncodedTexture{std::move(*bytes), std::move(type)};
  }
  if (texture.image && !texture.image->empty()) {
    auto png = encode_png(*texture.image);
    if (!png) return png.error();
    return EncodedTexture{std::move(*png), "image/png"};
  }
  return Error{ErrorCode::BadData, "has neither pixels nor a file of a known kind", texture.name};
}

Status TextureFiles::write(const Mesh& mesh, const std::filesystem::path& mesh_file, std::vector<Warning>& warnings) {
  names_.resize(mesh.textures.size());
  if (mesh.textures.empty()) return Done{};
  const std::filesystem::path folder_name = mesh_file.stem().string() + "_textures";
  const std::filesystem::path folder = mesh_file.parent_path() / folder_name;
  std::error_code error;
  if (std::filesystem::create_directory(folder, error)) new_folder_ = folder;
  if (error) return Error{ErrorCode::Unreadable, "cannot be made: " + error.message(), folder.string()};
  std::set<std::string> taken;
  for (std::size_t i = 0; i < mesh.textures.size(); ++i) {
    auto encoded = encoded_texture(mesh.textures[i]);
    if (!encoded) {
      warnings.push_back({"a texture was left out: it " + encoded.error().message, encoded.error().where});
      continue;
    }
    std::string name = plain_name(mesh.textures[i], i);
    const std::string extension = extension_of(encoded->mime_type);
    if (!taken.insert(name + extension).second) {
      name += '_' + std::to_string(i);
      taken.insert(name + extension);
    }
    const std::filesystem::path target = folder / (name + extension);
    const bool is_new = !std::filesystem::exists(target, error);
    if (auto done = write_whole_file(target, encoded->bytes); !done) return done;
    if (is_new) written_.push_back(target);
    names_[i] = (folder_name / (name + extension)).generic_string();
  }
  return Done{};
}

TextureFiles::~TextureFiles() {
  if (kept_) return;
  std::error_code ignored;
  for (const auto& file : written_) std::filesystem::remove(file, ignored);
  if (!new_folder_.empty()) std::filesystem::remove(new_folder_, ignored);
}

Status write_mesh(const Mesh& mesh, const std::filesystem::path& file, const Context& context) {
  if (auto valid = validate(mesh); !valid) {
    return Error{ErrorCode::BadArgument, "the mesh to write is not valid: " + valid.error().message, file.string()};
  }
  const std::string extension = Input::from_bytes({}, file.string()).extension();
  if (extension == ".obj") return write_obj(mesh, file, context);
  if (extension == ".ply") return write_ply(mesh, file, context);
  if (extension == ".glb") return write_glb(mesh, file, context);
  return Error{ErrorCode::BadArgument, "meshes are written as .obj, .ply or .glb", file.string()};
}

}  // namespace lodestone
