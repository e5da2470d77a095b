// SPDX-License-Identifier: MIT
// The building materials of generated houses and the pictures of them.
#pragma once

#include <cstdint>
#include <vector>

#include <lodestone/generate.h>
#include <lodestone/mesh.h>

namespace lodestone::generate {

// What a picture shows. The order is that in which textures are handed out.
enum class Cloth : std::uint8_t { Plaster, Tile, Stone, Wood, Trim, Metal, Slate, Gravel, Paving, Asphalt, Grass };
inline constexpr std::uint32_t house_cloths = 8;  // those a single house needs
inline constexpr std::uint32_t street_cloths = 11;

// Length in metres that one repetition of the picture covers.
[[nodiscard]] double tile_m(Cloth cloth) noexcept;

// Material ids of one house in its mesh, and how large each one's picture is.
struct Palette {
  MaterialId plaster = 0, tile = 0, stone = 0, wood = 0, trim = 0, metal = 0, slate = 0, gravel = 0;
  MaterialId frame = 0, glass = 0, shutter = 0;
};

// Adds the textures that options ask for, of the first `cloths` kinds.
void add_textures(Mesh& mesh, const GenerateOptions& options, std::uint32_t cloths, const Context& context);
// Adds a material of that cloth (textured if its texture is there) in a colour.
MaterialId add_material(Mesh& mesh, const char* name, Cloth cloth, const glm::vec3& tint, std::uint32_t number = none);
// Adds one house's materials, in colours drawn from the seed; `number` tells houses of a street apart.
[[nodiscard]] Palette add_palette(Mesh& mesh, std::uint64_t seed, std::uint32_t number = none);
// 1 / tile_m of a material, by its texture; 1 for plain ones.
[[nodiscard]] std::vector<double> uv_scales(const Mesh& mesh);

}  // namespace lodestone::generate
