// SPDX-License-Identifier: MIT
// tinygltf as packaged refuses index accessors without bytes of their own, which is what Draco leaves.
#include <nlohmann/json.hpp>

#include "gltf_draco.h"

namespace lodestone {
namespace {

using Json = nlohmann::json;

// The member of an object or the element of a list; null where there is none.
const Json& at(const Json& from, const char* key) {
  static const Json null;
  return from.is_object() && from.contains(key) ? from[key] : null;
}

bool without_bytes(const Json& accessors, const Json& index) {
  if (!index.is_number_unsigned() || !accessors.is_array() || index.get<std::uint64_t>() >= accessors.size()) {
    return false;
  }
  return !at(accessors[index.get<std::uint64_t>()], "bufferView").is_number();
}

}  // namespace

std::optional<std::string> without_packed_indices(std::string_view text) {
  if (text.find(draco_extension) == std::string_view::npos) return std::nullopt;
  Json json = Json::parse(text, nullptr, false);
  if (at(json, "meshes").is_null()) return std::nullopt;
  const Json& accessors = at(json, "accessors");
  for (Json& mesh : json["meshes"]) {
    if (!at(mesh, "primitives").is_array()) continue;
    for (Json& primitive : mesh["primitives"]) {
      const bool packed = !at(at(primitive, "extensions"), draco_extension).is_null();
      if (packed && without_bytes(accessors, at(primitive, "indices"))) primitive.erase("indices");
    }
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lodestone
