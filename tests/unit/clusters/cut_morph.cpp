// SPDX-License-Identifier: MIT
#include <lodestone/cut_morph.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "cut_support.h"
#include "shapes.h"

namespace lodestone::test {
namespace {

// What is seen of each group between two frames.
struct Seen {
  std::map<GroupId, double> weight;
};

void require_no_jump(const Seen& before, const Seen& after, double step) {
  for (const auto& [g, weight] : after.weight) {
    const auto at = before.weight.find(g);
    REQUIRE(std::abs(weight - (at == before.weight.end() ? 1.0 : at->second)) <= step + 1e-9);
  }
  for (const auto& [g, weight] : before.weight) {
    if (!after.weight.contains(g)) REQUIRE(1.0 - weight <= step + 1e-9);
  }
}

Seen seen_of(const CutMorph& morph) {
  Seen seen;
  for (const GroupId g : morph.refined()) {
    if (g != 0) seen.weight[g] = morph.weights()[g];
  }
  return seen;
}

}  // namespace

TEST_CASE(
    "after any jump of the camera groups come and go only at the end of a morph, without cracks, in bounded time") {
  const auto graph = build_cluster_graph(grid(70, 70), {.max_triangles = 32, .group_clusters = 8});
  REQUIRE(graph.ok());
  const std::vector<std::uint8_t> border = true_border(*graph);
  constexpr double duration_s = 0.5;
  constexpr double dt_s = 1.0 / 60.0;
  CutMorph morph{graph->graph, duration_s};
  CutScratch scratch;
  std::vector<NodeId> cut;
  std::vector<NodeId> wanted;
  Rng rng{11};
  std::size_t under_way = 0;
  for (int jump = 0; jump < 8; ++jump) {
    const View view = random_view(rng, graph->graph.groups[0].bounds);
    const CutOptions options{.error_px = std::exp2(rng.uniform(-3, 5)), .culling = Culling::None};
    int frames = 0;
    for (; frames < 100; ++frames) {
      const Seen before = seen_of(morph);
      morph.update(view, options, dt_s, scratch, cut);
      if (jump > 0) require_no_jump(before, seen_of(morph), 16 * dt_s / duration_s);
      const auto is_on_its_way = [](const auto& g) { return g.second > 0.0 && g.second < 1.0; };
      const Seen now = seen_of(morph);
      under_way += static_cast<std::size_t>(std::count_if(now.weight.begin(), now.weight.end(), is_on_its_way));
      if (frames % 5 == 0) {
        REQUIRE(find_faults(*graph, cut, extract_morphed(*graph, cut, morph.weights()), border).cracks == 0);
      }
      if (morph.settled()) break;
    }
    // Once more up and once more down each level takes at least a frame.
    REQUIRE(frames * dt_s < 2.0 * duration_s + 24 * dt_s);
    select_cut(graph->graph, view, options, scratch, wanted);
    REQUIRE(std::set<NodeId>(cut.begin(), cut.end()) == std::set<NodeId>(wanted.begin(), wanted.end()));
  }
  REQUIRE(under_way > 20);
}

TEST_CASE("groups whose pages went away are dropped at once, and the cut stays whole") {
  const auto graph = build_cluster_graph(grid(80, 80));
  REQUIRE(graph.ok());
  const std::vector<std::uint8_t> border = true_border(*graph);
  CutMorph morph{graph->graph};
  CutScratch scratch;
  std::vector<NodeId> cut;
  Rng rng{12};
  const View view = random_view(rng, graph->graph.groups[0].bounds);
  for (int frame = 0; frame < 20; ++frame) {
    std::vector<std::uint8_t> resident;
    for (PageId p = 0; p < graph->graph.page_count; ++p) resident.push_back(rng.unit() < 0.98 ? 1 : 0);
    morph.update(view, {.error_px = 0.1, .culling = Culling::None, .resident = resident}, 0.02, scratch, cut);
    for (const NodeId n : cut) REQUIRE((n < graph->graph.groups[0].nodes.end || resident[n] != 0));
    REQUIRE(find_faults(*graph, cut, extract_morphed(*graph, cut, morph.weights()), border).cracks == 0);
  }
}

}  // namespace lodestone::test
