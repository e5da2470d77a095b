// SPDX-License-Identifier: MIT
// A glTF 2.0 file or GLB as tinygltf's Model, with its buffers. Images stay encoded.
#pragma once

#include "gltf_accessors.h"
#include "reader.h"

namespace lodestone {

// BadData where the file breaks off, nests too deeply or is no glTF; Unsupported where it needs an unknown extension.
[[nodiscard]] Result<tinygltf::Model> parse_gltf(const Input& input, const ReadOptions& options);

}  // namespace lodestone
