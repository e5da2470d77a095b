// SPDX-License-Identifier: MIT
// Based on: Ponchio and Cignoni 2005 (Batched Multi-Triangulation: cuts of a graph of patches); Wang et al. 2023,
// sections 2.5 and 3 (own error at most the limit, the parent's above it).
// Differs: no hierarchy beside the graph and no test per cluster. A walk from the roots counts for every group how many
// of its parents are refined and tests it when all are, so each group is tested at most once and every cut is valid by
// construction, also under a budget and with pages missing.
#include <algorithm>

#include <lodestone/lod_graph.h>

#include "graph/frustum.h"

namespace lodestone {
namespace {

constexpr std::uint32_t refined_state = none;

}  // namespace

class CutSelection {
 public:
  CutSelection(const LodGraph& graph, const View& view, const CutOptions& options, CutScratch& scratch) noexcept
      : graph_(graph),
        view_(view),
        options_(options),
        scratch_(scratch),
        frustum_(view),
        culls_(options.culling == Culling::Frustum) {}

  CutSummary run(std::vector<NodeId>& out) noexcept {
    out.clear();
    scratch_.refined_.clear();
    scratch_.candidates_.clear();
    scratch_.missing_.clear();
    if (graph_.empty()) return {};
    if (scratch_.state_.size() < graph_.groups.size()) scratch_.state_.resize(graph_.groups.size(), 0);
    refine(0);
    if (options_.triangle_budget == 0) {
      refine_all();
    } else {
      refine_within_budget();
    }
    for (const GroupId g : scratch_.refined_) emit(g, out);
    forget();
    return summary_;
  }

 private:
  void refine(GroupId id) noexcept {
    const LodGroup& group = graph_.groups[id];
    scratch_.state_[id] = refined_state;
    scratch_.refined_.push_back(id);
    triangles_ += group.triangle_count;
    triangles_ -= group.made_triangle_count;
    for (std::uint32_t i = group.links.begin; i != group.links.end; ++i) {
      const GroupId maker = graph_.links[i].maker;
      if (maker == none) return;
      if (++scratch_.state_[maker] == graph_.groups[maker].parent_count) consider(maker);
    }
  }

  void consider(GroupId id) noexcept {
    const LodGroup& group = graph_.groups[id];
    if (culls_ && frustum_.outside(group.bounds)) return;
    ++summary_.groups_tested;
    const double error = error_px(view_, group.error_m, group.bounds);
    if (error <= options_.error_px) {
      summary_.max_error_px = std::max(summary_.max_error_px, error);
      return;
    }
    if (resident(group)) {
      scratch_.candidates_.push_back({error, id});
      if (options_.triangle_budget != 0) std::push_heap(scratch_.candidates_.begin(), scratch_.candidates_.end(), less);
      return;
    }
    scratch_.missing_.push_back({id, error});
    summary_.max_error_px = std::max(summary_.max_error_px, error);
  }

  void refine_all() noexcept {
    while (!scratch_.candidates_.empty()) {
      const GroupId next = scratch_.candidates_.back().group;
      scratch_.candidates_.pop_back();
      refine(next);
    }
  }

  void refine_within_budget() noexcept {
    while (!scratch_.candidates_.empty()) {
      const CutScratch::Candidate next = scratch_.candidates_.front();
      const LodGroup& group = graph_.groups[next.group];
      if (triangles_ + group.triangle_count > options_.triangle_budget + group.made_triangle_count) {
        summary_.max_error_px = std::max(summary_.max_error_px, next.error_px);
        return;
      }
      std::pop_heap(scratch_.candidates_.begin(), scratch_.candidates_.end(), less);
      scratch_.candidates_.pop_back();
      refine(next.group);
    }
  }

  void emit(GroupId id, std::vector<NodeId>& out) noexcept {
    const LodGroup& group = graph_.groups[id];
    for (std::uint32_t i = group.links.begin; i != group.links.end; ++i) {
      const LodLink& link = graph_.links[i];
      if (link.maker != none && scratch_.state_[link.maker] == refined_state) continue;
      for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) {
        if (culls_ && frustum_.outside(graph_.nodes[n].bounds)) continue;
        out.push_back(n);
        summary_.triangle_count += graph_.nodes[n].triangle_count;
      }
    }
  }

  void forget() noexcept {
    for (const GroupId g : scratch_.refined_) {
      scratch_.state_[g] = 0;
      const Range links = graph_.groups[g].links;
      for (std::uint32_t i = links.begin; i != links.end; ++i) {
        if (graph_.links[i].maker != none) scratch_.state_[graph_.links[i].maker] = 0;
      }
    }
  }

  [[nodiscard]] bool resident(const LodGroup& group) const noexcept {
    if (options_.resident.empty()) return true;
    for (std::uint32_t i = group.parts.begin; i != group.parts.end; ++i) {
      if (options_.resident[graph_.parts[i].page] == 0) return false;
    }
    return true;
  }

  static bool less(const CutScratch::Candidate& a, const CutScratch::Candidate& b) noexcept {
    return a.error_px != b.error_px ? a.error_px < b.error_px : a.group > b.group;
  }

  const LodGraph& graph_;
  const View& view_;
  const CutOptions& options_;
  CutScratch& scratch_;
  Frustum frustum_;
  bool culls_;
  CutSummary summary_;
  std::uint64_t triangles_ = 0;  // of the whole cut, inside the view or not
};

void CutScratch::reserve(const LodGraph& graph) {
  state_.resize(std::max(state_.size(), graph.groups.size()), 0);
  refined_.reserve(graph.groups.size());
  candidates_.reserve(graph.groups.size());
  missing_.reserve(graph.groups.size());
}

CutSummary select_cut(const LodGraph& graph, const View& view, const CutOptions& options, CutScratch& scratch,
                      std::vector<NodeId>& out) noexcept {
  return CutSelection{graph, view, options, scratch}.run(out);
}

double morph_weight(const LodGraph& graph, const View& view, double limit_px, GroupId group) noexcept {
  const LodGroup& g = graph.groups[group];
  if (group == 0) return 0.0;
  double finest = 0.0;
  for (std::uint32_t i = g.links.begin; i != g.links.end; ++i) {
    const GroupId maker = graph.links[i].maker;
    if (maker == none) break;
    finest = std::max(finest, error_px(view, graph.groups[maker].error_m, graph.groups[maker].bounds));
  }
  const double own = error_px(view, g.error_m, g.bounds);
  if (!(own > finest)) return own <= limit_px ? 1.0 : 0.0;
  return std::clamp((limit_px - finest) / (own - finest), 0.0, 1.0);
}

}  // namespace lodestone
