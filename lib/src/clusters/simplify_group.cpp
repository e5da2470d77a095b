// SPDX-License-Identifier: MIT
// Based on: Wang et al. 2023, section 2.4 (simplify to half inside the locked border, split again).
// Differs: locked by position, not by the weight of an edge: a border vertex is never a candidate. The deviation that
// each vertex brings along from finer levels is carried on, so that errors add up. Every result is checked: a border
// edge that lost its face on this side, or an edge that came open inside, has its surroundings locked and the group is
// simplified again.
#include "clusters/simplify_group.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/hash.h"
#include "clusters/face_graph.h"
#include "clusters/split.h"
#include "clusters/walk.h"
#include "collapse/engine.h"
#include "mesh/weld.h"

namespace lodestone::clusters {
namespace {

// Share of the points that may go in one pass of the engine: near enough to strict order for half of a group.
constexpr double pass_quota = 0.2;
// The most triangles a group may keep and count as reduced, at first and after failures.
constexpr double first_limit = 0.75;
constexpr double last_limit = 0.95;
constexpr int attempts = 4;

// Takes the engine's records: which vertices merged, what moved.
class GroupSink final : public collapse::Sink {
 public:
  GroupSink(Mesh& mesh, std::vector<float>& deviation_m)
      : mesh_(mesh), deviation_m_(deviation_m), gone_(mesh.triangle_count(), 0), into_(mesh.vertex_count()) {
    std::iota(into_.begin(), into_.end(), 0U);
  }

  void record(const collapse::Edit& edit) override {
    for (const FaceId f : edit.faces) gone_[f] = 1;
    for (const auto& [corner, to] : edit.corners) mesh_.indices[corner] = to;
    move_vertices(edit, mesh_.vertices);
    for (const auto& [vertex, into] : edit.vertices) {
      into_[vertex] = into;
      deviation_m_[into] = std::max({deviation_m_[into], deviation_m_[vertex], edit.error_m});
    }
    for (const VertexId v : edit.moved) deviation_m_[v] = std::max(deviation_m_[v], edit.error_m);
    error_m_ = std::max(error_m_, edit.error_m);
  }

  [[nodiscard]] double error_m() const noexcept { return error_m_; }
  [[nodiscard]] bool gone(FaceId f) const noexcept { return gone_[f] != 0; }

  // Where every vertex ended, following the merges.
  [[nodiscard]] std::vector<std::uint32_t> ends() const {
    std::vector<std::uint32_t> end(into_.size());
    for (std::uint32_t v = 0; v < into_.size(); ++v) {
      std::uint32_t at = v;
      for (std::size_t steps = 0; into_[at] != at && steps < into_.size(); ++steps) at = into_[at];
      end[v] = at;
    }
    return end;
  }

 private:
  Mesh& mesh_;
  std::vector<float>& deviation_m_;
  std::vector<std::uint8_t> gone_;
  std::vector<std::uint32_t> into_;
  float error_m_ = 0.0F;
};

class Job {
  using Edges = std::vector<std::uint64_t>;  // the smaller point in the upper half, so that they sort fast

 public:
  Job(const Work& work, const Group& group, std::uint32_t failures, collapse::Scruples scruples, const Context& context)
      : work_(work), group_(group), failures_(failures), scruples_(scruples), context_(context) {}

  GroupResult run() {
    gather();
    choose_target();
    find_border_edges();
    for (int attempt = 0; attempt < attempts && !context_.cancelled(); ++attempt) {
      simplify();
      name_points();
      const Edges faults = find_faults();
      if (faults.empty()) break;
      if (attempt + 1 == attempts) result_.cause = "it could not be simplified without opening it";
      lock_around(faults);
    }
    if (result_.cause.empty()) judge();
    return std::move(result_);
  }

