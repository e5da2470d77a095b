// SPDX-License-Identifier: MIT
// Based on: Ao et al. 2025, sections 3.5.2 and 3.5.3 (paged loading in threads of its own, unloading of what is not
// seen, prefetch).
// Differs: tiles leave by a budget of bytes, not by time; a tile is replaced only when all of its children are there.
#include <lodestone/tile_loader.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "tiles3d/cut_fade.h"

namespace lodestone {
namespace {

std::uint64_t bytes_of(const Mesh& mesh) {
  const VertexArrays& v = mesh.vertices;
  std::uint64_t bytes = v.positions.size() * sizeof(glm::vec3) + v.normals.size() * sizeof(glm::vec3) +
                        v.uvs.size() * sizeof(glm::vec2) + v.colors.size() * sizeof(glm::u8vec4) +
                        (mesh.indices.size() + mesh.face_materials.size()) * sizeof(std::uint32_t);
  for (const Texture& texture : mesh.textures) {
    if (texture.image) bytes += texture.image->pixels.size();
    if (texture.encoded) bytes += texture.encoded->size();
  }
  return bytes;
}

// Of the plane through the eye: what else lies outside the view is left to the rasteriser.
bool is_behind(const View& view, const Sphere& sphere) {
  return glm::dot(sphere.center - view.eye, view.forward) < -sphere.radius_m;
}

enum class Stage : std::uint8_t { Absent, Wanted, Loading, Resident, Failed };

}  // namespace

struct TilePager::State {
  struct Tile {
    std::unique_ptr<Mesh> mesh;
    std::uint64_t bytes = 0;
    std::uint64_t last_used = 0;  // frame
  };
  struct Finished {
    NodeId tile;
    Result<Mesh> mesh;
  };

  std::shared_ptr<const TilePyramid> pyramid;
  PagerOptions options;
  std::vector<Tile> tiles;
  std::vector<NodeId> parent;          // per node; none for a root
  std::vector<std::uint8_t> resident;  // per page, as select_cut() wants it
  CutScratch scratch;
  std::unique_ptr<CutFade> fade;
  std::vector<NodeId> chosen, drawn, ahead;
  std::uint64_t frame = 0;
  glm::dvec3 last_eye{0.0};
  PagerStatus status;

  mutable std::mutex mutex;  // guards what follows
  std::condition_variable wake, done;
  std::vector<Stage> stages;
  std::vector<NodeId> queue;  // to load, the most wanted last
  std::vector<Finished> finished;
  bool ending = false;
  std::vector<std::thread> threads;  // last: they use all of the above

