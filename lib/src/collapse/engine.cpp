// SPDX-License-Identifier: MIT
// Based on: Lindstrom and Turk 1998 (cost); passes over flat arrays in the manner of multi-choice and independent-set
// collapse (Jones 1999 onwards).
// Differs: a pass sorts the cheapest share of the edges and collapses them in order, each point at most once, with
// placement, cost and flips taken from the mesh as it is at that moment. Points lie in Morton order and each
// pass cuts them into regions of fixed size that share no face, so that any number of threads gives the same bytes.
#include "collapse/engine.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "base/parallel.h"
#include "base/radix_sort.h"
#include "collapse/candidates.h"
#include "collapse/collapser.h"
#include "collapse/last_faces.h"
#include "collapse/parts.h"
#include "collapse/weights.h"

namespace lodestone::collapse {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t region_points = 16'384;  // fewer points than twice this are one region
constexpr std::uint32_t max_regions = 256;
constexpr std::uint32_t key_steps = 8;  // of cost in a pass; within one step records are ordered in space

// Share of the points that may go in one pass: less is nearer to strict order, and small meshes can afford it.
double quota_share(std::uint32_t points) {
  const double t = std::clamp((std::log2(std::max(points, 1U)) - 14.0) / 4.0, 0.0, 1.0);
  return small_quota + (large_quota - small_quota) * t;
}

class Engine {
 public:
  Engine(const Mesh& source, const EdgeCollapseOptions& options, const Context& context, Sink& sink, const Start& start)
      : source_(source),
        options_(options),
        context_(context),
        sink_(sink),
        start_(start),
        last_faces_(source, options),
        faces_left_(source.triangle_count()) {}

  CollapseReport run();

 private:
  struct Region {
    Range points;
    std::vector<Candidate> edges;
    CostHistogram costs;
    PassLog log;
    PassLog sorted;  // the log's records by their keys
    std::array<std::uint32_t, refusal_count> refusals{};
  };

  void drop_degenerate(const std::vector<FaceId>& faces);
  void take_deviations();
  [[nodiscard]] double quota() const { return start_.quota > 0.0 ? start_.quota : quota_share(mesh_.point_count()); }
  [[nodiscard]] double first_share() const { return mesh_.point_count() < region_points ? small_share : large_share; }
  void cut_regions();
  // Calls work(region) for each, several at once.
  template <class Work>
  void for_each_region(Work work) {
    parallel_for_each(regions_.size(), 1, context_, [&](std::size_t i) { work(regions_[i]); });
  }
  void sum_all();
  [[nodiscard]] std::uint32_t estimate_all(double share);
  void collapse_region(Region& region, PassState& state) const;
  std::uint32_t flush();
  std::uint32_t hand_over(const PassLog& log, std::size_t begin, std::size_t end);
  bool prune(double limit_m);
  [[nodiscard]] bool parts_are_due() const;
  bool relax();
  bool prune_anew();
  [[nodiscard]] CollapseReport report() const;
  void watch_groups();
  bool pass(double share);
  [[nodiscard]] bool done() const { return faces_left_ <= options_.target_triangles || context_.cancelled(); }

  const Mesh& source_;
  const EdgeCollapseOptions& options_;
  const Context& context_;
  Sink& sink_;
  const Start& start_;
  WorkingMesh mesh_;
  std::vector<Region> regions_;
  LastFaces last_faces_;
  std::vector<Symmetric3> quadrics_;                          // per point
  std::array<std::uint32_t, refusal_count> last_refusals_{};  // of the last pass
  std::uint32_t faces_left_;
  std::uint32_t pass_ = 0;
  std::uint32_t log_count_ = 0;  // passes and searches for parts
  double diagonal_m_ = 0.0;
  double line_weight_ = line_weight;
  double error_m_ = 0.0;       // largest so far
  double pruned_to_m_ = -1.0;  // limit of the last search for parts that may go
  bool parts_wait_ = false;    // for what they lean upon to be settled
  bool loose_ = false;
  bool last_resort_ = false;
  bool looks_matter_ = false;
  bool parts_missing_ = false;
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
  regions_.resize(cuts.size() - 1);
  ++log_count_;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    Region& region = regions_[i];
    region.points = {cuts[i], cuts[i + 1]};
    region.sorted = {};
    region.sorted.pass = log_count_;
    region.sorted.lane = static_cast<std::uint32_t>(i);
    region.refusals = {};
  }
}

