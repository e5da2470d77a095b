// SPDX-License-Identifier: MIT
// Based on: Wang et al. 2023, section 2.5 (errors and bounds raised from the leaves up until they are monotone).
#include <algorithm>
#include <cmath>
#include <numeric>

#include <lodestone/lod_graph.h>

#include "graph/enclose.h"

namespace lodestone {
namespace {

// Fine to coarse.
void raise_errors(LodGraph& graph, double error_step) {
  for (auto g = static_cast<GroupId>(graph.groups.size()); g-- > 1;) {
    LodGroup& group = graph.groups[g];
    for (std::uint32_t i = group.links.begin; i != group.links.end; ++i) {
      const GroupId maker = graph.links[i].maker;
      if (maker == none) break;
      const double below = graph.groups[maker].error_m;
      group.error_m = std::max({group.error_m, below * (1.0 + error_step), std::nextafter(below, 1e300)});
    }
  }
}

void enlarge_spheres(LodGraph& graph) {
  std::vector<double> radius_m(graph.groups.size(), 0.0);
  const auto enclose = [&](GroupId g, const Sphere& inner) {
    radius_m[g] = std::max(radius_m[g], reach_m(graph.groups[g].bounds, inner));
  };
  for (const LodGroup& group : graph.groups) {
    for (std::uint32_t i = group.links.begin; i != group.links.end; ++i) {
      const LodLink& link = graph.links[i];
      for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) {
        enclose(static_cast<GroupId>(&group - graph.groups.data()), graph.nodes[n].bounds);
        if (link.maker != none) enclose(link.maker, graph.nodes[n].bounds);
      }
    }
  }
  for (auto g = static_cast<GroupId>(graph.groups.size()); g-- > 0;) {
    LodGroup& group = graph.groups[g];
    for (std::uint32_t i = group.links.begin; i != group.links.end; ++i) {
      if (graph.links[i].maker != none) enclose(g, graph.groups[graph.links[i].maker].bounds);
    }
    group.bounds.radius_m = std::max(group.bounds.radius_m, radius_m[g]);
    const glm::dvec3 c = glm::abs(group.bounds.center);
    // The second term keeps spheres of a point, far from the origin, from missing by a rounding.
    group.bounds.radius_m += 1e-6 * group.bounds.radius_m + 1e-14 * (c.x + c.y + c.z);
  }
}

class Assembly {
 public:
  Assembly(std::span<const GroupDraft> groups, std::span<const NodeDraft> nodes, double error_step)
      : groups_(groups), nodes_(nodes), error_step_(error_step) {}

  Result<AssembledGraph> run() {
    if (Status status = check(); !status.ok()) return status.error();
    if (!sort_groups()) return Error{ErrorCode::BadData, "a group holds what was made of it", "groups"};
    place_groups();
    place_nodes();
    keep_promises(result_.graph, error_step_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] static bool finite(const Sphere& s) {
    return std::isfinite(s.center.x + s.center.y + s.center.z + s.radius_m) && s.radius_m >= 0.0;
  }

  [[nodiscard]] Status check() const {
    for (const GroupDraft& g : groups_) {
      if (!finite(g.bounds) || !(std::isfinite(g.error_m) && g.error_m >= 0.0)) {
        return Error{ErrorCode::BadData, "a group has a bound or error that is not a number", "groups"};
      }
    }
    std::vector<std::uint8_t> holds(groups_.size(), 0);
    for (const NodeDraft& n : nodes_) {
      const bool known = (n.group == none || n.group < groups_.size()) && (n.maker == none || n.maker < groups_.size());
      if (!known || !finite(n.bounds)) {
        return Error{ErrorCode::BadData, "a node names no group or has no finite bound", "nodes"};
      }
      if (n.group != none) holds[n.group] |= 1U;
      if (n.maker != none) holds[n.maker] |= 2U;
    }
    if (std::any_of(holds.begin(), holds.end(), [](std::uint8_t h) { return h != 3; })) {
      return Error{ErrorCode::BadData, "a group has no nodes or made none", "groups"};
    }
    return Done{};
  }

  // Levels from the roots: a group stands one below the deepest group that holds what it made.
  bool sort_groups() {
    std::vector<std::uint32_t> parents(groups_.size(), 0);  // nodes that keep it waiting
    for (const NodeDraft& n : nodes_) {
      if (n.maker != none && n.group != none) ++parents[n.maker];
    }
    std::vector<std::uint32_t> by_group(nodes_.size());
    std::iota(by_group.begin(), by_group.end(), 0U);
    std::stable_sort(by_group.begin(), by_group.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return nodes_[a].group < nodes_[b].group; });
    for (GroupId g = 0; g < groups_.size(); ++g) {
      if (parents[g] == 0) order_.push_back(g);
    }
    for (std::size_t i = 0; i < order_.size(); ++i) {
      auto at = std::lower_bound(by_group.begin(), by_group.end(), order_[i],
                                 [&](std::uint32_t n, GroupId g) { return nodes_[n].group < g; });
      for (; at != by_group.end() && nodes_[*at].group == order_[i]; ++at) {
        const GroupId maker = nodes_[*at].maker;
        if (maker != none && --parents[maker] == 0) order_.push_back(maker);
      }
    }
    return order_.size() == groups_.size();
  }