 private:
  // The group as a mesh of its own.
  void gather() {
    for (const std::uint32_t c : group_.clusters) {
      const auto faces = work_.live.faces_of(work_.live.clusters[c]);
      faces_.insert(faces_.end(), faces.begin(), faces.end());
    }
    const auto vertex_at = [&](std::uint32_t corner) { return faces_[corner / 3].vertex[corner % 3]; };
    UniqueIds ids = unique_ids(
        static_cast<std::uint32_t>(3 * faces_.size()), [&](std::uint32_t c) { return mix64(vertex_at(c)); },
        [&](std::uint32_t a, std::uint32_t b) { return vertex_at(a) == vertex_at(b); });
    result_.vertices.reserve(ids.first.size());
    for (const std::uint32_t corner : ids.first) result_.vertices.push_back(vertex_at(corner));
    indices_ = std::move(ids.id_of);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      local_.push_back({{indices_[3 * f], indices_[3 * f + 1], indices_[3 * f + 2]}, faces_[f].id});
    }
    const VertexArrays& values = work_.ground.values;
    const auto pick = [&](const auto& from, auto& to) {
      if (from.empty()) return;
      to.reserve(result_.vertices.size());
      for (const VertexId v : result_.vertices) to.push_back(from[v]);
    };
    pick(values.positions, start_.positions);
    pick(values.normals, start_.normals);
    pick(values.uvs, start_.uvs);
    pick(values.colors, start_.colors);
    for (const VertexId v : result_.vertices) {
      const std::uint32_t p = work_.ground.point_of[v];
      point_before_.push_back(p);
      border_before_.push_back(work_.ground.border[p]);
      result_.locked.push_back((work_.grouping.shared[p] | work_.ground.locked[p]) != 0 ? 1 : 0);
    }
    for (const Material& m : work_.source.materials) {
      mesh_.materials.push_back({.base_color = m.base_color, .double_sided = m.double_sided});
    }
    if (work_.source.face_materials.empty()) return;
    for (const LiveFace& f : faces_) mesh_.face_materials.push_back(work_.source.face_materials[f.id]);
  }

  // Those that one face of the group uses must stay so or be used by more; those that more faces use may not become
  // such: each has a face on another side.
  void find_border_edges() {
    Edges edges;  // that may be of the border
    for (const LiveFace& f : local_) {
      if (is_collapsed(points_before(f))) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId a = f.vertex[k];
        const VertexId b = f.vertex[(k + 1) % 3];
        if (result_.locked[a] != 0 && result_.locked[b] != 0) {
          edges.push_back(edge_between(point_before_[a], point_before_[b]));
        }
      }
    }
    std::sort(edges.begin(), edges.end());
    for (const BorderEdge& e : group_.border) {
      const std::uint64_t edge = edge_between(e.low, e.high);
      border_edges_.push_back(edge);
      if (uses(edges, edge) > 1) border_edges_within_.push_back(edge);
    }
  }

  [[nodiscard]] std::array<std::uint32_t, 3> points_before(const LiveFace& f) const {
    return {point_before_[f.vertex[0]], point_before_[f.vertex[1]], point_before_[f.vertex[2]]};
  }

  static std::ptrdiff_t uses(const Edges& edges, std::uint64_t edge) {
    const auto [first, last] = std::equal_range(edges.begin(), edges.end(), edge);
    return last - first;
  }

  // Half the triangles, in clusters that are full.
  void choose_target() {
    const auto half = static_cast<std::uint32_t>(faces_.size() / 2);
    const std::uint32_t full = work_.options.max_triangles - work_.options.max_triangles / 64;
    const std::uint32_t clusters = std::max(1U, (half + full / 2) / full);
    options_.target_triangles = std::max(1U, std::min(half, clusters * full));
    options_.attributes = work_.options.attributes;
    Box box;
    for (const glm::vec3& p : start_.positions) box.add(glm::dvec3{p});
    const double scale = box.diagonal_m() > 0.0 ? work_.diagonal_m / box.diagonal_m() : 1.0;
    options_.uv_weight *= scale;
    options_.normal_weight *= scale;
    options_.color_weight *= scale;
  }

