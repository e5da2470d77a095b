// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998 (cost); passes over flat arrays in the manner of multi-choice and independent-set
// collapse (Jones 1999 onwards).
// Differs: a pass sorts the cheapest share of the edges and collapses them in order, each point at most once, with
// placement, cost and flips taken from the mesh as it is at that moment. Points lie in Morton order and each
// pass cuts them into regions of fixed size that share no face, so that any number of threads gives the same bytes.
#include "collapse/engine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/radix_sort.h"
#include "collapse/candidates.h"
#include "collapse/collapser.h"

namespace lodestone::collapse {
namespace {

constexpr double first_share = 0.35;             // of the edges are tried in a pass
constexpr double slack = 2.0;                    // exact cost over the estimated cost of the dearest edge tried
constexpr std::uint32_t region_points = 16'384;  // fewer points than twice this are one region
constexpr std::uint32_t max_regions = 64;
constexpr std::uint32_t key_steps = 8;  // of cost in a pass; within one step records are ordered in space

class Engine {
 public:
  Engine(const Mesh& source, const EdgeCollapseOptions& options, const Context& context, Sink& sink)
      : source_(source), options_(options), context_(context), sink_(sink), faces_left_(source.triangle_count()) {}

  CollapseReport run();

 private:
  struct Region {
    Range points;
    std::vector<Candidate> edges;
    PassLog log;
    std::vector<std::uint32_t> order;
    std::array<std::uint32_t, refusal_count> refusals{};
  };

  void drop_degenerate(const std::vector<FaceId>& faces);
  void cut_regions();
  void fill_regions(const Candidates& candidates);
  void collapse_region(Region& region, PassState& state) const;
  std::uint32_t flush();
  bool pass(double share);
  [[nodiscard]] bool done() const { return faces_left_ <= options_.target_triangles || context_.cancelled(); }

  const Mesh& source_;
  const EdgeCollapseOptions& options_;
  const Context& context_;
  Sink& sink_;
  WorkingMesh mesh_;
  std::vector<Region> regions_;
  std::uint32_t faces_left_;
  std::uint32_t pass_ = 0;
  double diagonal_m_ = 0.0;
  bool relaxed_ = false;
  bool looks_matter_ = false;
};

// Equal parts of the points; every other pass they lie half a part further on, so that no edge stays between two.
void Engine::cut_regions() {
  const std::uint32_t points = mesh_.point_count();
  const std::uint32_t count = std::clamp(points / region_points, 1U, max_regions);
  std::vector<std::uint32_t> cuts{0};
  const std::uint64_t shift = count > 1 && pass_ % 2 == 1 ? points / count / 2 : 0;
  if (shift != 0) cuts.push_back(static_cast<std::uint32_t>(shift));
  for (std::uint64_t i = 1; i < count; ++i) cuts.push_back(static_cast<std::uint32_t>(points * i / count + shift));
  cuts.push_back(points);
  regions_.clear();
  regions_.resize(cuts.size() - 1);
  for (std::size_t i = 0; i < regions_.size(); ++i) regions_[i].points = {cuts[i], cuts[i + 1]};
}

void Engine::fill_regions(const Candidates& candidates) {
  std::vector<std::uint32_t> ends;
  for (const Region& region : regions_) ends.push_back(region.points.end);
  for (const Candidate& c : candidates.edges) {
    const auto at = std::upper_bound(ends.begin(), ends.end(), c.u) - ends.begin();
    if (c.v < ends[static_cast<std::size_t>(at)]) regions_[static_cast<std::size_t>(at)].edges.push_back(c);
  }
}

void Engine::collapse_region(Region& region, PassState& state) const {
  radix_sort(region.edges);
  Collapser collapser{state, region.points, region.log};
  const std::size_t count = region.edges.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 4096 == 0 && context_.cancelled()) return;
    const Candidate& c = region.edges[i];
    const auto step = static_cast<std::uint32_t>(i * key_steps / count);
    const std::uint32_t key = step << 24U | (c.u - region.points.begin) >> 6U;
    const Refusal refusal = collapser.attempt(c.u, c.v, key);
    ++region.refusals[static_cast<std::size_t>(refusal)];
  }
  region.order.resize(region.log.size());
  std::iota(region.order.begin(), region.order.end(), 0U);
  std::stable_sort(region.order.begin(), region.order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return region.log.key(a) < region.log.key(b); });
}