void Engine::sum_all() {
  quadrics_.resize(mesh_.point_count());
  if (options_.sharpness_power > 0.0) mesh_.sharpness.assign(mesh_.point_count(), 1.0F);
  const std::size_t others = std::exchange(parts_missing_, false) ? 1 : 0;  // beside the regions
  parallel_for_each(others + regions_.size(), 1, context_, [&](std::size_t i) {
    if (i < others) return find_parts(mesh_);
    Region& region = regions_[i - others];
    region.edges.clear();
    sum_quadrics(mesh_, {source_, options_, looks_matter_, line_weight_}, region.points, quadrics_, region.edges);
  });
}

// The regions' edges keep their estimated costs; returns what the cheapest `share` of all stays below.
std::uint32_t Engine::estimate_all(double share) {
  for_each_region([&](Region& region) {
    region.costs = CostHistogram{};
    estimate_costs(mesh_, quadrics_, options_.placement, region.edges, region.costs);
  });
  CostHistogram costs;
  for (const Region& region : regions_) costs.add(region.costs);
  return costs.limit(share);
}

// Where the corners of an edge to come are listed must be known before its star can be fetched; most edges are out of
// the running by then. Inlined because a compiler may take a call that only fetches for one without effect.
[[gnu::always_inline]] inline void fetch_ahead(const WorkingMesh& mesh, const std::vector<Candidate>& edges,
                                               std::size_t next) {
  constexpr std::size_t distance = 6;
  if (next + distance >= edges.size()) return;
  const Candidate& c = edges[next + distance];
  if (((mesh.flags[c.u] | mesh.flags[c.v]) & point_locked) != 0) return;
  __builtin_prefetch(&mesh.corners[mesh.first[c.u]]);
  __builtin_prefetch(&mesh.corners[mesh.first[c.v]]);
}

