// SPDX-License-Identifier: MIT
// Unpacks KHR_draco_mesh_compression.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "gltf_accessors.h"
#include "reader.h"

namespace lodestone {

inline constexpr const char* draco_extension = "KHR_draco_mesh_compression";

// Whether the data of a primitive are nowhere but in its Draco buffer; a file may hold them plainly as well.
[[nodiscard]] inline bool only_draco(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
  const auto plain = [&model](int accessor) {
    return accessor >= 0 && static_cast<std::size_t>(accessor) < model.accessors.size() &&
           model.accessors[accessor].bufferView >= 0;
  };
  const auto is_plain = [&plain](const auto& attribute) { return plain(attribute.second); };
  return primitive.extensions.count(draco_extension) != 0 &&
         !(plain(primitive.indices) && std::all_of(primitive.attributes.begin(), primitive.attributes.end(), is_plain));
}

// The JSON without those indices of primitives that only Draco's data hold; nothing if it does not speak of Draco.
[[nodiscard]] std::optional<std::string> without_packed_indices(std::string_view text);

// Gives every such primitive accessors and buffers of its own, as if the file had never been compressed.
// Decoded counts stay under the caps of `options`.
[[nodiscard]] Status unpack_draco(tinygltf::Model& model, const ReadOptions& options);

}  // namespace lodestone
