// SPDX-License-Identifier: MIT
/// \file
/// A textured outcrop as a pyramid of tiles: what opens at once in a viewer where the monolith (one mesh, a hundred
/// photographs) would take minutes and gigabytes. Follows "Construction and Visualization of Levels of Detail for
/// High-Resolution LiDAR-Derived Digital Outcrop Models" (Ao et al. 2025); section numbers below are its own, and
/// docs/outcrops.md says where and why we do otherwise.
///
///     auto pyramid = lodestone::OutcropPyramid::build(std::move(mesh), sizes);   // geometry only, no pixel yet
///     lodestone::SegmentImages images{**pyramid, segment, decoded};              // one photograph at a time
///     lodestone::TileContent content = (*pyramid)->content(tile);                // mesh with uvs of its own texture
///     const lodestone::SegmentImages* level[] = {&images};
///     lodestone::Image texture = lodestone::compose(content.texture, level);
///
/// The `formats` library does this for whole folders: write_outcrop() in tileset_writer.h. This header reads no files
/// and holds no codec; pixels come in and go out as Image.
///
/// Levels count from the finest: level 0 is the source, triangle for triangle. The triangles of one level over all
/// tiles are one watertight simplification of the whole source, cut along existing edges; so tiles of a level share
/// border vertices bit for bit, whatever tile, chart or image they belong to.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/image.h>
#include <lodestone/lod_graph.h>
#include <lodestone/mesh.h>
#include <lodestone/result.h>
#include <lodestone/types.h>

