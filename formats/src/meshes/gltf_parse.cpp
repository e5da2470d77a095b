// SPDX-License-Identifier: MIT
// glTF 2.0 and GLB through tinygltf: what it cannot bear is kept from it.
#include "gltf_parse.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>

#include "gltf_draco.h"
#include "gltf_meshopt.h"

namespace lodestone {
namespace {

// tinygltf and its JSON parser recurse; deeper nesting than any sane file has would overflow the stack.
bool nested_too_deep(std::span<const std::uint8_t> json) {
  constexpr int deepest = 200;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = static_cast<char>(json[i]);
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > deepest) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

struct Folder {
  std::filesystem::path path;
  std::uint64_t max_bytes = 0;
};

// Files that a glTF names are found as forgivingly as those of an OBJ.
tinygltf::FsCallbacks file_access(Folder& folder) {
  tinygltf::FsCallbacks access{};
  access.FileExists = [](const std::string& name, void* user) {
    return find_beside(static_cast<const Folder*>(user)->path, name).has_value();
  };
  access.ExpandFilePath = [](const std::string& name, void*) { return name; };
  access.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& name, void* user) {
    const auto* where = static_cast<const Folder*>(user);
    const auto file = find_beside(where->path, name);
    auto input =
        file ? Input::open(*file, where->max_bytes) : Result<Input>{Error{ErrorCode::NotFound, "is missing", name}};
    auto bytes = input ? input->read_all() : Result<std::vector<std::uint8_t>>{input.error()};
    if (bytes)
      *out = std::move(*bytes);
    else
      *error = to_line(bytes.error());
    return bytes.ok();
  };
  access.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  access.user_data = &folder;
  return access;
}

// Images stay encoded, those in a buffer stay there.
bool keep_image(tinygltf::Image* image, const int, std::string*, std::string*, int, int, const unsigned char* bytes,
                int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) | (std::uint32_t{bytes[at + 3]} << 24);
}

void put_word(std::vector<std::uint8_t>& bytes, std::size_t at, std::size_t value) {
  for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
}

constexpr std::size_t before_json = 20;  // bytes of a GLB

// Precondition: a GLB has its header.
std::span<const std::uint8_t> json_of(std::span<const std::uint8_t> file, bool binary) {
  if (!binary) return file;
  return file.subspan(before_json).first(std::min<std::size_t>(word(file, 12), file.size() - before_json));
}

// The file with another JSON text in place of the `old_size` bytes after the first `begin`.
std::vector<std::uint8_t> with_json(const std::vector<std::uint8_t>& file, std::size_t begin, std::size_t old_size,
                                    std::string text) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::vector<std::uint8_t> changed{file.begin(), file.begin() + static_cast<std::ptrdiff_t>(begin)};
  changed.insert(changed.end(), text.begin(), text.end());
  changed.insert(changed.end(), file.begin() + static_cast<std::ptrdiff_t>(begin + old_size), file.end());
  if (begin > 0) {  // a file that is cut off stays one
    put_word(changed, 8, word(file, 8) + changed.size() - file.size());
    put_word(changed, 12, text.size());
  }
  return changed;
}

std::string first_line(const std::string& text) { return text.substr(0, std::min(text.find('\n'), std::size_t{200})); }

// The first extension that the file cannot be read without and that is not known here.
const std::string* unknown_extension(const tinygltf::Model& model) {
  static constexpr std::array known{"KHR_texture_transform", "KHR_mesh_quantization",
                                    "KHR_materials_unlit",   "EXT_texture_webp",
                                    draco_extension,         "KHR_materials_pbrSpecularGlossiness"};
  const auto& needed = model.extensionsRequired;
  const auto found = std::find_if(needed.begin(), needed.end(), [](const std::string& name) {
    return std::find(known.begin(), known.end(), name) == known.end();
  });
  return found == needed.end() ? nullptr : &*found;
}

}  // namespace

Result<tinygltf::Model> parse_gltf(const Input& input, const ReadOptions& options) {
  auto bytes = input.read_all();
  if (!bytes) return bytes.error();
  const bool binary = bytes->size() >= 4 && std::equal(bytes->begin(), bytes->begin() + 4, "glTF");
  if (binary && bytes->size() < before_json) {
    return Error{ErrorCode::BadData, "is cut off in its header", input.name()};
  }
  if (nested_too_deep(json_of(*bytes, binary))) {
    return Error{ErrorCode::BadData, "nests deeper than 200 levels", input.name()};
  }
  bytes = without_meshopt(std::move(*bytes), input.name());
  if (!bytes) return bytes.error();
  const std::span<const std::uint8_t> json = json_of(*bytes, binary);
  if (auto text = without_packed_indices({reinterpret_cast<const char*>(json.data()), json.size()})) {
    *bytes = with_json(*bytes, binary ? before_json : 0, json.size(), std::move(*text));
  }
  constexpr std::uint64_t most = 0xFFFFFFFFU;
  if (bytes->size() > most) return too_large(input, "bytes", bytes->size(), most);
  Folder folder{input.folder(), options.max_file_bytes};
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(file_access(folder));
  loader.SetImageLoader(keep_image, nullptr);
  tinygltf::Model model;
  std::string error;
  std::string warning;
  const auto size = static_cast<unsigned int>(bytes->size());
  bool good = false;
  try {
    good = binary ? loader.LoadBinaryFromMemory(&model, &error, &warning, bytes->data(), size)
                  : loader.LoadASCIIFromString(&model, &error, &warning, reinterpret_cast<const char*>(bytes->data()),
                                               size, "");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& thrown) {
    error = thrown.what();
  }
  if (!good) {
    return Error{ErrorCode::BadData, "is not valid glTF 2.0" + (error.empty() ? "" : " (" + first_line(error) + ")"),
                 input.name()};
  }
  if (const std::string* needed = unknown_extension(model)) {
    return Error{ErrorCode::Unsupported, "needs the glTF extension " + *needed + ", which is not supported",
                 input.name()};
  }
  return model;
}

}  // namespace lodestone