void Engine::collapse_region(Region& region, PassState& state) const {
  // In a large mesh near enough in order of cost: neighbours come one after the other within a step of it.
  if (state.mesh.point_count() < region_points) {
    radix_sort(region.edges);
  } else {
    coarse_sort(region.edges);
  }
  Collapser collapser{state, region.log, region.sorted.lane};
  // Edges whose exact cost is above the estimate wait until their turn.
  using Later = std::pair<double, std::size_t>;
  std::priority_queue<Later, std::vector<Later>, std::greater<>> later;
  const auto quota = static_cast<std::size_t>(std::ceil(state.share * region.points.size()));
  std::size_t next = 0;
  std::size_t tries = 0;
  while (region.log.size() < quota && (next < region.edges.size() || !later.empty())) {
    if (++tries % 4096 == 0 && context_.cancelled()) return;
    const double listed = next < region.edges.size() ? std::bit_cast<float>(region.edges[next].key) : infinity;
    const bool from_list = later.empty() || listed <= later.top().first;
    const double cost = from_list ? listed : later.top().first;
    const std::size_t at = from_list ? next++ : later.top().second;
    if (!from_list) later.pop();
    fetch_ahead(state.mesh, region.edges, next);
    const Candidate& c = region.edges[at];
    const auto step = static_cast<std::uint32_t>(region.log.size() * key_steps / quota);
    const std::uint32_t key = step << 24U | (c.u - region.points.begin) >> 6U;
    const Refusal refusal = collapser.attempt(c.u, c.v, key, slack * cost);
    ++region.refusals[static_cast<std::size_t>(refusal)];
    if (refusal == Refusal::Cost && std::isfinite(collapser.cost()))
      later.emplace(collapser.cost() / slack * (1.0 + 1e-9), at);
  }
  std::vector<Keyed> order(region.log.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = {region.log.key(i), i};
  radix_sort(order);
  region.sorted.assign(region.log, order);
  region.log = {};
}

// Hands the records over, cost step by cost step through all regions; returns how many collapses there were.
std::uint32_t Engine::flush() {
  std::uint32_t records = 0;
  std::vector<std::size_t> at(regions_.size(), 0);
  for (std::uint32_t step = 0; step < key_steps; ++step) {
    for (std::size_t r = 0; r < regions_.size() && !done(); ++r) {
      const PassLog& log = regions_[r].sorted;
      std::size_t end = at[r];
      while (end < log.size() && log.key(end) >> 24U == step) ++end;
      records += hand_over(log, at[r], end);
      at[r] = end;
    }
  }
  return records;
}

// As many of the records [begin, end) as the target allows; returns their number.
std::uint32_t Engine::hand_over(const PassLog& log, std::size_t begin, std::size_t end) {
  while (end > begin + 1 && log.face_count(begin, end - 1) >= faces_left_ - options_.target_triangles) --end;
  sink_.records(log, begin, end);
  for (std::size_t i = begin; i != end; ++i) error_m_ = std::max(error_m_, double{log.error_m(i)});
  faces_left_ -= log.face_count(begin, end);
  return static_cast<std::uint32_t>(end - begin);
}

void Engine::watch_groups() {
  std::vector<Range> points(regions_.size());
  std::transform(regions_.begin(), regions_.end(), points.begin(), [](const Region& region) { return region.points; });
  last_faces_.count(mesh_, points);
}

bool Engine::pass(double share) {
  compact(mesh_, context_);
  cut_regions();
  sum_all();
  if (pass_ == 0 &&
      std::any_of(mesh_.flags.begin(), mesh_.flags.end(), [](std::uint8_t f) { return (f & point_complex) != 0; })) {
    loose_ = true;  // contacts come and go there anyway
    line_weight_ = soup_line_weight;
    sum_all();
  }
  const std::uint32_t limit = estimate_all(share);
  quadrics_ = {};  // room for the logs
  if (context_.cancelled()) return false;
  PassState state{.mesh = mesh_, .source = source_, .options = options_, .last_faces = last_faces_};
  watch_groups();
  state.diagonal_m = diagonal_m_;
  state.line_weight = line_weight_;
  state.looks_matter = looks_matter_;
  state.loose = loose_;
  state.last_resort = last_resort_;
  state.keeps_twins = start_.contacts == Contacts::MayTouch;
  state.share = quota();
  state.stamps.assign(mesh_.point_count(), 0);
  state.last_key.assign(mesh_.point_count(), 0);
  for_each_region([&](Region& region) {
    std::erase_if(region.edges, [limit](const Candidate& c) { return c.key >= limit; });
    region.edges.shrink_to_fit();
    collapse_region(region, state);
  });
  if (context_.cancelled()) return false;
  ++pass_;
  last_refusals_ = {};
  for (const Region& region : regions_) {
    for (std::size_t i = 0; i < refusal_count; ++i) last_refusals_[i] += region.refusals[i];
  }
  return flush() != 0;
}

// The last resort: parts may have come apart since they were found.
bool Engine::prune_anew() {
  if (!options_.prune_parts) return false;
  compact(mesh_, context_);
  find_parts(mesh_);
  return prune(infinity);
}

// Gives up the next scruple; false if none is left.
bool Engine::relax() {
  bool& scruple = loose_ ? last_resort_ : loose_;
  return !std::exchange(scruple, true);
}

// Whether a search for parts that may go would find others than the last one.
bool Engine::parts_are_due() const {
  const double limit_m = prune_share * error_m_;
  if (mesh_.point_count() >= region_points) return limit_m >= prune_growth * pruned_to_m_;
  return limit_m > pruned_to_m_ || parts_wait_;
}

bool Engine::prune(double limit_m) {
  if (done()) return false;
  PassLog log;
  log.pass = ++log_count_;
  limit_m = std::min(limit_m, options_.max_error_m);
  pruned_to_m_ = limit_m;
  const Pruned pruned =
      prune_parts(mesh_, limit_m, faces_left_ - options_.target_triangles, last_faces_, context_, log);
  error_m_ = std::max(error_m_, double{pruned.largest_m});
  parts_wait_ = pruned.some_wait;
  hand_over(log, 0, log.size());
  return log.size() != 0;
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

void Engine::take_deviations() {
  if (start_.deviation_m.empty()) return;
  for (const Face& f : mesh_.faces) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      float& deviation = mesh_.deviation_m[f.point[k]];
      deviation = std::max(deviation, start_.deviation_m[source_.indices[3 * std::size_t{f.id} + k]]);
    }
  }
}

CollapseReport Engine::run() {
  WorkingMeshStart start = make_working_mesh(source_, options_, context_);
  mesh_ = std::move(start.mesh);
  take_deviations();
  loose_ = start_.scruples == Scruples::None;
  diagonal_m_ = bounds(source_).diagonal_m();
  looks_matter_ = options_.attributes == Attributes::All && (mesh_.has_seams() || !source_.face_materials.empty());
  parts_missing_ = options_.prune_parts;
  drop_degenerate(start.degenerate);
  double share = first_share();
  const double total = static_cast<double>(source_.triangle_count());
  while (!done()) {
    const std::uint32_t before = faces_left_;
    const bool any = pass(share);
    if (parts_are_due()) prune(prune_share * error_m_);
    context_.report("collapse", 1.0 - faces_left_ / total);
    if (!any && share >= 1.0 && !relax() && !prune_anew()) break;
    const double wanted = 0.5 * quota() * before;
    share = before - faces_left_ < wanted ? std::min(1.0, share * 2.0) : first_share();
  }
  return report();
}

