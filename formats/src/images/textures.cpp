// SPDX-License-Identifier: MIT
#include <algorithm>

#include "codecs.h"
#include "reader.h"

namespace lodestone {
namespace {

std::uint32_t find_texture(const Mesh& mesh, const std::string& name) {
  for (std::size_t i = 0; i < mesh.textures.size(); ++i) {
    if (mesh.textures[i].name == name) return static_cast<std::uint32_t>(i);
  }
  return none;
}

std::uint32_t add_texture(Mesh& mesh, Texture texture, Bytes bytes, const ReadOptions& options, Warnings& warnings) {
  if (!bytes.empty()) {
    texture.mime_type = image_mime_type(bytes);
    if (options.textures == LoadTextures::Decoded) {
      auto image = decode_image(bytes, texture.path.empty() ? texture.name : texture.path, options.max_texture_pixels);
      if (!image) {
        warnings.add("a texture cannot be used: " + image.error().message, image.error().where);
        return none;
      }
      texture.image = std::make_shared<const Image>(std::move(*image));
    }
    texture.encoded = std::make_shared<const Bytes>(std::move(bytes));
  }
  mesh.textures.push_back(std::move(texture));
  return static_cast<std::uint32_t>(mesh.textures.size() - 1);
}

}  // namespace

std::uint32_t add_texture_file(Mesh& mesh, const std::string& name, const Input& model, const ReadOptions& options,
                               Warnings& warnings, const std::string& place) {
  if (const std::uint32_t known = find_texture(mesh, name); known != none) return known;
  const auto file = find_beside(model.folder(), name);
  if (!file) {
    std::error_code error;
    const bool is_folder = !name.empty() && std::filesystem::is_directory(model.folder() / name, error);
    warnings.add("the texture \"" + name + (is_folder ? "\" is a folder" : "\" is missing"),
                 place.empty() ? model.name() : place);
    return none;
  }
  Texture texture;
  texture.name = name;
  texture.path = file->string();
  if (options.textures == LoadTextures::Reference) return add_texture(mesh, std::move(texture), {}, options, warnings);
  auto input = Input::open(*file, options.max_file_bytes);
  auto bytes = input ? input->read_all() : Result<Bytes>{input.error()};
  if (!bytes) {
    warnings.add("the texture \"" + name + "\" cannot be read: " + bytes.error().message, bytes.error().where);
    return none;
  }
  if (image_mime_type(*bytes).empty() && input->extension() != ".tga") {
    warnings.add("the texture \"" + name + "\" is not an image of a kind that can be read", file->string());
    return none;
  }
  return add_texture(mesh, std::move(texture), std::move(*bytes), options, warnings);
}

std::uint32_t add_texture_bytes(Mesh& mesh, const std::string& name, std::vector<std::uint8_t> bytes,
                                const ReadOptions& options, Warnings& warnings) {
  if (const std::uint32_t known = find_texture(mesh, name); known != none) return known;
  if (image_mime_type(bytes).empty()) {
    warnings.add("the texture \"" + name + "\" is not an image of a kind that can be read");
    return none;
  }
  Texture texture;
  texture.name = name;
  return add_texture(mesh, std::move(texture), std::move(bytes), options, warnings);
}

}  // namespace lodestone
