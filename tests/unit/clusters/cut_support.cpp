// SPDX-License-Identifier: MIT
#include "cut_support.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace lodestone::test {

View random_view(Rng& rng, const Sphere& around) {
  View view;
  const auto place = [&] { return glm::dvec3{rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)}; };
  view.eye = around.center + around.radius_m * place();
  return view;
}

// Any phase for a group whose nodes are all drawn; one of whose nodes stand finer ones must stay at rest.
static void random_phases(const LodGraph& graph, std::span<const GroupId> refined, Rng& rng,
                          std::vector<double>& weights) {
  std::fill(weights.begin(), weights.end(), 0.0);
  std::vector<std::uint8_t> is_refined(graph.groups.size(), 0);
  for (const GroupId g : refined) is_refined[g] = 1;
  for (const GroupId g : refined) {
    const Range links = graph.groups[g].links;
    bool all_drawn = g != 0;
    for (std::uint32_t l = links.begin; l != links.end; ++l) {
      const GroupId maker = graph.links[l].maker;
      all_drawn = all_drawn && (maker == none || is_refined[maker] == 0);
    }
    if (all_drawn) weights[g] = rng.unit();
  }
}

FaultCounts try_cuts(const ClusterGraph& graph, int cameras, std::uint64_t seed) {
  Rng rng{seed};
  FaultCounts counts;
  CutScratch scratch;
  std::vector<NodeId> cut;
  std::set<std::vector<NodeId>> cuts;
  std::vector<double> weights(graph.graph.groups.size());
  const std::vector<std::uint8_t> border = true_border(graph);
  for (int i = 0; i < cameras; ++i) {
    const View view = random_view(rng, graph.graph.groups[0].bounds);
    CutOptions options{.error_px = std::exp2(rng.uniform(-4, 6)), .culling = Culling::None};
    std::vector<std::uint8_t> resident;
    if (i % 2 == 1) {
      for (PageId p = 0; p < graph.graph.page_count; ++p) resident.push_back(rng.unit() < 0.95 ? 1 : 0);
      options.resident = resident;
    }
    select_cut(graph.graph, view, options, scratch, cut);
    counts.cracks += find_faults(graph, cut, extract(graph, cut), border).cracks;
    random_phases(graph.graph, scratch.refined(), rng, weights);
    counts.morphed_cracks += find_faults(graph, cut, extract_morphed(graph, cut, weights), border).cracks;
    cuts.insert(cut);
  }
  counts.different_cuts = cuts.size();
  return counts;
}

// Refined groups, coarse before fine, with what they draw in `cut`.
static std::vector<GroupId> random_labelling(const LodGraph& graph, Rng& rng, std::vector<NodeId>& cut) {
  const double share = rng.unit();
  std::vector<std::uint8_t> is_refined(graph.groups.size(), 0);
  std::vector<std::uint32_t> refined_parents(graph.groups.size(), 0);
  std::vector<GroupId> refined;
  for (GroupId g = 0; g < graph.groups.size(); ++g) {
    const LodGroup& group = graph.groups[g];
    if (g > 0 && (refined_parents[g] != group.parent_count || rng.unit() > share)) continue;
    is_refined[g] = 1;
    refined.push_back(g);
    for (std::uint32_t l = group.links.begin; l != group.links.end; ++l) {
      if (graph.links[l].maker != none) ++refined_parents[graph.links[l].maker];
    }
  }
  cut.clear();
  for (const GroupId g : refined) {
    for (std::uint32_t l = graph.groups[g].links.begin; l != graph.groups[g].links.end; ++l) {
      const LodLink& link = graph.links[l];
      if (link.maker != none && is_refined[link.maker] != 0) continue;
      for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) cut.push_back(n);
    }
  }
  return refined;
}

FaultCounts try_labellings(const ClusterGraph& graph, int labellings, std::uint64_t seed) {
  Rng rng{seed};
  FaultCounts counts;
  std::vector<NodeId> cut;
  std::set<std::vector<NodeId>> cuts;
  std::vector<double> weights(graph.graph.groups.size());
  const std::vector<std::uint8_t> border = true_border(graph);
  for (int i = 0; i < labellings; ++i) {
    const std::vector<GroupId> refined = random_labelling(graph.graph, rng, cut);
    counts.cracks += find_faults(graph, cut, extract(graph, cut), border).cracks;
    random_phases(graph.graph, refined, rng, weights);
    counts.morphed_cracks += find_faults(graph, cut, extract_morphed(graph, cut, weights), border).cracks;
    cuts.insert(cut);
  }
  counts.different_cuts = cuts.size();
  return counts;
}

std::vector<NodeId> leaves(const ClusterGraph& graph) {
  std::vector<NodeId> result;
  for (const LodLink& link : graph.graph.links) {
    if (link.maker != none) continue;
    for (NodeId n = link.nodes.begin; n != link.nodes.end; ++n) result.push_back(n);
  }
  return result;
}

}  // namespace lodestone::test
