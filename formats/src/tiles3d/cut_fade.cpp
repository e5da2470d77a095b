// SPDX-License-Identifier: MIT
#include "tiles3d/cut_fade.h"

#include <algorithm>

namespace lodestone {

CutFade::CutFade(const LodGraph& graph)
    : graph_(graph), is_refined_(graph.groups.size(), 0), in_(graph.nodes.size(), 0), share_(graph.nodes.size(), 0.0F) {
  if (!graph.groups.empty()) shown_.push_back(0);
  list();
}

// The complete cut of a set of refined groups: their nodes, less those whose maker is refined as well.
void CutFade::mark(const std::vector<GroupId>& refined, std::uint8_t bit) {
  for (const GroupId g : refined) is_refined_[g] = 1;
  for (const GroupId g : refined) {
    const Range links = graph_.groups[g].links;
    for (std::uint32_t l = links.begin; l < links.end; ++l) {
      const LodLink& link = graph_.links[l];
      if (link.maker != none && is_refined_[link.maker] != 0) continue;
      for (NodeId n = link.nodes.begin; n < link.nodes.end; ++n) {
        if (in_[n] == 0) nodes_.push_back(n);
        in_[n] |= bit;
      }
    }
  }
  for (const GroupId g : refined) is_refined_[g] = 0;
}

void CutFade::list() {
  for (const NodeId n : nodes_) in_[n] = 0;
  nodes_.clear();
  mark(shown_, 1);
  if (fading_) mark(next_, 2);
  std::sort(nodes_.begin(), nodes_.end());
  for (const NodeId n : nodes_) {
    if (!fading_ || in_[n] == 3) {
      share_[n] = 1.0F;
    } else {
      const auto coming = static_cast<float>(progress_);
      share_[n] = in_[n] == 2 ? coming : coming - 1.0F;
    }
  }
}

void CutFade::step(std::span<const GroupId> refined, double dt_s, double fade_s) {
  if (fading_) {
    progress_ += fade_s > 0.0 ? dt_s / fade_s : 1.0;
    if (progress_ >= 1.0 || dt_s <= 0.0) {
      shown_.swap(next_);
      fading_ = false;
    }
  }
  if (!fading_ && !std::equal(refined.begin(), refined.end(), shown_.begin(), shown_.end())) {
    next_.assign(refined.begin(), refined.end());
    progress_ = fade_s > 0.0 ? dt_s / fade_s : 1.0;
    fading_ = progress_ > 0.0 && progress_ < 1.0;
    if (!fading_) shown_ = next_;
  }
  list();
}

}  // namespace lodestone
