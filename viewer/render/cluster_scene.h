// SPDX-License-Identifier: MIT
// A cluster graph on the screen: pages streamed in as the view needs them, one cut a frame, groups that morph in the
// vertex shader. Shared by the window and the headless renderer.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <lodestone/cluster_file.h>
#include <lodestone/cut_morph.h>

#include "renderer.h"

namespace lodestone::render {

struct ClusterSceneOptions {
  StreamOptions stream;
  /// Time that the way from one cut to another takes, about; 0: groups are exchanged at once, without a morph.
  double morph_seconds = 0.3;
};

/// What the last update() came to.
struct ClusterFrame {
  CutSummary cut;
  std::uint32_t clusters = 0;
  std::uint32_t missing_groups = 0;  ///< wanted, but not loaded yet
  bool settled = false;              ///< nothing is loading, nothing is on its way to another cut
};

class ClusterScene {
 public:
  ClusterScene(const Gl& gl, std::shared_ptr<const ClusterFile> file, const ClusterSceneOptions& options = {});
  ClusterScene(const ClusterScene&) = delete;
  ClusterScene& operator=(const ClusterScene&) = delete;
  ~ClusterScene();

  /// Takes in pages that have come, asks for those that are missing, and goes on by `dt_s` towards the cut for `view`
  /// (relative to the graph's origin). `options.resident` is set here. items() change.
  ClusterFrame update(const View& view, CutOptions options, double dt_s);
  /// The same, standing still, until all has come that fits the budget.
  ClusterFrame load(const View& view, const CutOptions& options);
  /// The same, and then until nothing moves: for pictures.
  ClusterFrame settle(const View& view, const CutOptions& options);

  /// What to draw; with Coloring::Clusters in a colour for each cluster. Valid until the next update().
  [[nodiscard]] std::span<const Item> items(Coloring coloring);
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  /// The nodes of items(), and how far the nodes of every group have travelled; empty without a morph.
  [[nodiscard]] std::span<const NodeId> cut() const { return cut_; }
  [[nodiscard]] std::span<const double> weights() const {
    return options_.morph_seconds > 0.0 ? morph_.weights() : std::span<const double>{};
  }
  [[nodiscard]] const ClusterGraph& outline() const { return file_->outline(); }
  [[nodiscard]] const ClusterStreamer& streamer() const { return streamer_; }
  [[nodiscard]] const std::vector<Warning>& warnings() const { return surfaces_.warnings(); }

 private:
  struct Part;
  void drop_parts_without_page();
  void find_bounds();
  [[nodiscard]] const Part& part(std::uint32_t index);
  [[nodiscard]] VertexArrays made_vertices(GroupId group) const;
  void add_item(std::uint32_t part_index, std::span<const NodeId> nodes, Coloring coloring);

  const Gl& gl_;
  std::shared_ptr<const ClusterFile> file_;
  ClusterSceneOptions options_;
  ClusterStreamer streamer_;
  CutMorph morph_;
  Surfaces surfaces_;
  Box bounds_;
  std::vector<GroupId> group_of_;             // per node
  std::vector<std::uint32_t> part_of_;        // per node
  std::vector<std::vector<Range>> made_;      // per group: nodes, ascending
  std::vector<std::unique_ptr<Part>> parts_;  // per part of the graph; null until it is drawn
  CutScratch scratch_;
  std::vector<NodeId> cut_;
  std::vector<Item> items_;
  std::vector<DrawRange> draws_;
  std::vector<glm::vec4> colors_;
};

}  // namespace lodestone::render
