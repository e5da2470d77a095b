// SPDX-License-Identifier: MIT
/// \file
/// Cluster graphs on disk (.lodg, docs/FILE_FORMAT.md): a header with the whole LodGraph, then pages of clusters that
/// are loaded as the view needs them.
///
///     auto file = ClusterFile::open("cliff.lodg");
///     ClusterStreamer streamer{*file, {.budget_bytes = 256 << 20}};
///     each frame:
///       select_cut(file->graph(), view, {.error_px = 1.0, .resident = streamer.resident()}, scratch, cut);
///       streamer.update(scratch);                      // what is missing is loaded in the background, coarse first
///       for (NodeId n : cut) draw(*streamer.page(file->page_of(n)), n);
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include <lodestone/clusters.h>

namespace lodestone {

struct ClusterWriteOptions {
  /// Bits per coordinate of the longest side of the model's box, 8 to 24. All clusters share one grid, so that shared
  /// vertices stay equal bit for bit; every error grows by half the diagonal of a cell.
  std::uint32_t position_bits = 16;
};

struct ClusterFileSize {
  std::uint64_t file_bytes = 0;
  std::uint32_t pages = 0;
  std::uint64_t page_bytes_max = 0;  ///< unpacked; at most 128 KB
};

/// Normals are stored with 8 bits per octahedral coordinate, uvs in steps of 1/16384. Textures that
/// are files of their own are referred to by path, others embedded.
[[nodiscard]] Result<ClusterFileSize> write_cluster_graph(const ClusterGraph& graph, const std::filesystem::path& file,
                                                          const ClusterWriteOptions& options = {},
                                                          const Context& context = {});

/// Everything at once. Every byte is checked, and the promises of the graph.
[[nodiscard]] Result<ClusterGraph> read_cluster_graph(const std::filesystem::path& file, const Context& context = {});

/// True if the file begins like a .lodg file.
[[nodiscard]] bool is_cluster_file(const std::filesystem::path& file);

/// The clusters of one page.
struct ClusterPage {
  Range nodes;                                ///< of the graph
  VertexArrays vertices;                      ///< of these nodes, one after the other
  std::vector<std::uint32_t> first_vertex;    ///< per node: in `vertices`
  std::vector<std::uint8_t> indices;          ///< 3 per triangle, counted from the node's first vertex
  std::vector<std::uint32_t> first_triangle;  ///< per node: in `indices`, in triangles
  /// Per vertex: its place among all vertices of what its group made, nodes ascending; `none` for roots.
  std::vector<std::uint32_t> morph_targets;
  std::uint64_t bytes = 0;  ///< held in memory
};

/// An open file: the graph is in memory, pages are read when asked for. Immutable, shared by any number of threads.
class ClusterFile {
 public:
  [[nodiscard]] static Result<std::shared_ptr<const ClusterFile>> open(const std::filesystem::path& file);
  ~ClusterFile();
  ClusterFile(const ClusterFile&) = delete;
  ClusterFile& operator=(const ClusterFile&) = delete;

  [[nodiscard]] const LodGraph& graph() const noexcept;
  /// Everything but the pages: clusters' ranges, sections, materials, levels. `vertices`, `indices` and `morph_targets`
  /// are empty.
  [[nodiscard]] const ClusterGraph& outline() const noexcept;
  /// Reads, checks and decodes one page; BadData if it is broken.
  [[nodiscard]] Result<ClusterPage> load(PageId page) const;
  /// The page of a node. O(log pages).
  [[nodiscard]] PageId page_of(NodeId node) const noexcept;

 private:
  struct State;
  explicit ClusterFile(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

struct StreamOptions {
  /// Decoded pages kept, at most; the first page does not count.
  std::uint64_t budget_bytes = 256ULL << 20;
  /// Loads under way at once.
  std::uint32_t queue_pages = 8;
};

/// Keeps the pages near the camera loaded, by a thread of its own. Called by one thread. Whatever is missing, late or
/// broken, select_cut() with resident() gives a valid cut: coarser nodes stand in.
class ClusterStreamer {
 public:
  /// Loads the first page (roots and top levels) at once; a graph without a readable first page shows nothing.
  ClusterStreamer(std::shared_ptr<const ClusterFile> file, const StreamOptions& options = {});
  ~ClusterStreamer();
  ClusterStreamer(const ClusterStreamer&) = delete;
  ClusterStreamer& operator=(const ClusterStreamer&) = delete;

  /// Takes in what has been loaded, asks for the pages of the groups that the last cut missed, largest error on the
  /// screen first, forgets what is asked for no more, and drops the pages that were used longest ago, and that no group
  /// of the last cut needs, where the budget is exceeded. `shown`: groups still on the screen beside those of the cut
  /// (CutMorph::refined()), whose pages stay as well.
  void update(const CutScratch& scratch, std::span<const GroupId> shown = {});

  [[nodiscard]] std::span<const std::uint8_t> resident() const noexcept;
  /// Null while it is not resident.
  [[nodiscard]] const ClusterPage* page(PageId page) const noexcept;
  [[nodiscard]] std::uint64_t resident_bytes() const noexcept;
  /// Pages that could not be read; they are not asked for again.
  [[nodiscard]] std::uint32_t broken_pages() const noexcept;
  /// Waits until nothing is under way (for tests and pictures); update() takes it in.
  void wait();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone
