// SPDX-License-Identifier: MIT
// Goes from one cut of a tree of tiles to the next by way of both: what is replaced leaves while what replaces it
// comes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/lod_graph.h>

namespace lodestone {

// Follows the cuts that select_cut() wants. A new cut is taken when the exchange under way is over, so that at any
// instant there are two at most and each part of the surface is there once, or as two complementary shares. Cuts are
// known by their refined groups and are complete: what lies outside the view is drawn as coarse as it is left.
class CutFade {
 public:
  explicit CutFade(const LodGraph& graph);

  // `refined` as CutScratch::refined() tells it, parents before children. With `fade_s` 0 it is taken at once.
  void step(std::span<const GroupId> refined, double dt_s, double fade_s);

  // What to draw, each once, ascending.
  [[nodiscard]] const std::vector<NodeId>& nodes() const noexcept { return nodes_; }
  // Share of the pixels that show it: 1 = all; above 0 it comes, below 0 it leaves (-share).
  [[nodiscard]] float share(NodeId node) const noexcept { return share_[node]; }
  [[nodiscard]] bool fading() const noexcept { return fading_; }

 private:
  void mark(const std::vector<GroupId>& refined, std::uint8_t bit);
  void list();

  const LodGraph& graph_;
  std::vector<GroupId> shown_, next_;
  bool fading_ = false;
  double progress_ = 0.0;
  std::vector<std::uint8_t> is_refined_;  // per group
  std::vector<std::uint8_t> in_;          // per node: bit 0 = in the shown cut, bit 1 = in the next
  std::vector<NodeId> nodes_;
  std::vector<float> share_;
};

}  // namespace lodestone
