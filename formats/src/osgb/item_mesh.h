// SPDX-License-Identifier: MIT
// OpenSceneGraph's geometry as a mesh.
#pragma once

#include <span>
#include <string>

#include "osgb/read_tree.h"

namespace lodestone::osgb {

// From now on JPEG, PNG and WebP that OSG comes upon are kept as they are, not decoded.
void keep_textures_encoded();

[[nodiscard]] Box bounds_of(const Item& item);

// One material per texture, the first of a state set's units. Errors: Unsupported for vertices, or pixels of a texture,
// in a form that is not known.
[[nodiscard]] Result<Mesh> mesh_of(std::span<const Item> items, const std::string& name);

}  // namespace lodestone::osgb
