// SPDX-License-Identifier: MIT
/// \file
/// Seeded sample models of any size: they stand in for data that cannot be shipped, in tests, benchmarks and the demo.
/// The same options give the same bytes on every machine.
#pragma once

#include <cstdint>

#include <lodestone/context.h>
#include <lodestone/mesh.h>

namespace lodestone {

enum class Roof : std::uint8_t { Flat, Gable, Hip, Spire };

struct GenerateOptions {
  /// Wanted triangles; the result lies within 5 % (houses: within the detail steps of a facade, never above 1.1 times).
  /// 0 = the kind's natural size.
  std::uint32_t triangles = 0;
  /// Texture images to spread over the model; 0 = the kind's natural number.
  std::uint32_t textures = 0;
  std::uint32_t texture_size_px = 1024;
  std::uint64_t seed = 1;
};

/// A detailed house: walls with recessed, framed and mullioned windows and doors, balconies with railings, cornices,
/// dormers, chimneys, on a flat, hip, gable or spire roof. Closed, manifold, Z up, walls exactly vertical, with semantic
/// features (WallSurface, RoofSurface, Window, Door, BuildingInstallation). Detail is added until `triangles` is met.
struct HouseOptions : GenerateOptions {
  Roof roof = Roof::Gable;
};
[[nodiscard]] Result<Mesh> generate_house(const HouseOptions& options, const Context& context = {});

/// Houses of every roof side by side along a street with pavements.
[[nodiscard]] Result<Mesh> generate_street(const GenerateOptions& options, const Context& context = {});

/// A stratified, fractured cliff with photo-like rock textures: one chart grid over several images, open border, UTM-size
/// origin.
[[nodiscard]] Result<Mesh> generate_outcrop(const GenerateOptions& options, const Context& context = {});

/// Eroded hills on a regular grid, with uv and one ortho-photo-like texture.
[[nodiscard]] Result<Mesh> generate_terrain(const GenerateOptions& options, const Context& context = {});

}  // namespace lodestone