  void simplify() {
    mesh_.vertices = start_;
    mesh_.indices = indices_;
    options_.frozen = result_.locked;
    result_.deviation_m.clear();
    for (const std::uint32_t p : point_before_) result_.deviation_m.push_back(work_.ground.deviation_m[p]);
    Mesh source = mesh_;
    const std::vector<float> deviation_m = result_.deviation_m;
    GroupSink sink{mesh_, result_.deviation_m};
    Context serial;
    serial.cancel = context_.cancel;
    serial.max_workers = 1;
    report_ = collapse::run(source, options_, serial, sink,
                            {deviation_m, pass_quota, collapse::Contacts::MayTouch, scruples_});
    result_.error_m = sink.error_m();
    result_.survivor = sink.ends();
    result_.faces.clear();
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      if (sink.gone(f)) continue;
      result_.faces.push_back(
          {{mesh_.indices[3 * f], mesh_.indices[3 * f + 1], mesh_.indices[3 * f + 2]}, faces_[f].id});
    }
  }

  static std::uint64_t edge_between(std::uint32_t p, std::uint32_t q) {
    return std::uint64_t{std::min(p, q)} << 32U | std::max(p, q);
  }

  // The edges of faces between local vertices, by their points, ascending.
  static Edges edges_of(const std::vector<LiveFace>& faces, const std::vector<std::uint32_t>& point) {
    Edges edges;
    edges.reserve(3 * faces.size());
    for (const LiveFace& f : faces) {
      const std::array<std::uint32_t, 3> p{point[f.vertex[0]], point[f.vertex[1]], point[f.vertex[2]]};
      if (is_collapsed(p)) continue;
      for (std::size_t k = 0; k < 3; ++k) edges.push_back(edge_between(p[k], p[(k + 1) % 3]));
    }
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  // Edges of one face that are neither on the true border nor on that of the group. `border` is by local vertex.
  [[nodiscard]] Edges opened(const Edges& edges, const std::vector<std::uint32_t>& point,
                             const std::vector<std::uint8_t>& border) const {
    std::vector<std::uint32_t> on_border;
    for (std::size_t v = 0; v < point.size(); ++v) {
      if (border[v] != 0) on_border.push_back(point[v]);
    }
    std::sort(on_border.begin(), on_border.end());
    const auto is_border = [&](std::uint64_t p) {
      return std::binary_search(on_border.begin(), on_border.end(), static_cast<std::uint32_t>(p));
    };
    Edges open;
    for (std::size_t i = 0; i < edges.size();) {
      std::size_t end = i + 1;
      while (end < edges.size() && edges[end] == edges[i]) ++end;
      const std::uint64_t e = edges[i];
      if (end == i + 1 && !std::binary_search(border_edges_.begin(), border_edges_.end(), e) &&
          !(is_border(e >> 32U) && is_border(e & none))) {
        open.push_back(e);
      }
      i = end;
    }
    return open;
  }

  // Border edges that have no face on this side any more, and edges that came open.
  [[nodiscard]] Edges find_faults() const {
    std::vector<std::uint8_t> border(border_before_.size(), 0);
    for (std::size_t v = 0; v < border.size(); ++v) {
      if (border_before_[v] != 0) border[v] = border[result_.survivor[v]] = 1;
    }
    const Edges edges = edges_of(result_.faces, result_.point);
    Edges faults = opened(edges, result_.point, border);
    std::set_difference(border_edges_.begin(), border_edges_.end(), edges.begin(), edges.end(),
                        std::back_inserter(faults));
    for (const std::uint64_t e : border_edges_within_) {
      if (uses(edges, e) == 1) faults.push_back(e);
    }
    return faults;
  }

  // Locks the points of the edges and all that they have faces with.
  void lock_around(const Edges& faults) {
    std::vector<std::uint32_t> ends;
    for (const std::uint64_t e : faults) {
      ends.push_back(static_cast<std::uint32_t>(e >> 32U));
      ends.push_back(static_cast<std::uint32_t>(e));
    }
    std::sort(ends.begin(), ends.end());
    std::vector<std::uint32_t> points;
    for (const LiveFace& f : local_) {
      const auto point = [&](std::size_t k) { return point_before_[f.vertex[k]]; };
      const auto is_end = [&](std::size_t k) { return std::binary_search(ends.begin(), ends.end(), point(k)); };
      if (is_end(0) || is_end(1) || is_end(2)) points.insert(points.end(), {point(0), point(1), point(2)});
    }
    std::sort(points.begin(), points.end());
    for (std::size_t v = 0; v < point_before_.size(); ++v) {
      if (std::binary_search(points.begin(), points.end(), point_before_[v])) result_.locked[v] = 1;
    }
  }

  void judge() {
    const auto before = static_cast<double>(faces_.size());
    const auto after = static_cast<double>(result_.faces.size());
    const double limit = failures_ == 0 ? first_limit : last_limit;
    if (result_.faces.empty() || after > limit * before) {
      result_.cause = report_.sentence.empty() ? "nothing could be removed" : report_.sentence;
      return;
    }
    mend_survivors();
    make_clusters();
  }

  // After the simplification points are where vertices are: one that went onto a locked point is of that point.
  void name_points() {
    restore_locked();
    result_.point = point_before_;
    const Weld weld = weld_by_position(mesh_.vertices.positions);
    std::vector<std::uint8_t> used(result_.vertices.size(), 0);
    for (const LiveFace& f : result_.faces) {
      for (const VertexId v : f.vertex) used[v] = 1;
    }
    std::vector<std::uint64_t> best(weld.point_count(), std::numeric_limits<std::uint64_t>::max());
    std::vector<float> deviation_m(weld.point_count(), 0.0F);
    for (std::uint32_t v = 0; v < used.size(); ++v) {
      if (used[v] == 0) continue;
      const std::uint64_t rank = (result_.locked[v] != 0 ? 0 : 1ULL << 32U) | result_.point[v];
      best[weld.point_of[v]] = std::min(best[weld.point_of[v]], rank);
      deviation_m[weld.point_of[v]] = std::max(deviation_m[weld.point_of[v]], result_.deviation_m[v]);
    }
    for (std::uint32_t v = 0; v < used.size(); ++v) {
      if (used[v] == 0) continue;
      result_.point[v] = static_cast<std::uint32_t>(best[weld.point_of[v]]);
      result_.deviation_m[v] = deviation_m[weld.point_of[v]];
    }
    used_ = std::move(used);
  }

  // The engine may turn the normal of a locked vertex with its faces; other groups draw that vertex too.
  void restore_locked() {
    for (std::uint32_t v = 0; v < result_.locked.size(); ++v) {
      if (result_.locked[v] == 0) continue;
      if (!start_.normals.empty()) mesh_.vertices.normals[v] = start_.normals[v];
      if (!start_.uvs.empty()) mesh_.vertices.uvs[v] = start_.uvs[v];
      if (!start_.colors.empty()) mesh_.vertices.colors[v] = start_.colors[v];
    }
  }

  // Every vertex must go to one that is still drawn; where its part vanished whole, to the nearest.
  void mend_survivors() {
    std::vector<std::uint32_t> drawn;
    for (std::uint32_t v = 0; v < used_.size(); ++v) {
      if (used_[v] != 0) drawn.push_back(v);
    }
    std::vector<std::uint32_t> mended(used_.size(), none);  // by where the merges ended
    for (std::uint32_t v = 0; v < used_.size(); ++v) {
      const std::uint32_t end = used_[v] != 0 ? v : result_.survivor[v];
      if (used_[end] != 0) {
        result_.survivor[v] = end;
        continue;
      }
      if (mended[end] == none) mended[end] = nearest(drawn, mesh_.vertices.positions[end]);
      result_.survivor[v] = mended[end];
    }
    agree_on_places(drawn);
  }

  // Vertices of one place must go to one place, or a seam would open on the way. Where the engine was not of one mind
  // (a vertex whose last face vanished has no place of its own), the place that most faces go to is taken.
  void agree_on_places(const std::vector<std::uint32_t>& drawn) {
    std::vector<std::uint32_t> corners(used_.size(), 0);
    for (const LiveFace& f : local_) {
      for (const VertexId v : f.vertex) ++corners[v];
    }
    std::vector<std::uint32_t> order(used_.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto goes_to = [&](std::uint32_t v) { return result_.point[result_.survivor[v]]; };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (point_before_[a] != point_before_[b]) return point_before_[a] < point_before_[b];
      return goes_to(a) != goes_to(b) ? goes_to(a) < goes_to(b) : a < b;
    });
    for (std::size_t begin = 0; begin < order.size();) {
      std::size_t end = begin;
      std::uint32_t most = 0;
      std::uint32_t best = none;
      for (; end < order.size() && point_before_[order[end]] == point_before_[order[begin]];) {
        std::uint32_t votes = 0;
        const std::uint32_t place = goes_to(order[end]);
        for (; end < order.size() && point_before_[order[end]] == point_before_[order[begin]] &&
               goes_to(order[end]) == place;
             ++end) {
          votes += corners[order[end]] +
                   (result_.locked[order[end]] != 0 && place == point_before_[order[end]] ? 1000U : 0U);
        }
        if (votes > most) {
          most = votes;
          best = place;
        }
      }
      for (std::size_t i = begin; i != end; ++i) {
        if (best != none && goes_to(order[i]) != best) result_.survivor[order[i]] = like(order[i], best, drawn);
      }
      begin = end;
    }
  }

  // The drawn vertex at a point that looks most like vertex v.
  [[nodiscard]] std::uint32_t like(std::uint32_t v, std::uint32_t point,
                                   const std::vector<std::uint32_t>& drawn) const {
    std::uint32_t best = none;
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t w : drawn) {
      if (result_.point[w] != point) continue;
      const float distance = start_.uvs.empty() ? 0.0F : glm::length(mesh_.vertices.uvs[w] - start_.uvs[v]);
      if (best == none || distance < least) {
        least = distance;
        best = w;
      }
    }
    return best;
  }

  [[nodiscard]] std::uint32_t nearest(const std::vector<std::uint32_t>& among, const glm::vec3& place) const {
    std::uint32_t best = among.front();
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : among) {
      const glm::dvec3 d = glm::dvec3{mesh_.vertices.positions[v]} - glm::dvec3{place};
      if (glm::dot(d, d) < least) {
        least = glm::dot(d, d);
        best = v;
      }
    }
    return best;
  }

  void make_clusters() {
    Ground ground;
    ground.values = std::move(mesh_.vertices);
    ground.point_of = result_.point;
    Pieces pieces = split(std::move(result_.faces), ground, work_.options.max_triangles);
    result_.values = std::move(ground.values);
    result_.faces = std::move(pieces.faces);
    result_.clusters = std::move(pieces.clusters);
    for (const Range& c : result_.clusters) put_in_order({result_.faces.data() + c.begin, c.size()}, work_.source);
    result_.reduced = result_.clusters.size() < group_.clusters.size() ||
                      (group_.clusters.size() == 1 && result_.faces.size() * 2 <= faces_.size());
    if (!result_.reduced) result_.cause = "it could not be held by fewer clusters";
  }

  const Work& work_;
  const Group& group_;
  std::uint32_t failures_;
  collapse::Scruples scruples_;
  const Context& context_;
  GroupResult result_;
  std::vector<LiveFace> faces_;
  std::vector<LiveFace> local_;              // the same between places in GroupResult::vertices
  std::vector<VertexId> indices_;            // the same as one list
  std::vector<std::uint32_t> point_before_;  // per local vertex
  std::vector<std::uint8_t> border_before_;  // per local vertex
  Edges border_edges_;                       // ascending
  Edges border_edges_within_;                // those that more than one face of the group uses
  VertexArrays start_;
  Mesh mesh_;
  EdgeCollapseOptions options_;
  CollapseReport report_;
  std::vector<std::uint8_t> used_;  // per local vertex: still drawn
};

}  // namespace

GroupResult simplify_group(const Work& work, const Group& group, std::uint32_t failures, collapse::Scruples scruples,
                           const Context& context) {
  return Job{work, group, failures, scruples, context}.run();
}

}  // namespace lodestone::clusters
