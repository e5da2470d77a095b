// SPDX-License-Identifier: MIT
/// \file
/// From cut to cut without a jump, in bounded time, whatever the camera does.
///
/// morph_weight() alone is enough while the camera moves slowly: every exchange happens at an end of a morph. A camera
/// that jumps, or a page that arrives late, would exchange groups in the middle of one. CutMorph keeps the cut that is
/// shown beside the one that is wanted, and lets groups appear only as what stood for them, travel, and vanish only
/// once they have become it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/lod_graph.h>

namespace lodestone {

/// One per instance and camera; belongs to one thread. Holds 23 bytes per group; allocates nothing after construction
/// once `out` and the scratch have grown.
class CutMorph {
 public:
  /// The first update() shows its cut at once. `duration_s`: how long the way from one cut to any other takes, about; a
  /// single exchange takes no less than `duration_s` over the number of levels between. Precondition: the graph is
  /// valid and outlives this.
  explicit CutMorph(const LodGraph& graph, double duration_s = 0.3);

  /// Goes on by `dt_s` towards the cut that select_cut() gives, and replaces the nodes to draw in `out`. Groups whose
  /// pages are not loaded any more are dropped at once.
  CutSummary update(const View& view, const CutOptions& options, double dt_s, CutScratch& scratch,
                    std::vector<NodeId>& out) noexcept;

  /// Per group: how far its nodes have travelled, 0..1; for morph() or a vertex shader.
  [[nodiscard]] std::span<const double> weights() const noexcept { return weights_; }
  /// The groups shown as refined, parents before children.
  [[nodiscard]] std::span<const GroupId> refined() const noexcept { return refined_; }
  /// True once the last update() had nothing left to exchange.
  [[nodiscard]] bool settled() const noexcept { return settled_; }

 private:
  enum Flag : std::uint8_t { Shown = 1, Wanted = 2 };
  void mark_wanted(std::span<const GroupId> groups) noexcept;
  [[nodiscard]] double rate(double dt_s) const noexcept;
  [[nodiscard]] bool holds_finer(GroupId group) const noexcept;
  [[nodiscard]] bool wants_finer(GroupId group) const noexcept;
  [[nodiscard]] bool loaded(GroupId group, const CutOptions& options) const noexcept;
  void travel(const View& view, const CutOptions& options, double step) noexcept;
  void drop(const CutOptions& options) noexcept;
  void appear(bool at_once) noexcept;
  void emit(const View& view, const CutOptions& options, std::vector<NodeId>& out, CutSummary& summary) const noexcept;

  const LodGraph& graph_;
  double duration_s_;
  std::vector<double> weights_;
  std::vector<std::uint8_t> flags_;
  std::vector<std::uint16_t> depth_;
  std::vector<std::uint32_t> ready_parents_;
  std::vector<GroupId> refined_;
  std::vector<GroupId> wanted_;
  bool settled_ = false;
  bool started_ = false;
};

}  // namespace lodestone
