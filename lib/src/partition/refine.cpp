// SPDX-License-Identifier: MIT
// Based on: Fiduccia and Mattheyses 1982 (the most useful move first, also where it makes things worse; then back to
// the best state seen).
// Differs: only vertices on the border are candidates, in heaps whose outdated entries are passed over: borders are
// short.
#include "partition/refine.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace lodestone::partition {
namespace {

constexpr std::uint8_t most_passes = 4;

class Refinement {
 public:
  Refinement(const WeightedGraph& graph, const SideRange& range, std::vector<std::int32_t>& side)
      : graph_(graph), range_(range), side_(side), state_(graph.size()) {
    for (std::uint32_t v = 0; v < graph.size(); ++v) look_at(v);
    first_ = std::count(side.begin(), side.end(), 0);
  }

  void run() {
    do {
      ++pass_;
    } while (improve() && pass_ < most_passes);
  }

 private:
  struct State {
    std::int32_t gain = 0;      // by how much less would be cut if the vertex changed sides
    std::int32_t weight = 0;    // of all its edges
    std::uint8_t moved_in = 0;  // the pass in which it moved last
  };
  struct Entry {
    std::int32_t gain = std::numeric_limits<std::int32_t>::min();
    std::uint32_t vertex = nothing;
  };
  static constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();

  static bool later(const Entry& a, const Entry& b) { return a.gain != b.gain ? a.gain < b.gain : a.vertex > b.vertex; }

  void look_at(std::uint32_t v) {
    State& state = state_[v];
    for (std::int32_t i = graph_.first[v]; i != graph_.first[v + 1]; ++i) {
      const bool same = side_[static_cast<std::size_t>(graph_.neighbour[i])] == side_[v];
      state.gain += same ? -graph_.weight[i] : graph_.weight[i];
      state.weight += graph_.weight[i];
    }
  }

  [[nodiscard]] bool at_border(std::uint32_t v) const { return state_[v].gain > -state_[v].weight; }

  // One pass; whether anything got better.
  bool improve() {
    for (auto& heap : heaps_) heap.clear();
    for (std::uint32_t v = 0; v < graph_.size(); ++v) {
      if (at_border(v)) heap_of(v).push_back({state_[v].gain, v});
    }
    for (auto& heap : heaps_) std::make_heap(heap.begin(), heap.end(), later);
    const std::size_t patience = std::clamp<std::size_t>(graph_.size() / 50, 12, 60);
    std::vector<std::uint32_t> moved;
    std::size_t kept = 0;
    std::int64_t change = 0;  // of the weight that is cut
    std::pair<std::int64_t, std::int64_t> best{excess(first_), 0};
    while (moved.size() < kept + patience) {
      const std::uint32_t v = next();
      if (v == nothing) break;
      change -= state_[v].gain;
      state_[v].moved_in = pass_;
      move(v);
      moved.push_back(v);
      const std::pair<std::int64_t, std::int64_t> now{excess(first_), change};
      if (now < best) {
        best = now;
        kept = moved.size();
      }
    }
    taking_back_ = true;
    for (std::size_t i = moved.size(); i > kept; --i) move(moved[i - 1]);
    taking_back_ = false;
    return kept > 0;
  }

  std::vector<Entry>& heap_of(std::uint32_t v) { return heaps_[side_[v] == 0 ? 0 : 1]; }

  // By how much the first side would be out of its range.
  [[nodiscard]] std::int64_t excess(std::int64_t first) const {
    return std::max({range_.low - first, first - range_.high, std::int64_t{0}});
  }

  [[nodiscard]] bool may_move(std::uint32_t v) const {
    if (v == nothing) return false;
    const std::int64_t then = excess(first_ + (side_[v] == 0 ? -1 : 1));
    return then == 0 || then < excess(first_);
  }

  // The most useful vertex that may move, taken from its heap.
  std::uint32_t next() {
    for (;;) {
      const Entry first = top(0);
      const Entry second = top(1);
      if (first.vertex == nothing && second.vertex == nothing) return nothing;
      const bool first_may = may_move(first.vertex);
      const bool second_may = may_move(second.vertex);
      const std::size_t from = first_may == second_may ? (later(first, second) ? 1 : 0) : (first_may ? 0 : 1);
      pop(from);
      if (first_may || second_may) return from == 0 ? first.vertex : second.vertex;
    }
  }

  // The best entry of a heap that is still true.
  Entry top(std::size_t side) {
    while (!heaps_[side].empty()) {
      const Entry e = heaps_[side].front();
      const State& state = state_[e.vertex];
      const bool here = side_[e.vertex] == static_cast<std::int32_t>(side);
      if (here && state.gain == e.gain && state.moved_in != pass_) return e;
      pop(side);
    }
    return {};
  }

  void pop(std::size_t side) {
    std::pop_heap(heaps_[side].begin(), heaps_[side].end(), later);
    heaps_[side].pop_back();
  }

  void move(std::uint32_t v) {
    std::int32_t& side = side_[v];
    first_ += side == 0 ? -1 : 1;
    side = 1 - side;
    state_[v].gain = -state_[v].gain;
    for (std::int32_t i = graph_.first[v]; i != graph_.first[v + 1]; ++i) {
      const auto n = static_cast<std::uint32_t>(graph_.neighbour[i]);
      State& state = state_[n];
      state.gain += side_[n] == side ? -2 * graph_.weight[i] : 2 * graph_.weight[i];
      if (taking_back_ || state.moved_in == pass_) continue;
      heap_of(n).push_back({state.gain, n});
      std::push_heap(heap_of(n).begin(), heap_of(n).end(), later);
    }
  }

  const WeightedGraph& graph_;
  SideRange range_;
  std::vector<std::int32_t>& side_;
  std::vector<State> state_;  // per vertex
  std::array<std::vector<Entry>, 2> heaps_;
  bool taking_back_ = false;
  std::int64_t first_ = 0;  // vertices of the first side
  std::uint8_t pass_ = 0;
};

}  // namespace

void refine(const WeightedGraph& graph, const SideRange& range, std::vector<std::int32_t>& side) {
  Refinement{graph, range, side}.run();
}

}  // namespace lodestone::partition