  void start_workers();
  void work();
  void take_in(NodeId tile, Result<Mesh> mesh);
  void collect();
  void select(const View& view, std::vector<NodeId>& out);
  void ask(const View& view, const View& later, double dt_s);
  void append_missing(std::vector<NodeId>& wanted);
  void let_go();
};

void TilePager::State::start_workers() {
  while (threads.size() < std::max(1U, options.workers)) threads.emplace_back([this] { work(); });
}

void TilePager::State::work() {
  std::unique_lock lock{mutex};
  while (true) {
    wake.wait(lock, [&] { return ending || !queue.empty(); });
    if (ending) return;
    const NodeId tile = queue.back();
    queue.pop_back();
    stages[tile] = Stage::Loading;
    lock.unlock();
    Result<Mesh> mesh = pyramid->load(tile);
    lock.lock();
    finished.push_back({tile, std::move(mesh)});
    done.notify_all();
  }
}

void TilePager::State::take_in(NodeId tile, Result<Mesh> mesh) {
  if (!mesh) {
    stages[tile] = Stage::Failed;
    status.failures.push_back(to_line(mesh.error()));
    return;
  }
  stages[tile] = Stage::Resident;
  tiles[tile].mesh = std::make_unique<Mesh>(std::move(*mesh));
  tiles[tile].bytes = bytes_of(*tiles[tile].mesh);
  tiles[tile].last_used = frame;
  resident[tile] = 1;
  ++status.resident_tiles;
  ++status.loaded_tiles;
  status.resident_bytes += tiles[tile].bytes;
}

void TilePager::State::collect() {
  const std::scoped_lock lock{mutex};
  for (Finished& one : finished) take_in(one.tile, std::move(one.mesh));
  finished.clear();
}

void TilePager::State::select(const View& view, std::vector<NodeId>& out) {
  const CutOptions cut{.error_px = options.error_px, .resident = resident};
  select_cut(pyramid->graph(), view, cut, scratch, out);
}

// All nodes of the groups that the last cut missed, the largest error last.
void TilePager::State::append_missing(std::vector<NodeId>& wanted) {
  std::vector<MissingGroup> missing(scratch.missing().begin(), scratch.missing().end());
  std::stable_sort(missing.begin(), missing.end(),
                   [](const MissingGroup& a, const MissingGroup& b) { return a.error_px < b.error_px; });
  for (const MissingGroup& one : missing) {
    const Range nodes = pyramid->graph().groups[one.group].nodes;
    for (NodeId n = nodes.begin; n < nodes.end; ++n) wanted.push_back(n);
  }
}

void TilePager::State::ask(const View& view, const View& later, double dt_s) {
  std::vector<NodeId> now;
  select(view, chosen);
  append_missing(now);
  fade->step(scratch.refined(), dt_s, options.fade_s);
  drawn = chosen;
  if (fade->fading()) {
    drawn.clear();
    std::copy_if(fade->nodes().begin(), fade->nodes().end(), std::back_inserter(drawn),
                 [&](NodeId tile) { return !is_behind(view, pyramid->graph().nodes[tile].bounds); });
  }
  std::vector<NodeId> wanted;
  if (later.eye != view.eye) {
    select(later, ahead);
    append_missing(wanted);
    for (const NodeId tile : ahead) tiles[tile].last_used = frame;
  }
  wanted.insert(wanted.end(), now.begin(), now.end());
  for (const NodeId tile : now) tiles[tile].last_used = frame;  // siblings wait for each other, whatever the budget
  for (const NodeId tile : fade->nodes()) {
    for (NodeId n = tile; n != none; n = parent[n]) tiles[n].last_used = frame;
  }
  const std::scoped_lock lock{mutex};
  for (const NodeId tile : queue) {
    if (stages[tile] == Stage::Wanted) stages[tile] = Stage::Absent;
  }
  queue.clear();
  std::reverse(wanted.begin(), wanted.end());
  for (const NodeId tile : wanted) {  // the first mention is the most urgent
    if (stages[tile] != Stage::Absent) continue;
    stages[tile] = Stage::Wanted;
    queue.push_back(tile);
  }
  std::reverse(queue.begin(), queue.end());
  status.wanted_tiles = static_cast<std::uint32_t>(
      std::count_if(stages.begin(), stages.end(), [](Stage s) { return s == Stage::Wanted || s == Stage::Loading; }));
  wake.notify_all();
}

// What was used in this frame stays: the tiles drawn, and those above that stand in for them.
void TilePager::State::let_go() {
  if (status.resident_bytes <= options.budget_bytes) return;
  std::vector<NodeId> idle;
  for (NodeId n = 0; n < tiles.size(); ++n) {
    if (resident[n] != 0 && tiles[n].last_used < frame) idle.push_back(n);
  }
  std::stable_sort(idle.begin(), idle.end(),
                   [&](NodeId a, NodeId b) { return tiles[a].last_used < tiles[b].last_used; });
  const std::scoped_lock lock{mutex};
  for (const NodeId n : idle) {
    if (status.resident_bytes <= options.budget_bytes) return;
    status.resident_bytes -= tiles[n].bytes;
    --status.resident_tiles;
    tiles[n].mesh.reset();
    resident[n] = 0;
    stages[n] = Stage::Absent;
  }
}

TilePager::TilePager(std::shared_ptr<const TilePyramid> pyramid, const PagerOptions& options)
    : state_{std::make_unique<State>()} {
  State& s = *state_;
  s.pyramid = std::move(pyramid);
  s.options = options;
  const LodGraph& graph = s.pyramid->graph();
  s.tiles.resize(graph.nodes.size());
  s.resident.assign(graph.page_count, 0);
  s.stages.assign(graph.nodes.size(), Stage::Absent);
  s.parent.assign(graph.nodes.size(), none);
  s.scratch.reserve(graph);
  s.fade = std::make_unique<CutFade>(graph);
  // A group's nodes are the children of the one node that it made.
  std::vector<NodeId> made_by(graph.groups.size(), none);
  for (const LodLink& link : graph.links) {
    for (NodeId n = link.nodes.begin; n < link.nodes.end && link.maker != none; ++n) made_by[link.maker] = n;
  }
  for (GroupId g = 0; g < graph.groups.size(); ++g) {
    for (NodeId n = graph.groups[g].nodes.begin; n < graph.groups[g].nodes.end; ++n) s.parent[n] = made_by[g];
  }
  const Range roots = graph.groups.empty() ? Range{} : graph.groups.front().nodes;
  for (NodeId n = roots.begin; n < roots.end; ++n) s.take_in(n, s.pyramid->load(n));
}

TilePager::~TilePager() {
  {
    const std::scoped_lock lock{state_->mutex};
    state_->ending = true;
  }
  state_->wake.notify_all();
  for (std::thread& thread : state_->threads) thread.join();
}

std::span<const NodeId> TilePager::update(const View& view, double dt_s) {
  State& s = *state_;
  s.collect();
  if (++s.frame > 1) s.start_workers();  // the first picture has processor and memory for itself
  View later = view;
  if (s.frame > 1 && dt_s > 0.0) later.eye += (view.eye - s.last_eye) * (s.options.look_ahead_s / dt_s);
  s.last_eye = view.eye;
  s.ask(view, later, dt_s);
  s.let_go();
  if (s.pyramid->graph().empty() || s.resident[0] == 0) s.drawn.clear();
  return s.drawn;
}

void TilePager::wait() {
  State& s = *state_;
  if (s.status.wanted_tiles == 0) return;
  s.start_workers();
  std::unique_lock lock{s.mutex};
  s.done.wait(lock, [&] { return !s.finished.empty(); });
}

std::span<const NodeId> TilePager::settle(const View& view) {
  while (true) {
    const std::span<const NodeId> drawn = update(view, 0.0);
    if (state_->status.wanted_tiles == 0) return drawn;
    wait();
  }
}

void TilePager::forget_pixels(NodeId tile) {
  if (!state_->tiles[tile].mesh) return;
  for (Texture& texture : state_->tiles[tile].mesh->textures) {
    texture.encoded = nullptr;
    texture.image = nullptr;
  }
}

const Mesh* TilePager::content(NodeId tile) const { return state_->tiles[tile].mesh.get(); }

float TilePager::share(NodeId tile) const { return state_->fade->share(tile); }

void TilePager::set_error_px(double error_px) { state_->options.error_px = error_px; }

bool TilePager::fading() const { return state_->fade->fading(); }

PagerStatus TilePager::status() const { return state_->status; }

}  // namespace lodestone