namespace lodestone {

/// What must be known of a photograph before it is decoded. A size of 0 means that the image cannot be used: its faces
/// are treated as untextured.
struct TextureInfo {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::uint64_t file_bytes = 0;  ///< compressed size; 0 = unknown, 0.4 bytes a pixel are assumed
};

/// How the sub-model of one image is cut into tiles.
enum class TileSplit : std::uint8_t {
  Auto,     ///< Texture, unless its tiles would spread twice as far in space as Space's: several charts, deep folds
  Texture,  ///< quadtree over the image (3.2.1): each tile is a rectangle of the photograph
  Space,    ///< halves across the longest side, twice per level: quadtree or octree, as the shape asks
};

struct OutcropOptions {
  /// Triangles kept from one level to the next, theta of equation 2; 0 = as many as keep the deviation of the middle
  /// tile at the size of a texel, between 0.2 and 0.7 while textures halve (0.4 without textures). Where these shrink
  /// more slowly, the bounds hold for as many levels as take them to a half.
  double ratio = 0.0;
  /// Width and height of textures from one level to the next; 0 = `ratio` as in the paper (3.4), or 0.5 if that is 0.
  double texture_ratio = 0.0;
  /// Bytes of a tile that splitting and merging aim at, V_t of equations 1 and 2; 0 = 1/64 of the whole, within 128 kB
  /// and 1 MB. It is shared out between geometry and texture as the model's bytes are. The root, of which all is read
  /// before anything shows, is made of no more than about 256 kB.
  std::uint64_t tile_bytes = 0;
  TileSplit split = TileSplit::Auto;
};

/// What the memory of a pyramid depends on.
struct OutcropSize {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint32_t vertex_bytes = 0;  ///< of a vertex with its attributes
};
[[nodiscard]] OutcropSize outcrop_size(const Mesh& mesh) noexcept;
/// Triangles without area. They are in the finest level, and do not count for errors; boxes contain them.
[[nodiscard]] std::uint32_t degenerate_triangle_count(const Mesh& mesh) noexcept;
/// The most that OutcropPyramid::build() holds, the mesh handed over included: on one worker, which measures and
/// simplifies by turns, about 215 bytes a triangle of a welded mesh (300 at a ratio of 0.8), on several 320 (340),
/// whatever their number. Measured peaks lie 6 to 14 % below. Allocators may keep more of what was freed.
[[nodiscard]] std::uint64_t outcrop_build_bytes(const OutcropSize& size, const OutcropOptions& options,
                                                unsigned workers) noexcept;
/// The most of it that is left in the finished pyramid.
[[nodiscard]] std::uint64_t outcrop_levels_bytes(const OutcropSize& size, const OutcropOptions& options) noexcept;

/// The part of the outcrop that one image covers (3.1).
struct OutcropSegment {
  std::uint32_t texture = none;  ///< index into the source's textures; none = untextured
  std::uint32_t triangles = 0;
  std::uint32_t charts = 0;  ///< pieces connected in texture space
  TileSplit split = TileSplit::Texture;
  double texel_m = 0.0;  ///< mean size of a source texel on the rock
  /// The part of the image that is used, in pixels from the top left; beyond the image it repeats.
  std::int32_t left_px = 0, top_px = 0;
  std::uint32_t width_px = 0, height_px = 0;
};

struct OutcropTile {
  std::uint32_t level = 0;  ///< 0 = finest
  std::uint32_t parent = none;
  std::vector<std::uint32_t> children;  ///< of level - 1: one (only simplified), or up to four (merged)
  std::vector<std::uint32_t> segments;  ///< whose faces it holds, ascending
  std::uint32_t triangles = 0;
  /// Of its own triangles, those without area too, and of all below, relative to the origin. Clients need boxes that
  /// contain what is in the files: a thin triangle without area that reaches far makes its finest tile's box reach far.
  Box bounds;
  double error_m = 0.0;  ///< the larger of measured deviation and texel size; 0 at level 0; parents have more
  double texel_m = 0.0;  ///< mean size of its texels on the rock; 0 if untextured
  double gap_m = 0.0;    ///< its border lies no farther than this from that of a finer neighbour; 0 at level 0
  double skirt_m = 0.0;  ///< depth of its skirt: how far it and the tile two levels up deviate in depth, within its gap
};

/// Materials of skirts are copies of those of the surface under this name.
inline constexpr const char* skirt_name = "lodestone:skirt";
/// Triangles that are surface and not skirt.
[[nodiscard]] std::uint32_t surface_triangle_count(const Mesh& mesh) noexcept;
[[nodiscard]] inline bool is_skirt(const Mesh& mesh, FaceId face) noexcept {
  return !mesh.face_materials.empty() && mesh.materials[mesh.face_materials[face]].name == skirt_name;
}

/// Of one level over all tiles.
struct OutcropLevel {
  std::uint32_t tiles = 0;
  std::uint32_t triangles = 0;
  double geometric_error_m = 0.0;      ///< of the tile farthest from the source, measured at the vertices of both
  double texture_scale = 1.0;          ///< of width and height, against the source
  std::uint32_t border_triangles = 0;  ///< that have a vertex on the border between two tiles
  std::uint32_t open_edges = 0;        ///< with one triangle: the true border of the outcrop at this level
};

/// A rectangle of a segment's level image, and where it lies in a tile's texture.
struct TexturePiece {
  std::uint32_t segment = 0;
  std::int32_t from_x = 0, from_y = 0;  ///< may lie outside by the gutter: border pixels are repeated
  std::uint32_t to_x = 0, to_y = 0;
  std::uint32_t width = 0, height = 0;
};

struct TileTexture {
  std::uint32_t level = 0;
  std::uint32_t width = 0, height = 0;  ///< multiples of 8
  std::vector<TexturePiece> pieces;
};

/// A tile ready to be written: `mesh.textures` has one entry without pixels if `texture` has pieces.
struct TileContent {
  Mesh mesh;
  TileTexture texture;
};

class OutcropPyramid {
 public:
  /// Segments, tiles, simplifies. `textures` has one element per texture of the mesh. Time about 2 us a triangle,
  /// memory as outcrop_build_bytes() says. The same pyramid comes out for any number of workers. Triangles across which
  /// their texture repeats more than four times stay plain, with a warning that counts them. Every tile has at least
  /// one triangle with an area. Errors: BadData from validate(mesh), or no triangle with an area; BadArgument;
  /// Cancelled.
  [[nodiscard]] static Result<std::shared_ptr<const OutcropPyramid>> build(Mesh mesh,
                                                                           std::span<const TextureInfo> textures,
                                                                           const OutcropOptions& options = {},
                                                                           const Context& context = {});

  /// Level by level, the finest first; the last is the root.
  [[nodiscard]] const std::vector<OutcropTile>& tiles() const noexcept { return tiles_; }
  [[nodiscard]] const std::vector<OutcropSegment>& segments() const noexcept { return segments_; }
  [[nodiscard]] const std::vector<OutcropLevel>& levels() const noexcept { return levels_; }
  [[nodiscard]] std::uint32_t root() const noexcept { return static_cast<std::uint32_t>(tiles_.size()) - 1; }
  [[nodiscard]] const glm::dvec3& origin() const noexcept { return surroundings_.origin; }
  [[nodiscard]] const std::string& crs() const noexcept { return surroundings_.crs; }
  [[nodiscard]] const Surroundings& surroundings() const noexcept { return surroundings_; }
  [[nodiscard]] std::uint64_t tile_bytes() const noexcept { return tile_bytes_; }
  /// The pyramid as the graph that select_cut() walks: a node per tile (`node_draft` says which), a group per tile with
  /// children, errors in metres.
  [[nodiscard]] AssembledGraph graph() const;
  /// Held by the triangles of all levels.
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  /// Size of a segment's level image.
  [[nodiscard]] glm::uvec2 image_size(std::uint32_t segment, std::uint32_t level) const noexcept;

