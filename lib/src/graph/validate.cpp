// SPDX-License-Identifier: MIT
#include <cmath>
#include <string>

#include <lodestone/lod_graph.h>

#include "graph/enclose.h"

namespace lodestone {
namespace {

class GraphCheck {
 public:
  explicit GraphCheck(const LodGraph& graph) : graph_(graph) {}

  Status run() {
    if (!check_order() || !check_groups() || !check_made()) return Error{ErrorCode::BadData, fault_, where_};
    return Done{};
  }

 private:
  bool fail(const char* message, std::size_t group) {
    fault_ = message;
    where_ = "group " + std::to_string(group);
    return false;
  }

  // The ranges of all groups follow each other and cover everything.
  bool check_order() {
    if (graph_.groups.empty()) {
      return graph_.nodes.empty() && graph_.links.empty() && graph_.parts.empty() ? true
                                                                                  : fail("there are no groups", 0);
    }
    std::uint32_t nodes = 0;
    std::uint32_t links = 0;
    std::uint32_t parts = 0;
    const auto follows = [](const Range& range, std::uint32_t& at, std::size_t size) {
      const bool ok = range.begin == at && range.end >= range.begin && range.end <= size;
      at = range.end;
      return ok;
    };
    for (std::size_t g = 0; g < graph_.groups.size(); ++g) {
      const LodGroup& group = graph_.groups[g];
      if (!follows(group.nodes, nodes, graph_.nodes.size()) || !follows(group.links, links, graph_.links.size()) ||
          !follows(group.parts, parts, graph_.parts.size())) {
        return fail("the groups do not cover the nodes in order", g);
      }
      if (group.nodes.empty() && graph_.groups.size() > 1) return fail("a group is empty", g);
    }
    if (nodes != graph_.nodes.size() || links != graph_.links.size() || parts != graph_.parts.size()) {
      return fail("nodes belong to no group", graph_.groups.size());
    }
    return true;
  }

  bool check_groups() {
    if (graph_.groups.empty()) return true;
    if (!(std::isinf(graph_.groups[0].error_m) && graph_.groups[0].error_m > 0.0)) {
      return fail("the roots must have an infinite error", 0);
    }
    for (GroupId g = 0; g < graph_.groups.size(); ++g) {
      if (!check_links(g) || !check_parts(g) || !check_nodes(g)) return false;
    }
    return true;
  }

  bool check_links(GroupId g) {
    const LodGroup& group = graph_.groups[g];
    std::uint32_t at = group.nodes.begin;
    std::int64_t last = g;  // makers ascend, and stand behind the group
    for (std::uint32_t i = group.links.begin; i != group.links.end; ++i) {
      const LodLink& link = graph_.links[i];
      if (link.nodes.begin != at || link.nodes.end <= at || link.nodes.end > group.nodes.end) {
        return fail("links do not cover the group", g);
      }
      at = link.nodes.end;
      if (std::int64_t{link.maker} <= last) return fail("groups do not go from coarse to fine", g);
      last = link.maker;
      if (link.maker == none) continue;
      if (link.maker >= graph_.groups.size()) return fail("a link names no group", g);
      const LodGroup& maker = graph_.groups[link.maker];
      if (!(maker.error_m < group.error_m)) return fail("the error does not grow towards the roots", g);
      if (!encloses(group.bounds, maker.bounds)) return fail("a sphere does not enclose that of a finer group", g);
    }
    return at == group.nodes.end ? true : fail("links do not cover the group", g);
  }

  bool check_parts(GroupId g) {
    const LodGroup& group = graph_.groups[g];
    std::uint32_t at = group.nodes.begin;
    for (std::uint32_t i = group.parts.begin; i != group.parts.end; ++i) {
      const LodPart& part = graph_.parts[i];
      const bool ascends = i == group.parts.begin || part.page > graph_.parts[i - 1].page;
      if (part.nodes.begin != at || part.nodes.end <= at || part.page >= graph_.page_count || !ascends) {
        return fail("parts do not cover the group page by page", g);
      }
      at = part.nodes.end;
    }
    return at == group.nodes.end ? true : fail("parts do not cover the group page by page", g);
  }

  bool check_nodes(GroupId g) {
    const LodGroup& group = graph_.groups[g];
    const glm::dvec3& c = group.bounds.center;
    if (!std::isfinite(c.x + c.y + c.z + group.bounds.radius_m) || !(group.error_m >= 0.0) ||
        (g > 0 && std::isinf(group.error_m))) {
      return fail("a bound or error is not a number", g);
    }
    std::uint64_t triangles = 0;
    for (NodeId n = group.nodes.begin; n != group.nodes.end; ++n) {
      if (!encloses(group.bounds, graph_.nodes[n].bounds)) return fail("a sphere does not enclose its nodes", g);
      triangles += graph_.nodes[n].triangle_count;
    }
    return triangles == group.triangle_count ? true : fail("the triangles are miscounted", g);
  }

  // The coarse side: how often each group is held, and how many triangles it made.
  bool check_made() {
    std::vector<std::uint32_t> parents(graph_.groups.size(), 0);
    std::vector<std::uint64_t> made(graph_.groups.size(), 0);
    for (const LodLink& link : graph_.links) {
      if (link.maker == none) continue;
      ++parents[link.maker];
      for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) {
        made[link.maker] += graph_.nodes[n].triangle_count;
        if (!encloses(graph_.groups[link.maker].bounds, graph_.nodes[n].bounds)) {
          return fail("a sphere does not enclose what the group made", link.maker);
        }
      }
    }
    for (std::size_t g = 0; g < graph_.groups.size(); ++g) {
      const LodGroup& group = graph_.groups[g];
      if (parents[g] != group.parent_count || (g > 0 && parents[g] == 0)) return fail("the parents are miscounted", g);
      if (made[g] != group.made_triangle_count) return fail("the triangles are miscounted", g);
    }
    return true;
  }

  const LodGraph& graph_;
  std::string fault_;
  std::string where_;
};

}  // namespace

Status validate(const LodGraph& graph) { return GraphCheck{graph}.run(); }

}  // namespace lodestone