CollapseReport Engine::report() const {
  CollapseReport result;
  result.target_reached = faces_left_ <= options_.target_triangles;
  if (result.target_reached) return result;
  const double total = std::max(1.0, std::accumulate(last_refusals_.begin(), last_refusals_.end(), 0.0));
  const auto share = [&](Refusal refusal) { return last_refusals_[static_cast<std::size_t>(refusal)] / total; };
  result.locked_by_border = share(Refusal::Border);
  result.locked_by_flip = share(Refusal::Flip);
  result.locked_by_link = share(Refusal::Link);
  result.locked_by_frozen = share(Refusal::Frozen);
  result.locked_by_planes = share(Refusal::Plane);
  const auto percent = [](double x) { return std::to_string(std::lround(100.0 * x)) + " %"; };
  result.sentence = std::to_string(faces_left_) + " triangles are left: of the edges that could still collapse " +
                    percent(result.locked_by_border) + " are held by borders, " + percent(result.locked_by_flip) +
                    " because a face would flip, " + percent(result.locked_by_link) +
                    " because the surface would touch itself, " + percent(result.locked_by_frozen) +
                    " by frozen or sharp vertices, " + percent(share(Refusal::Crowded)) +
                    " by vertices of very many faces, " + percent(share(Refusal::Cost)) + " by the error limit";
  if (!options_.face_planes.empty()) result.sentence += ", " + percent(result.locked_by_planes) + " by planes";
  return result;
}

}  // namespace

namespace {

Status check_planes(const Mesh& mesh, const EdgeCollapseOptions& options) {
  const std::vector<std::uint32_t>& of_face = options.face_planes;
  if (!of_face.empty() && of_face.size() != mesh.triangle_count()) {
    return Error{ErrorCode::BadArgument, "the planes of faces must have one element per face", "face_planes"};
  }
  const auto unknown = [&](std::uint32_t plane) { return plane != none && plane >= options.planes.size(); };
  if (std::any_of(of_face.begin(), of_face.end(), unknown)) {
    return Error{ErrorCode::BadArgument, "a face names a plane that is not in the list", "face_planes"};
  }
  const auto crooked = [](const HeldPlane& plane) {
    return !(std::abs(glm::dot(plane.normal, plane.normal) - 1.0) < 1e-6) || !std::isfinite(plane.offset_m);
  };
  if (std::any_of(options.planes.begin(), options.planes.end(), crooked)) {
    return Error{ErrorCode::BadArgument, "a held plane needs a unit normal and a finite offset", "planes"};
  }
  return Done{};
}

}  // namespace

void move_vertices(const Edit& edit, VertexArrays& values) {
  const std::uint32_t* words = edit.values.data();
  const auto take = [&words](auto& value) {
    std::memcpy(&value, words, sizeof value);
    words += sizeof value / sizeof *words;
  };
  for (const VertexId v : edit.moved) {
    take(values.positions[v]);
    if (!values.normals.empty()) take(values.normals[v]);
    if (!values.uvs.empty()) take(values.uvs[v]);
    if (!values.colors.empty()) take(values.colors[v]);
  }
}

Status check(const Mesh& mesh, const EdgeCollapseOptions& options) {
  if (Status status = validate(mesh); !status.ok()) return status.error();
  if (!options.frozen.empty() && options.frozen.size() != mesh.vertex_count()) {
    return Error{ErrorCode::BadArgument, "the mask of frozen vertices must have one element per vertex", "frozen"};
  }
  const auto& groups = options.material_groups;
  const auto unknown = [&](std::uint32_t group) { return group >= groups.size(); };
  if (!groups.empty() &&
      (groups.size() != mesh.materials.size() || std::any_of(groups.begin(), groups.end(), unknown))) {
    return Error{ErrorCode::BadArgument, "materials need one group each, numbered from 0", "material_groups"};
  }
  return check_planes(mesh, options);
}

CollapseReport run(const Mesh& source, const EdgeCollapseOptions& options, const Context& context, Sink& sink,
                   const Start& start) {
  return Engine{source, options, context, sink, start}.run();
}

}  // namespace lodestone::collapse
