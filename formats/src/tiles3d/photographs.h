// SPDX-License-Identifier: MIT
// The source's images: their sizes without decoding, their pixels one at a time.
#pragma once

#include <cstdint>

#include <lodestone/formats.h>
#include <lodestone/outcrop.h>

#include "reader.h"
#include "tiles3d/outcrop_memory.h"

namespace lodestone {

// Size 0 and a warning for a texture that is not there or is no image.
[[nodiscard]] Photograph look_at(const Texture& texture, std::vector<Warning>& warnings);

// The same for an image inside the mesh's file, without warnings.
[[nodiscard]] Photograph look_inside(const Input& input, std::uint64_t offset, std::uint64_t size_bytes);

[[nodiscard]] std::string name_of(const Texture& texture);

// "A texture cannot be used, its faces stay plain".
[[nodiscard]] Warning plain_warning(const std::string& reason, const std::string& name);

// Errors name the texture's file.
[[nodiscard]] Result<Image> decode_texture(const Texture& texture);

}  // namespace lodestone
