// SPDX-License-Identifier: MIT
#define XXH_INLINE_ALL  // header only
#include "tiles3d/build_record.h"

#include <xxhash.h>
#include <nlohmann/json.hpp>

#include <cinttypes>

#include "reader.h"
#include "tiles3d/jobs.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;
constexpr int build_version = 5;  // of what tiles look like; raise it when they change
constexpr std::uint64_t most_file_bytes = 1ULL << 40;

std::string as_text(const Json& record) { return record.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

std::string in_hex(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, hash);
  return text;
}

template <class T>
std::uint64_t hash_of(const std::vector<T>& values, std::uint64_t seed) {
  return XXH64(values.data(), values.size() * sizeof(T), seed);
}

std::uint64_t hash_of(const std::string& text, std::uint64_t seed) {
  return XXH64(text.data(), text.size(), XXH64(nullptr, 0, seed + text.size()));
}

// Without its photographs: a missing one that has come changes which material has which.
std::uint64_t hash_of(const Mesh& mesh) {
  std::uint64_t hash = hash_of(mesh.vertices.positions, build_version);
  hash = hash_of(mesh.vertices.uvs, hash);
  hash = hash_of(mesh.vertices.normals, hash);
  hash = hash_of(mesh.vertices.colors, hash);
  hash = hash_of(mesh.indices, hash);
  hash = hash_of(mesh.face_materials, hash);
  hash = hash_of(mesh.face_features, hash);
  hash = hash_of(mesh.crs, hash);
  std::vector<double> numbers{mesh.origin.x, mesh.origin.y, mesh.origin.z};
  for (const Material& m : mesh.materials) {
    const glm::vec4& c = m.base_color;
    numbers.insert(numbers.end(), {c.r, c.g, c.b, c.a, m.alpha_cutoff, m.double_sided ? 1.0 : 0.0});
    hash = hash_of(m.name, hash);
  }
  for (const Feature& feature : mesh.features) {
    numbers.push_back(feature.parent);
    hash = hash_of(feature.semantic_class, hash_of(feature.id, hash));
  }
  return hash_of(numbers, hash);
}

std::uint64_t hash_of(const TilesetOptions& options) {
  const std::vector<double> numbers{options.pyramid.ratio,
                                    options.pyramid.texture_ratio,
                                    static_cast<double>(options.pyramid.tile_bytes),
                                    static_cast<double>(options.pyramid.split),
                                    static_cast<double>(options.image),
                                    static_cast<double>(options.jpeg_quality),
                                    static_cast<double>(options.compression),
                                    static_cast<double>(options.version)};
  return hash_of(numbers, build_version);
}

// Of a file that cannot be read: that of an empty one.
std::uint64_t hash_of_file(const std::string& path, const Context& context) {
  const auto input = Input::open(path, most_file_bytes);
  if (!input) return hash_of(std::vector<std::uint8_t>{}, 0);
  std::vector<std::uint8_t> part(std::min<std::uint64_t>(input->size(), 1U << 20U));
  std::uint64_t hash = 0;
  std::uint64_t at = 0;
  while (at < input->size() && !context.cancelled()) {
    const std::size_t count = input->read(at, part);
    if (count == 0) break;
    hash = XXH64(part.data(), count, hash);
    at += count;
  }
  return hash;
}

std::uint64_t hash_of(const Texture& texture, const Context& context) {
  if (const Image* image = texture.image.get(); image != nullptr) {
    return hash_of(std::vector<std::uint32_t>{image->width, image->height, image->channels}, hash_of(image->pixels, 0));
  }
  if (texture.encoded && !texture.encoded->empty()) return hash_of(*texture.encoded, 0);
  return hash_of_file(texture.path, context);
}

}  // namespace

Result<std::string> record_build(const Mesh& mesh, const TilesetOptions& options, const Context& context) {
  const std::size_t count = mesh.textures.size();
  std::vector<std::uint64_t> hashes(count);
  Context quiet;
  quiet.cancel = context.cancel;
  const Status read = run_jobs(count, workers_of(context), quiet, [&](std::size_t i) -> Status {
    hashes[i] = hash_of(mesh.textures[i], quiet);
    return Done{};
  });
  if (!read) return read.error();
  for (MaterialId m = 0; m < mesh.materials.size(); ++m) {  // who shows it is part of it
    const std::uint32_t texture = mesh.materials[m].texture;
    if (texture != none) hashes[texture] = hash_of(std::vector<MaterialId>{m}, hashes[texture]);
  }
  Json photographs = Json::object();
  for (std::size_t i = 0; i < count; ++i) photographs[mesh.textures[i].name] = in_hex(hashes[i]);
  const Json record{{"format", "lodestone outcrop"},
                    {"version", build_version},
                    {"mesh", in_hex(hash_of(mesh))},
                    {"options", in_hex(hash_of(options))},
                    {"photographs", std::move(photographs)}};
  return as_text(record);
}

std::string with_damaged(const std::string& record, const DamagedPhotographs& damaged) {
  Json out = Json::parse(record);
  out["damaged"] = damaged;
  return as_text(out);
}

DamagedPhotographs damaged_photographs(const std::string& found) {
  const Json record = Json::parse(found, nullptr, false);
  DamagedPhotographs damaged;
  if (!record.is_object() || !record.contains("damaged")) return damaged;
  for (const auto& [name, reason] : record["damaged"].items()) {
    if (reason.is_string()) damaged[name] = reason.get<std::string>();
  }
  return damaged;
}

Result<std::vector<std::string>> changed_photographs(const std::string& found, const std::string& wanted) {
  const Json then = Json::parse(found, nullptr, false);
  const Json now = Json::parse(wanted);
  const auto refuse = [](const std::string& what) {
    return Error{ErrorCode::BadArgument, "the folder was made " + what + ", leave --resume out to write over it", ""};
  };
  const auto same = [&](const char* key) { return then.contains(key) && then[key] == now[key]; };
  if (!then.is_object() || !same("format") || !same("version")) return refuse("by another version of this program");
  if (!same("mesh")) return refuse("from another mesh");
  if (!same("options")) return refuse("with other options");
  std::vector<std::string> changed;
  const Json none_then = Json::object();
  const Json& photographs =
      then.contains("photographs") && then["photographs"].is_object() ? then["photographs"] : none_then;
  for (const auto& [name, hash] : now["photographs"].items()) {
    if (!photographs.contains(name) || photographs[name] != hash) changed.push_back(name);
  }
  for (const auto& [name, hash] : photographs.items()) {
    if (!now["photographs"].contains(name)) changed.push_back(name);
  }
  return changed;
}

}  // namespace lodestone