// Hands the records over, cost step by cost step through all regions; returns how many collapses there were.
std::uint32_t Engine::flush() {
  std::uint32_t records = 0;
  std::vector<std::size_t> at(regions_.size(), 0);
  for (std::uint32_t step = 0; step < key_steps; ++step) {
    for (std::size_t r = 0; r < regions_.size(); ++r) {
      Region& region = regions_[r];
      for (; at[r] < region.order.size() && region.log.key(region.order[at[r]]) >> 24U == step && !done(); ++at[r]) {
        const Edit edit = region.log.edit(region.order[at[r]]);
        sink_.record(edit);
        faces_left_ -= static_cast<std::uint32_t>(edit.faces.size());
        ++records;
      }
    }
  }
  return records;
}

bool Engine::pass(double share) {
  compact(mesh_, context_);
  const std::vector<Symmetric3> quadrics = sum_quadrics(mesh_, options_, context_);
  const Candidates candidates = find_candidates(mesh_, quadrics, options_.placement, share, context_);
  if (context_.cancelled() || candidates.edges.empty()) return false;
  PassState state{mesh_, source_, options_, diagonal_m_, 0.0, looks_matter_, relaxed_, {}, {}};
  state.cost_limit = slack * static_cast<double>(candidates.threshold);
  state.stamps.assign(mesh_.point_count(), 0);
  state.last_key.assign(mesh_.point_count(), 0);
  cut_regions();
  fill_regions(candidates);
  parallel_chunks(regions_.size(), 1, context_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) collapse_region(regions_[i], state);
  });
  if (context_.cancelled()) return false;
  ++pass_;
  return flush() != 0;
}

void Engine::drop_degenerate(const std::vector<FaceId>& faces) {
  for (const FaceId f : faces) {
    if (done()) return;
    PassLog log;
    log.faces.push_back(f);
    // Vertices that only such faces use stay: a vertex that no face names is never drawn.
    log.end(0, 0.0F);
    sink_.record(log.edit(0));
    --faces_left_;
  }
}

CollapseReport Engine::run() {
  WorkingMeshStart start = make_working_mesh(source_, options_, context_);
  mesh_ = std::move(start.mesh);
  diagonal_m_ = bounds(source_).diagonal_m();
  looks_matter_ = mesh_.has_seams() || !source_.face_materials.empty();
  drop_degenerate(start.degenerate);
  double share = first_share;
  const double total = static_cast<double>(source_.triangle_count());
  while (!done()) {
    const std::uint32_t before = faces_left_;
    const bool any = pass(share);
    context_.report("collapse", 1.0 - faces_left_ / total);
    if (!any && share >= 1.0) break;
    share = before - faces_left_ <= before / 20 ? std::min(1.0, share * 2.0) : first_share;
  }
  CollapseReport report;
  report.target_reached = faces_left_ <= options_.target_triangles;
  return report;
}

}  // namespace

Status check(const Mesh& mesh, const EdgeCollapseOptions& options) {
  if (Status status = validate(mesh); !status.ok()) return status.error();
  if (!options.frozen.empty() && options.frozen.size() != mesh.vertex_count()) {
    return Error{ErrorCode::BadArgument, "the mask of frozen vertices must have one element per vertex", "frozen"};
  }
  return Done{};
}

CollapseReport run(const Mesh& source, const EdgeCollapseOptions& options, const Context& context, Sink& sink) {
  return Engine{source, options, context, sink}.run();
}

}  // namespace lodestone::collapse
