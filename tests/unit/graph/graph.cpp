// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include <lodestone/lod_graph.h>

#include "base/rng.h"

namespace lodestone {
namespace {

// A line of `leaves` unit intervals along x. Level by level, four neighbours form a group and make two of twice the
// length; groups of odd levels are shifted by two, so that groups hold what two others made: a graph, not a tree.
struct Strip {
  LodGraph graph;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> interval;  // per node: leaves that it covers
  std::uint32_t leaves = 0;
};

Sphere around(std::pair<std::uint32_t, std::uint32_t> interval) {
  const double length = interval.second - interval.first;
  return {{interval.first + length / 2.0, 0.0, 0.0}, length / 2.0};
}

Strip make_strip(std::uint32_t leaves) {
  Strip strip;
  strip.leaves = leaves;
  std::vector<GroupDraft> groups;
  std::vector<NodeDraft> nodes;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> intervals;
  std::vector<std::uint32_t> level(leaves);
  for (std::uint32_t i = 0; i < leaves; ++i) {
    level[i] = i;
    intervals.emplace_back(i, i + 1);
    nodes.push_back({around({i, i + 1}), 1, none, none});
  }
  double error_m = 0.001;
  for (std::size_t offset = 0; level.size() > 1; offset = 2 - offset, error_m *= 2.0) {
    std::vector<std::uint32_t> next;
    std::size_t begin = 0;
    while (begin < level.size()) {
      const bool first_of_shifted = begin == 0 && offset != 0 && level.size() > 4;
      const std::size_t end = std::min(level.size(), first_of_shifted ? offset : begin + 4);
      const auto g = static_cast<GroupId>(groups.size());
      const std::pair whole{intervals[level[begin]].first, intervals[level[end - 1]].second};
      groups.push_back({around(whole), error_m});
      for (std::size_t i = begin; i < end; ++i) nodes[level[i]].group = g;
      const std::uint32_t middle = intervals[level[begin + (end - begin + 1) / 2 - 1]].second;
      for (const auto& half : {std::pair{whole.first, middle}, std::pair{middle, whole.second}}) {
        if (half.first == half.second) continue;
        next.push_back(static_cast<std::uint32_t>(nodes.size()));
        intervals.push_back(half);
        nodes.push_back({around(half), 1, none, g});
      }
      if (level.size() <= 4) {  // the root: one node
        nodes.resize(nodes.size() - (next.size() - 1));
        intervals.resize(nodes.size());
        next.resize(1);
        intervals.back() = whole;
        nodes.back() = {around(whole), 1, none, g};
      }
      begin = end;
    }
    level = next;
  }
  auto assembled = assemble_graph(groups, nodes);
  REQUIRE(assembled.ok());
  strip.graph = std::move(assembled->graph);
  for (const std::uint32_t draft : assembled->node_draft) strip.interval.push_back(intervals[draft]);
  return strip;
}

void require_exact_cover(const Strip& strip, const std::vector<NodeId>& cut) {
  std::vector<std::uint32_t> covered(strip.leaves, 0);
  for (const NodeId n : cut) {
    for (std::uint32_t i = strip.interval[n].first; i != strip.interval[n].second; ++i) ++covered[i];
  }
  REQUIRE(std::count(covered.begin(), covered.end(), 1U) == strip.leaves);
}

View random_view(Rng& rng, double length_m) {
  View view;
  view.eye = {rng.uniform(-0.2, 1.2) * length_m, rng.uniform(0.0, 0.2) * length_m, rng.uniform(-1.0, 1.0)};
  const double angle = rng.uniform(0.0, 6.28);
  view.forward = {std::cos(angle), std::sin(angle), 0.0};
  return view;
}

GroupId maker_of(const LodGraph& graph, NodeId node) {
  for (const LodLink& link : graph.links) {
    if (node >= link.nodes.begin && node < link.nodes.end) return link.maker;
  }
  return none;
}
GroupId group_of(const LodGraph& graph, NodeId node) {
  for (GroupId g = 0; g < graph.groups.size(); ++g) {
    if (node >= graph.groups[g].nodes.begin && node < graph.groups[g].nodes.end) return g;
  }
  return none;
}

}  // namespace

TEST_CASE("assembled graphs are valid whatever the drafts' errors and spheres were") {
  const Strip strip = make_strip(1000);
  REQUIRE(validate(strip.graph).ok());
  REQUIRE(strip.graph.groups[0].nodes.size() == 1);

  std::vector<GroupDraft> groups(2);  // both with error 0 and no sphere to speak of
  const std::vector<NodeDraft> nodes{
      {{{5, 0, 0}, 1}, 7, 0, none}, {{{9, 0, 0}, 1}, 4, 1, 0}, {{{0, 0, 0}, 0}, 2, none, 1}};
  const auto assembled = assemble_graph(groups, nodes);
  REQUIRE(assembled.ok());
  REQUIRE(validate(assembled->graph).ok());
  REQUIRE(assembled->graph.groups[1].error_m > assembled->graph.groups[2].error_m);
  REQUIRE(assembled->graph.groups[1].made_triangle_count == 2);
}

TEST_CASE("drafts that form no graph are refused") {
  const std::vector<GroupDraft> groups(2);
  const Sphere at{{0, 0, 0}, 1};
  const std::vector<NodeDraft> circle{{at, 1, 0, 1}, {at, 1, 1, 0}, {at, 1, none, 0}};
  REQUIRE_FALSE(assemble_graph(groups, circle).ok());
  const std::vector<NodeDraft> unknown{{at, 1, 7, none}};
  REQUIRE_FALSE(assemble_graph(groups, unknown).ok());
  const std::vector<NodeDraft> holds_nothing{{at, 1, 0, none}, {at, 1, none, 0}};
  REQUIRE_FALSE(assemble_graph(groups, holds_nothing).ok());
  const std::vector<GroupDraft> no_number{{{{NAN, 0, 0}, 1}, 1.0}};
  const std::vector<NodeDraft> pair{{at, 1, 0, none}, {at, 1, none, 0}};
  REQUIRE_FALSE(assemble_graph(no_number, pair).ok());
}

TEST_CASE("every cut covers every leaf exactly once, at any camera, budget and set of loaded pages") {
  const Strip strip = make_strip(777);
  Rng rng{1};
  CutScratch scratch;
  std::vector<NodeId> cut;
  std::set<std::size_t> sizes;
  for (int i = 0; i < 300; ++i) {
    const View view = random_view(rng, 777.0);
    std::vector<std::uint8_t> resident(strip.graph.page_count, 1);
    if (i % 3 == 1) {
      for (auto& page : resident) page = rng.unit() < 0.9 ? 1 : 0;
    }
    CutOptions options;
    options.error_px = std::exp2(rng.uniform(-6.0, 6.0));
    options.culling = Culling::None;
    options.resident = resident;
    if (i % 3 == 2) options.triangle_budget = 1 + rng.below(800);
    const CutSummary summary = select_cut(strip.graph, view, options, scratch, cut);
    require_exact_cover(strip, cut);
    REQUIRE(summary.triangle_count == cut.size());
    if (options.triangle_budget != 0) REQUIRE(cut.size() <= options.triangle_budget);
    sizes.insert(cut.size());
  }
  REQUIRE(sizes.size() > 30);
}

TEST_CASE("a node is drawn if its own error is within the limit and its parent's above it") {
  const Strip strip = make_strip(500);
  Rng rng{2};
  CutScratch scratch;
  std::vector<NodeId> cut;
  for (int i = 0; i < 50; ++i) {
    const View view = random_view(rng, 500.0);
    const CutOptions options{.error_px = std::exp2(rng.uniform(-4.0, 4.0)), .culling = Culling::None};
    select_cut(strip.graph, view, options, scratch, cut);
    const std::set<NodeId> drawn(cut.begin(), cut.end());
    const auto above = [&](GroupId g) {
      return error_px(view, strip.graph.groups[g].error_m, strip.graph.groups[g].bounds) > options.error_px;
    };
    for (NodeId n = 0; n < strip.graph.nodes.size(); ++n) {
      const GroupId maker = maker_of(strip.graph, n);
      const GroupId group = group_of(strip.graph, n);
      REQUIRE(drawn.contains(n) == ((group == 0 || above(group)) && (maker == none || !above(maker))));
    }
  }
}

TEST_CASE("culling leaves out only what the view does not touch") {
  const Strip strip = make_strip(2000);
  Rng rng{3};
  CutScratch scratch;
  std::vector<NodeId> all;
  std::vector<NodeId> seen;
  std::size_t left_out = 0;
  for (int i = 0; i < 100; ++i) {
    const View view = random_view(rng, 2000.0);
    CutOptions options{.error_px = 0.1, .culling = Culling::None};
    select_cut(strip.graph, view, options, scratch, all);
    options.culling = Culling::Frustum;
    const CutSummary summary = select_cut(strip.graph, view, options, scratch, seen);
    REQUIRE(summary.groups_tested <= strip.graph.groups.size());
    const std::set<NodeId> inside(seen.begin(), seen.end());
    const double tan_y = std::tan(view.fov_y_rad / 2);
    const double tan_x = tan_y * view.width_px / view.height_px;
    const glm::dvec3 right = glm::normalize(glm::cross(view.forward, view.up));
    for (const NodeId n : all) {
      const glm::dvec3 d = strip.graph.nodes[n].bounds.center - view.eye;
      const double z = glm::dot(d, view.forward);
      const bool center_seen = z > 0.0 && std::abs(glm::dot(d, right)) < tan_x * z && std::abs(d.z) < tan_y * z;
      if (center_seen) REQUIRE(inside.contains(n));
    }
    left_out += all.size() - seen.size();
  }
  REQUIRE(left_out > 1000);
}

TEST_CASE("what is missing is told, with the error that it would remove") {
  const Strip strip = make_strip(256);
  CutScratch scratch;
  std::vector<NodeId> cut;
  std::vector<std::uint8_t> resident(strip.graph.page_count, 0);
  resident[0] = 1;
  const View view{.eye = {128, -10, 0}};
  const CutOptions options{.error_px = 0.5, .culling = Culling::None, .resident = resident};
  const CutSummary summary = select_cut(strip.graph, view, options, scratch, cut);
  REQUIRE(cut.size() == 1);
  REQUIRE(scratch.missing().size() == 1);
  REQUIRE(scratch.missing()[0].error_px == summary.max_error_px);
  // Loading what is asked for leads to the full cut.
  int rounds = 0;
  for (; !scratch.missing().empty(); ++rounds) {
    const std::vector<MissingGroup> missing(scratch.missing().begin(), scratch.missing().end());
    for (const MissingGroup& m : missing) {
      const Range parts = strip.graph.groups[m.group].parts;
      for (std::uint32_t p = parts.begin; p != parts.end; ++p) resident[strip.graph.parts[p].page] = 1;
    }
    select_cut(strip.graph, view, options, scratch, cut);
    require_exact_cover(strip, cut);
  }
  std::vector<NodeId> full;
  select_cut(strip.graph, view, {.error_px = 0.5, .culling = Culling::None}, scratch, full);
  std::sort(full.begin(), full.end());
  std::sort(cut.begin(), cut.end());
  REQUIRE(cut == full);
  REQUIRE(rounds < 12);
}

TEST_CASE("the morph of a group ends where it is exchanged and has not begun where its nodes appear") {
  const Strip strip = make_strip(512);
  const LodGraph& graph = strip.graph;
  Rng rng{4};
  std::size_t under_way = 0;
  for (int i = 0; i < 200; ++i) {
    const View view = random_view(rng, 512.0);
    for (GroupId g = 1; g < graph.groups.size(); ++g) {
      const double own = error_px(view, graph.groups[g].error_m, graph.groups[g].bounds);
      REQUIRE(morph_weight(graph, view, own, g) == 1.0);
      const Range links = graph.groups[g].links;
      for (std::uint32_t l = links.begin; l != links.end; ++l) {
        const GroupId maker = graph.links[l].maker;
        if (maker == none) continue;
        REQUIRE(morph_weight(graph, view, error_px(view, graph.groups[maker].error_m, graph.groups[maker].bounds), g) ==
                0.0);
      }
      const double weight = morph_weight(graph, view, 1.0, g);
      REQUIRE((weight >= 0.0 && weight <= 1.0));
      under_way += weight > 0.0 && weight < 1.0 ? 1U : 0U;
    }
  }
  REQUIRE(under_way > 100);
  REQUIRE(morph_weight(graph, View{}, 1.0, 0) == 0.0);
}

TEST_CASE("graphs from files are not trusted: every broken promise is found") {
  const LodGraph good = make_strip(100).graph;
  REQUIRE(validate(good).ok());
  REQUIRE(validate(LodGraph{}).ok());
  const auto broken = [&](auto&& change) {
    LodGraph graph = good;
    change(graph);
    return !validate(graph).ok();
  };
  CHECK(broken([](LodGraph& g) { g.groups[0].error_m = 1.0; }));
  CHECK(broken([](LodGraph& g) { g.groups[2].error_m = g.groups[1].error_m = 1.0; }));
  CHECK(broken([](LodGraph& g) { g.groups[3].error_m = NAN; }));
  CHECK(broken([](LodGraph& g) { g.groups[1].bounds.radius_m *= 0.99; }));
  CHECK(broken([](LodGraph& g) { g.nodes.back().bounds.radius_m += 1.0; }));
  CHECK(broken([](LodGraph& g) { g.groups[4].bounds.center.x = NAN; }));
  CHECK(broken([](LodGraph& g) { ++g.groups[4].parent_count; }));
  CHECK(broken([](LodGraph& g) { ++g.groups[4].triangle_count; }));
  CHECK(broken([](LodGraph& g) { ++g.groups[4].made_triangle_count; }));
  CHECK(broken([](LodGraph& g) { g.links[0].maker = 0; }));
  CHECK(broken([](LodGraph& g) { g.links[0].maker = 100000; }));
  CHECK(broken([](LodGraph& g) { ++g.groups[2].nodes.end; }));
  CHECK(broken([](LodGraph& g) { g.parts[3].page = g.page_count; }));
  CHECK(broken([](LodGraph& g) { g.parts.pop_back(); }));
  CHECK(broken([](LodGraph& g) { g.nodes.pop_back(); }));
  CHECK(broken([](LodGraph& g) { g.groups.clear(); }));
}

TEST_CASE("buffers that are reserved do not grow") {
  const Strip strip = make_strip(1000);
  CutScratch scratch;
  scratch.reserve(strip.graph);
  std::vector<NodeId> cut;
  cut.reserve(strip.graph.nodes.size());
  const NodeId* const before = cut.data();
  Rng rng{5};
  for (int i = 0; i < 100; ++i) {
    select_cut(strip.graph, random_view(rng, 1000.0), {.error_px = 0.1, .triangle_budget = i % 2 == 0 ? 0U : 500U},
               scratch, cut);
  }
  REQUIRE(cut.data() == before);
  REQUIRE(scratch.refined().size() <= strip.graph.groups.size());
}

}  // namespace lodestone
