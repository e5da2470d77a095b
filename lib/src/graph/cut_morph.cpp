// SPDX-License-Identifier: MIT
// Based on: Hoppe 1996 (geomorphs); the rule of records in flight (docs/DECISIONS.md, "Geomorph").
// Differs: what travels is a whole group with one weight. A group may leave weight 0 only while none of its nodes'
// makers is shown as refined, appear only under parents at weight 0, and both appears and vanishes at weight 1.
#include <lodestone/cut_morph.h>

#include <algorithm>

#include "graph/frustum.h"

namespace lodestone {

CutMorph::CutMorph(const LodGraph& graph, double duration_s)
    : graph_(graph),
      duration_s_(duration_s),
      weights_(graph.groups.size(), 0.0),
      flags_(graph.groups.size(), 0),
      depth_(graph.groups.size(), 0),
      ready_parents_(graph.groups.size(), 0) {
  refined_.reserve(graph.groups.size());
  wanted_.reserve(graph.groups.size());
  for (const LodGroup& group : graph.groups) {
    const auto below = static_cast<std::uint16_t>(depth_[static_cast<std::size_t>(&group - graph.groups.data())] + 1);
    for (std::uint32_t i = group.links.begin; i != group.links.end; ++i) {
      const GroupId maker = graph.links[i].maker;
      if (maker != none) depth_[maker] = std::max(depth_[maker], below);
    }
  }
}

CutSummary CutMorph::update(const View& view, const CutOptions& options, double dt_s, CutScratch& scratch,
                            std::vector<NodeId>& out) noexcept {
  CutSummary summary = select_cut(graph_, view, options, scratch, out);
  out.clear();
  if (graph_.empty()) return summary;
  mark_wanted(scratch.refined());
  if (!started_) {
    appear(true);
    travel(view, options, 1.0);
    started_ = true;
  } else {
    const double step = rate(dt_s);
    drop(options);
    travel(view, options, step);
    appear(false);
  }
  settled_ = std::all_of(wanted_.begin(), wanted_.end(), [&](GroupId g) { return (flags_[g] & Shown) != 0; }) &&
             refined_.size() == wanted_.size();
  emit(view, options, out, summary);
  return summary;
}

void CutMorph::mark_wanted(std::span<const GroupId> groups) noexcept {
  for (const GroupId g : wanted_) flags_[g] &= static_cast<std::uint8_t>(~Wanted);
  wanted_.assign(groups.begin(), groups.end());
  for (const GroupId g : wanted_) flags_[g] |= Wanted;
}

// As many levels as there are to go at once, so that the whole way takes the duration.
double CutMorph::rate(double dt_s) const noexcept {
  std::uint16_t least = 0xFFFF;
  std::uint16_t most = 0;
  const auto look = [&](const std::vector<GroupId>& groups) {
    for (const GroupId g : groups) {
      if ((flags_[g] & (Shown | Wanted)) == (Shown | Wanted)) continue;
      least = std::min(least, depth_[g]);
      most = std::max(most, depth_[g]);
    }
  };
  look(refined_);
  look(wanted_);
  const int levels = most < least ? 1 : most - least + 1;
  return levels * dt_s / duration_s_;
}

bool CutMorph::holds_finer(GroupId group) const noexcept {
  const Range links = graph_.groups[group].links;
  return std::any_of(graph_.links.begin() + links.begin, graph_.links.begin() + links.end,
                     [&](const LodLink& link) { return link.maker != none && (flags_[link.maker] & Shown) != 0; });
}

bool CutMorph::wants_finer(GroupId group) const noexcept {
  const Range links = graph_.groups[group].links;
  return std::any_of(graph_.links.begin() + links.begin, graph_.links.begin() + links.end,
                     [&](const LodLink& link) { return link.maker != none && (flags_[link.maker] & Wanted) != 0; });
}

bool CutMorph::loaded(GroupId group, const CutOptions& options) const noexcept {
  if (options.resident.empty() || group == 0) return true;
  const Range parts = graph_.groups[group].parts;
  return std::all_of(graph_.parts.begin() + parts.begin, graph_.parts.begin() + parts.end,
                     [&](const LodPart& part) { return options.resident[part.page] != 0; });
}

// Children before parents, so that a whole chain may vanish in one step when time has passed.
void CutMorph::travel(const View& view, const CutOptions& options, double step) noexcept {
  std::sort(refined_.begin(), refined_.end());
  for (std::size_t i = refined_.size(); i-- > 1;) {
    const GroupId g = refined_[i];
    if (holds_finer(g)) continue;
    const bool stays = (flags_[g] & Wanted) != 0;
    double target = 1.0;
    if (stays) target = wants_finer(g) ? 0.0 : morph_weight(graph_, view, options.error_px, g);
    weights_[g] = std::clamp(target, weights_[g] - step, weights_[g] + step);
    if (!stays && weights_[g] >= 1.0) {
      flags_[g] &= static_cast<std::uint8_t>(~Shown);
      weights_[g] = 0.0;
    }
  }
  std::erase_if(refined_, [&](GroupId g) { return (flags_[g] & Shown) == 0; });
}

// What lost its pages goes, and what hangs on it.
void CutMorph::drop(const CutOptions& options) noexcept {
  if (options.resident.empty()) return;
  std::fill(ready_parents_.begin(), ready_parents_.end(), 0);
  std::sort(refined_.begin(), refined_.end());
  for (const GroupId g : refined_) {
    if (!loaded(g, options) || ready_parents_[g] != graph_.groups[g].parent_count) {
      flags_[g] &= static_cast<std::uint8_t>(~Shown);
      weights_[g] = 0.0;
      continue;
    }
    const Range links = graph_.groups[g].links;
    for (std::uint32_t i = links.begin; i != links.end; ++i) {
      if (graph_.links[i].maker != none) ++ready_parents_[graph_.links[i].maker];
    }
  }
  std::erase_if(refined_, [&](GroupId g) { return (flags_[g] & Shown) == 0; });
}

// Wanted groups all of whose parents are shown and at rest; they begin as what stood for them.
void CutMorph::appear(bool at_once) noexcept {
  if (refined_.empty()) {
    refined_.push_back(0);
    flags_[0] |= Shown;
  }
  std::fill(ready_parents_.begin(), ready_parents_.end(), 0);
  std::sort(refined_.begin(), refined_.end());
  const std::size_t before = refined_.size();
  for (std::size_t i = 0; i < (at_once ? refined_.size() : before); ++i) {
    if (!at_once && weights_[refined_[i]] > 0.0) continue;
    const Range links = graph_.groups[refined_[i]].links;
    for (std::uint32_t l = links.begin; l != links.end; ++l) {
      const GroupId maker = graph_.links[l].maker;
      if (maker == none || ++ready_parents_[maker] != graph_.groups[maker].parent_count) continue;
      if ((flags_[maker] & Wanted) == 0 || (flags_[maker] & Shown) != 0) continue;
      flags_[maker] |= Shown;
      weights_[maker] = at_once ? 0.0 : 1.0;
      refined_.push_back(maker);
    }
  }
  std::sort(refined_.begin(), refined_.end());
}

void CutMorph::emit(const View& view, const CutOptions& options, std::vector<NodeId>& out,
                    CutSummary& summary) const noexcept {
  const Frustum frustum{view};
  summary.triangle_count = 0;
  for (const GroupId g : refined_) {
    const Range links = graph_.groups[g].links;
    for (std::uint32_t i = links.begin; i != links.end; ++i) {
      const LodLink& link = graph_.links[i];
      if (link.maker != none && (flags_[link.maker] & Shown) != 0) continue;
      for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) {
        if (options.culling == Culling::Frustum && frustum.outside(graph_.nodes[n].bounds)) continue;
        out.push_back(n);
        summary.triangle_count += graph_.nodes[n].triangle_count;
      }
    }
  }
}

}  // namespace lodestone
