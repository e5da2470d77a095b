// SPDX-License-Identifier: MIT
/// \file
/// Seeded sample models of any size: they stand in for data that cannot be shipped, in tests, benchmarks and the demo.
/// The same options give the same bytes for any number of threads.
///
/// All four return metres, Z up, with normals, uvs, materials, textures (pixels decoded, see Pixels) and an origin of
/// UTM size (`crs` is "EPSG:25832", the place is invented). ErrorCode::BadArgument if an option is out of its range.
#pragma once

#include <cstdint>

#include <lodestone/context.h>
#include <lodestone/mesh.h>

namespace lodestone {

enum class Roof : std::uint8_t { Flat, Gable, Hip, Spire };

/// What to do about the pixels of a generated mesh's textures.
enum class Pixels : std::uint8_t {
  Make,  ///< Fill Texture::image. 3 bytes a texel stay in memory: 103 images of 2048² are 1.3 GB.
  Skip,  ///< Leave Texture::image null; make each when it is needed with outcrop_texture() or terrain_texture().
};

struct GenerateOptions {
  /// Wanted triangles, at most 100 million; 0 = the kind's natural size (house 30,000, street 260,000, outcrop 200,000,
  /// terrain 130,000). House and street: an even number is met exactly, because curved ornament is divided until it is
  /// (an odd one less one); below the plainest house (2,500 to 4,500) or street (about 30,000) that one is returned.
  /// Outcrop and terrain: met within 2 % from 200 triangles a chart on.
  std::uint32_t triangles = 0;
  /// Texture images, at most 10,000; 0 = the kind's natural number (outcrop 4, terrain 1). House and street carry one
  /// image per building material; a smaller number here leaves the later materials plain, a larger one changes nothing.
  std::uint32_t textures = 0;
  /// Width and height of each image, 16 to 8192.
  std::uint32_t texture_size_px = 1024;
  std::uint64_t seed = 1;
  /// Outcrop and terrain: patches with a uv mapping of their own, as photogrammetry makes them, side by side in the
  /// images with gutters between; vertices on the seams are doubled. 0 = one per texture. At least `textures`.
  std::uint32_t charts = 0;
  Pixels pixels = Pixels::Make;
};

/// A detailed house with semantic features (Building > WallSurface > Window and Door, RoofSurface, GroundSurface,
/// BuildingInstallation).
///
/// The body (walls with recessed, framed and mullioned windows and doors, eaves, roof, dormers, chimneys, tower) is one
/// closed surface without self-intersection: every edge has two faces by position, walls are exactly vertical, all
/// corners lie on a grid of 1/1024 m, so that every facet is planar to the last bit of a float. Balconies, railings,
/// mouldings, shutters, roof tiles and steps are closed parts of their own that stand on the body or are let into it,
/// as in surveyed LoD3 data; no two parts share an edge. Facets carry flat normals, turned ornament smooth ones.
/// Textures repeat: one uv unit is the length in metres that the material's image shows.
struct HouseOptions : GenerateOptions {
  Roof roof = Roof::Gable;  ///< Spire: a gabled hall with a tower under a steep pyramid
};
[[nodiscard]] Result<Mesh> generate_house(const HouseOptions& options, const Context& context = {});

/// Houses of every roof on both sides of a street with pavements and kerbs. `triangles` also decides how many.
[[nodiscard]] Result<Mesh> generate_street(const GenerateOptions& options, const Context& context = {});

/// A stratified, jointed and faulted cliff, 80 m long and 30 m high, with talus below and turf above. One surface with
/// an open border, divided into a grid of uv charts over the texture images, which show beds, cracks, stains and lichen
/// and agree along the seams. 10 million triangles take some seconds.
[[nodiscard]] Result<Mesh> generate_outcrop(const GenerateOptions& options, const Context& context = {});

/// Eroded hills with a valley, 2 km square, on a regular grid, open border, with ortho-photo-like textures.
[[nodiscard]] Result<Mesh> generate_terrain(const GenerateOptions& options, const Context& context = {});

/// The pixels (RGB) of texture `index` of generate_outcrop(options) or generate_terrain(options), one at a time: what
/// Texture::image would have held. Precondition: options are in range and index is below the number of textures.
[[nodiscard]] Image outcrop_texture(const GenerateOptions& options, std::uint32_t index, const Context& context = {});
[[nodiscard]] Image terrain_texture(const GenerateOptions& options, std::uint32_t index, const Context& context = {});

}  // namespace lodestone