  void place_groups() {
    LodGraph& graph = result_.graph;
    place_.assign(groups_.size(), none);
    graph.groups.resize(groups_.size() + 1);
    result_.group_draft.assign(1, none);
    graph.groups[0].error_m = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      place_[order_[i]] = i + 1;
      result_.group_draft.push_back(order_[i]);
      graph.groups[i + 1].bounds = groups_[order_[i]].bounds;
      graph.groups[i + 1].error_m = groups_[order_[i]].error_m;
    }
  }

  [[nodiscard]] GroupId group_of(std::uint32_t draft) const {
    return nodes_[draft].group == none ? 0 : place_[nodes_[draft].group];
  }
  [[nodiscard]] GroupId maker_of(std::uint32_t draft) const {
    return nodes_[draft].maker == none ? none : place_[nodes_[draft].maker];
  }

  void place_nodes() {
    LodGraph& graph = result_.graph;
    std::vector<std::uint32_t>& order = result_.node_draft;
    order.resize(nodes_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return group_of(a) != group_of(b) ? group_of(a) < group_of(b) : maker_of(a) < maker_of(b);
    });
    Box all;
    for (NodeId n = 0; n < order.size(); ++n) {
      const NodeDraft& draft = nodes_[order[n]];
      const GroupId g = group_of(order[n]);
      const GroupId maker = maker_of(order[n]);
      LodGroup& group = graph.groups[g];
      if (group.nodes.empty()) {
        group.nodes = {n, n};
        group.links.begin = group.links.end = static_cast<std::uint32_t>(graph.links.size());
      }
      if (group.links.empty() || graph.links.back().maker != maker) {
        graph.links.push_back({maker, {n, n}});
        ++group.links.end;
        if (maker != none) ++graph.groups[maker].parent_count;
      }
      group.nodes.end = graph.links.back().nodes.end = n + 1;
      group.parts = group.nodes;
      group.triangle_count += draft.triangle_count;
      if (maker != none) graph.groups[maker].made_triangle_count += draft.triangle_count;
      graph.nodes.push_back({draft.bounds, draft.triangle_count});
      graph.parts.push_back({{n, n + 1}, n});
      all.add(draft.bounds.center);
    }
    graph.page_count = static_cast<std::uint32_t>(order.size());
    if (!all.empty()) graph.groups[0].bounds.center = all.center();
  }

  std::span<const GroupDraft> groups_;
  std::span<const NodeDraft> nodes_;
  double error_step_;
  std::vector<GroupId> order_;  // drafts, coarse to fine
  std::vector<GroupId> place_;  // per draft: its group
  AssembledGraph result_;
};

}  // namespace

void keep_promises(LodGraph& graph, double error_step) {
  raise_errors(graph, error_step);
  enlarge_spheres(graph);
}

Result<AssembledGraph> assemble_graph(std::span<const GroupDraft> groups, std::span<const NodeDraft> nodes,
                                      double error_step) {
  return Assembly{groups, nodes, error_step}.run();
}

}  // namespace lodestone
