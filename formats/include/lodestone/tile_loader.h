// SPDX-License-Identifier: MIT
/// \file
/// Tilesets at run time: what to draw from where the camera is, loaded beside the frame loop.
///
///     auto pyramid = lodestone::TilePyramid::open("cliff_tiles/tileset.json");
///     lodestone::TilePager pager{*pyramid};
///     while (running) {
///       for (lodestone::NodeId tile : pager.update(view, dt_s)) draw(*pager.content(tile), pager.share(tile));
///     }
///
/// Selection is select_cut() of lod_graph.h, so a tile is replaced by its children when its error covers more than so
/// many pixels, and never before all of them are there: nothing is ever missing. (The paper that the pyramids follow
/// compares the projected size of a tile with that of its texture, equation 9. That is the same test where a tile's
/// error is the size of its texels, as in tilesets of ours; the error also knows the geometry.)
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/formats.h>
#include <lodestone/lod_graph.h>
#include <lodestone/mesh.h>
#include <lodestone/result.h>
#include <lodestone/view.h>

namespace lodestone {

/// Copies of tiles on a fast disk, for tilesets that lie on a slow one or are fetched: a network folder, the web.
struct TileCacheOptions {
  std::filesystem::path folder;          ///< made if it is missing; tilesets and programs may share one
  std::uint64_t max_bytes = 1ULL << 30;  ///< of all copies in the folder; those not used for longest go first
};

struct TileCacheStatus {
  std::uint64_t hits = 0;    ///< tiles that were there
  std::uint64_t misses = 0;  ///< tiles that had to be fetched
  std::uint64_t bytes = 0;   ///< of all copies in the folder
};

/// An opened tileset.json, or a tree of OpenSceneGraph files by its root; immutable, shared by threads. Of tilesets it
/// understands boxes and spheres, glb and b3dm, one content per tile, refinement REPLACE.
///
/// OpenSceneGraph's files (PagedLOD, by pixel size or by distance) are read by the program lodestone-osgb, beside the
/// program that runs or on the PATH: its library must not share a process with a software OpenGL. Opening walks through
/// all files of the tree, without their textures, because each tile is known only to the one above it; tiles come one
/// by one. An error is what covers a pixel in a picture of 1920 x 1080 at 46 degrees where OpenSceneGraph would switch
/// there.
class TilePyramid {
 public:
  /// Reads the JSON only, or the index of an .osgb tree (which needs no cache and has none). The path may be an address
  /// of the web (http://, https://): libcurl fetches it, and CURL_CA_BUNDLE in the environment may name a file of
  /// certificates to trust instead of the system's. With a cache tiles are looked for there first; copies of a tileset
  /// that has changed are not used again, and what is wrong with the cache later (a full disk, a damaged copy) costs
  /// time only. Errors: NotFound, Unreadable, BadData with what is missing.
  [[nodiscard]] static Result<std::shared_ptr<const TilePyramid>> open(
      const std::filesystem::path& root, const std::optional<TileCacheOptions>& cache = std::nullopt);
  ~TilePyramid();
  TilePyramid(const TilePyramid&) = delete;
  TilePyramid& operator=(const TilePyramid&) = delete;

  /// One node per tile with content; errors are metres (geometricError / 16). The frame is that of the root's content:
  /// world coordinates less origin(), for tilesets of ours in the source's coordinate system.
  [[nodiscard]] const LodGraph& graph() const noexcept;
  [[nodiscard]] const glm::dvec3& origin() const noexcept;
  [[nodiscard]] const Box& bounds() const noexcept;
  [[nodiscard]] const std::string& name(NodeId tile) const noexcept;
  /// All zero without a cache.
  [[nodiscard]] TileCacheStatus cache_status() const;

  /// Reads a tile. The mesh's own origin is zero or small; positions are in the frame of graph().
  [[nodiscard]] Result<Mesh> load(NodeId tile, LoadTextures textures = LoadTextures::Decoded) const;

 private:
  TilePyramid();
  struct Content;
  std::unique_ptr<Content> content_;
};

struct PagerOptions {
  unsigned workers = 2;
  /// Vertices, indices and decoded pixels held; tiles not drawn for longest go first. Those drawn, and the coarser ones
  /// above them, stay even if they exceed it.
  std::uint64_t budget_bytes = 512ULL << 20;
  double error_px = 1.0;
  /// Tiles are also asked for that the camera will need after so many seconds if it goes on as it does.
  double look_ahead_s = 0.5;
  /// Tiles are exchanged by way of both, pixel by pixel, for so long; 0 = at once.
  double fade_s = 0.2;
};

struct PagerStatus {
  std::uint32_t resident_tiles = 0;
  std::uint32_t wanted_tiles = 0;  ///< asked for and not there
  std::uint64_t resident_bytes = 0;
  std::uint64_t loaded_tiles = 0;     ///< since the beginning, those let go again included
  std::vector<std::string> failures;  ///< one line per tile that could not be read; what is coarser stands in for it
};

/// Belongs to one thread, which calls update() once a frame; workers read files. The root is read on construction, the
/// rest from the second update() on, or the first wait(): so the first picture has processor and memory for itself.
class TilePager {
 public:
  explicit TilePager(std::shared_ptr<const TilePyramid> pyramid, const PagerOptions& options = {});
  ~TilePager();
  TilePager(const TilePager&) = delete;
  TilePager& operator=(const TilePager&) = delete;

  /// What to draw now: every part of the view once, or twice with complementary share(). Takes in what workers have
  /// read, asks for what is missing, the largest error first, lets go of what has not been drawn for longest. Does not
  /// wait. Empty only if the root cannot be read. With `dt_s` 0 tiles are exchanged at once.
  [[nodiscard]] std::span<const NodeId> update(const View& view, double dt_s);

  /// The same, but waits until all that this view needs is there (or has failed), and for no exchange.
  [[nodiscard]] std::span<const NodeId> settle(const View& view);

  /// Waits until one more of the tiles that the last update() asked for has been read or has failed; not at all where
  /// none is on its way. settle() is update() and wait() by turns.
  void wait();

  /// How much of a tile that update() has returned is shown: 1 = all of it. In (0, 1) it comes: pixels whose noise (any
  /// fixed pattern in 0..1) is below the share show it. In (-1, 0) it leaves: the pixels whose noise is not below 1 +
  /// share. So those that come and those that leave fill every pixel once.
  [[nodiscard]] float share(NodeId tile) const;
  /// True while an exchange is under way: draw on, even if the camera stands still.
  [[nodiscard]] bool fading() const;

  /// From the next update on.
  void set_error_px(double error_px);

  /// Lets go of a tile's pixels, decoded and encoded, once they have been copied to a graphics card. Its bytes still
  /// count towards the budget, which bounds the copies too.
  void forget_pixels(NodeId tile);

  /// Of a tile that update() has returned; valid until the next update().
  [[nodiscard]] const Mesh* content(NodeId tile) const;
  [[nodiscard]] PagerStatus status() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// True if TilePyramid::open() is for it: if the file looks like a tileset.json, or is named .osgb; of an address of
/// the web, if it ends with .json.
[[nodiscard]] bool is_tileset_file(const std::filesystem::path& file);

/// Several tiles as one mesh, each with its own textures, for those who want a picture and no pager.
[[nodiscard]] Mesh merged(std::span<const Mesh* const> tiles);

}  // namespace lodestone
