// SPDX-License-Identifier: MIT
/// \file
/// Outcrops as 3D Tiles: a folder that CesiumJS, 3DTilesRendererJS and our own viewer open at once.
///
///     auto loaded = lodestone::read_mesh("cliff.obj", {.textures = lodestone::LoadTextures::Reference});
///     auto done = lodestone::write_outcrop(std::move(loaded->mesh), "cliff_tiles");
///
/// The folder holds `tileset.json`, `build.json` (what it was made from, for resuming) and `tiles/L<level>_<i>.glb`,
/// level 0 the finest. All names in it are relative: it may be moved and served from anywhere.
///
/// Refinement is REPLACE. `geometricError` is 16 times the tile's error in metres, so that a client with the usual
/// maximum screen-space error of 16 pixels shows a tile while its texels, and its deviation from the source, are no
/// larger than a pixel.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/outcrop.h>
#include <lodestone/result.h>

namespace lodestone {

enum class TileImage : std::uint8_t {
  Jpeg,  ///< PNG where a photograph has alpha
  Png,   ///< lossless
  Webp,  ///< a third smaller than JPEG and slower to make; clients must know EXT_texture_webp, OpenSceneGraph does not
};

/// Of vertices and triangles; textures are compressed anyway.
enum class TileCompression : std::uint8_t {
  None,  ///< any client
  /// EXT_meshopt_compression, a third of the bytes or less; clients must know it (CesiumJS does, three.js with its
  /// decoder set). Positions lie on one grid for the whole pyramid, so tiles meet bit for bit: steps of 2^-14 m (0.06
  /// mm) or less, more only where the outcrop reaches farther than 512 m from its origin. Normals have 8 bits.
  Meshopt,
};

enum class TilesVersion : std::uint8_t {
  V11,  ///< glb
  V10,  ///< b3dm, for older clients
};

struct TilesetOptions {
  OutcropOptions pyramid;
  TileImage image = TileImage::Jpeg;
  int jpeg_quality = 90;  ///< 1..100, of WebP as well; JPEG from 90 on does not subsample colours
  TileCompression compression = TileCompression::None;
  TilesVersion version = TilesVersion::V11;
  /// Goes on with a build of the same input and options that was stopped at any point; tiles that are there are kept.
  /// The folder comes out the same, byte for byte. Where a photograph has changed since, a damaged one that was mended
  /// or another of the same name, all tiles are made anew, with a warning that names it.
  bool resume = false;
};

struct TilesetReport {
  std::uint32_t tiles = 0;
  std::uint32_t source_triangles = 0;
  std::uint32_t degenerate_triangles = 0;  ///< of them without area: in the finest level only
  std::uint64_t bytes = 0;                 ///< of all files
  double root_error_m = 0.0;
  std::uint32_t kept_tiles = 0;  ///< that were there already (resume)
  std::vector<OutcropLevel> levels;
  std::vector<OutcropSegment> segments;
  double decoded_megapixels = 0.0;
  double encoded_megapixels = 0.0;
  double decode_seconds = 0.0;    ///< summed over workers
  double resample_seconds = 0.0;  ///< filling, shrinking and cutting
  double encode_seconds = 0.0;
  double geometry_seconds = 0.0;  ///< wall time of OutcropPyramid::build
  unsigned geometry_workers = 1;
  unsigned photograph_workers = 1;  ///< each with one photograph
  bool fewer_workers = false;       ///< than asked for, because of the limit on memory
};

/// Writes the pyramid of a mesh whose textures are referred to by path, encoded or decoded. One photograph per worker
/// is in memory at a time. `Context::max_memory_bytes` is what the process may take, 47 MB for the program itself
/// included: before work begins it is worked out from the numbers of triangles and vertices (outcrop_build_bytes()) and
/// the heads of the images how many workers can keep to it; the report says how many do. With `crs` known the root
/// transform places the outcrop on the globe, else it carries the origin. The same bytes come out for any number of
/// workers. A photograph that is missing, empty, cut off or damaged is not used, nor any part of it: its faces stay
/// plain, with a warning that names it. Errors: TooLarge where not even one worker can keep to the limit, which names a
/// limit that will do; those of OutcropPyramid::build; Unreadable for a full disk, or a photograph that is taken away
/// meanwhile; BadArgument where `resume` meets a folder made from another mesh, with other options or by another
/// version. A call that fails or is cancelled leaves no half-written file and no tileset.json, and can be resumed.
[[nodiscard]] Result<TilesetReport> write_outcrop(Mesh mesh, const std::filesystem::path& folder,
                                                  const TilesetOptions& options = {}, const Context& context = {});

/// The same question before a mesh is read, whose reading takes memory too: the corners of an OBJ file are counted, a
/// PLY or glTF file tells its counts, and the heads of images are looked at; of other files only the size is known, so
/// a limit below it and the program's is refused. Done at once where there is no limit. Errors: TooLarge, which names a
/// limit that will do; those of reading.
[[nodiscard]] Status outcrop_fits(const std::filesystem::path& mesh_file, const TilesetOptions& options,
                                  const Context& context);

/// What a look at all files of a tileset found. The usual validators check the JSON only.
struct TilesetCheck {
  std::uint32_t tiles = 0;
  std::uint64_t bytes = 0;
  std::uint64_t triangles = 0;             ///< of all tiles without children
  std::uint32_t contents_outside_box = 0;  ///< tiles with a vertex outside their own bounding volume
  std::uint32_t loose_boxes =
      0;  ///< tiles whose volume reaches farther than content and children by 1 % of its diagonal
  std::uint32_t children_outside_parent = 0;  ///< tiles whose volume is not inside their parent's
  std::uint32_t errors_not_monotone = 0;      ///< tiles whose geometricError is not below their parent's
  /// Over all levels: edges with one triangle in all tiles of the level together, beyond those that the level has as
  /// true border. 0 where tiles fit bit for bit.
  std::uint64_t seams_open = 0;
  std::vector<std::string> faults;  ///< the first ten, in words
};
/// Reads every tile of a tileset of ours. Errors: those of reading.
[[nodiscard]] Result<TilesetCheck> check_tileset(const std::filesystem::path& tileset_json,
                                                 const Context& context = {});

}  // namespace lodestone