  /// The triangles of a tile, with uvs remapped (equation 8) to a texture that holds just what the tile shows and
  /// gutters. Materials keep their looks; those with a texture share the tile's. O(tile). Any thread.
  [[nodiscard]] TileContent content(std::uint32_t tile) const;

  /// Adds a strip along every border with another tile to the tile's mesh as content() made it: from the border
  /// outwards under the neighbour by `gap_m` and down into the rock by `skirt_m`. Beside a neighbour of another level
  /// the two strips meet below the gap, so no sky shows through it. Two triangles a border edge, of materials of their
  /// own (is_skirt()); their texels are those of the border.
  void add_skirt(std::uint32_t tile, Mesh& mesh) const;

  /// For each pixel of a segment's used part, row by row: whether a source triangle shows it, or one next to it.
  [[nodiscard]] std::vector<bool> coverage(std::uint32_t segment) const;

 private:
  friend class LevelMeasurer;
  friend class OutcropBuilder;
  friend class SkirtMaker;
  friend class TileDraft;
  OutcropPyramid() = default;

  struct BorderPoint {
    glm::vec3 position{0.0F};
    glm::vec3 normal{0.0F};  // over the faces of all tiles there
    float rim_m = 0.0F;      // distance from the rim of the outcrop itself, or of a hole in it
  };
  struct LevelMesh {
    VertexArrays vertices;
    std::vector<VertexId> indices;  // faces of a tile follow each other
    std::vector<MaterialId> face_materials;
    std::vector<FeatureId> face_features;    // empty if the source has none
    std::vector<std::uint8_t> face_borders;  // per face: bit k if the edge from corner k lies between two tiles
    std::vector<BorderPoint> border_points;  // ascending by position
    std::vector<std::uint32_t> first_face;   // per tile of the level, and one past the end
  };
  Surroundings surroundings_;
  std::vector<std::uint32_t> segment_of_material_;
  std::vector<glm::uvec2> image_px_;  // per segment: size of the whole photograph
  std::vector<OutcropSegment> segments_;
  std::vector<OutcropTile> tiles_;
  std::vector<OutcropLevel> levels_;
  std::vector<LevelMesh> meshes_;
  std::vector<std::uint32_t> first_tile_;  // per level
  std::uint64_t tile_bytes_ = 0;
};

/// The level images of one segment: the used part of its photograph, what no triangle shows filled from what one does
/// (so that no mip level bleeds), scaled down with an area filter in linear light. Level 0 keeps the source's pixels.
/// Images are made level by level, and let go when no coarser one needs them: memory is the photograph once, while
/// filling or making level 1 a third more.
class SegmentImages {
 public:
  /// Takes the decoded photograph over and makes level 0. Precondition: its size is that of the TextureInfo, the
  /// segment has a texture.
  SegmentImages(const OutcropPyramid& pyramid, std::uint32_t segment, Image photograph);
  /// A single level, made before.
  SegmentImages(std::uint32_t segment, std::uint32_t level, Image image);

  /// Makes coarser levels up to this one. Precondition: not finer than the present one.
  void go_to(const OutcropPyramid& pyramid, std::uint32_t level);

  [[nodiscard]] std::uint32_t segment() const noexcept { return segment_; }
  [[nodiscard]] std::uint32_t level() const noexcept { return level_; }
  /// That of level().
  [[nodiscard]] const Image& image() const noexcept { return images_.front(); }

 private:
  void coarsen(const OutcropPyramid& pyramid);

  std::uint32_t segment_ = 0;
  std::uint32_t level_ = 0;
  std::vector<Image> images_;  // the present level, and coarser ones that had to be made of finer ones than it
};

/// The pixels of a tile's texture. `images` holds every segment that its pieces name, at the texture's level. What
/// lies between pieces is filled from them.
[[nodiscard]] Image compose(const TileTexture& texture, std::span<const SegmentImages* const> images);

}  // namespace lodestone
