// SPDX-License-Identifier: MIT
// Based on: Wang et al. 2023, sections 2.1 to 2.5 (clusters, groups, locked simplification, repeated to one cluster).
// Differs: a group that cannot be reduced waits and is tried again among other neighbours; only after three failures
// its clusters become roots, listed with the cause, and their points stay locked for good, so that nothing cracks
// later.
#include <algorithm>
#include <cmath>

#include <lodestone/clusters.h>

#include "base/parallel.h"
#include "clusters/face_graph.h"
#include "clusters/group.h"
#include "clusters/output.h"
#include "clusters/simplify_group.h"
#include "clusters/split.h"
#include "clusters/walk.h"
#include "mesh/vertex_copy.h"
#include "mesh/weld.h"

namespace lodestone {
namespace {

using namespace clusters;

constexpr std::uint32_t block_clusters = 16;  // of the first cut in space
constexpr std::uint32_t most_failures = 3;    // of a cluster's groups, then it is a root
constexpr std::uint32_t most_levels = 64;
// Rounds of so few groups try both ways: near the top handles and narrow places hold everything up, and it may be
// better to let surfaces touch there. It costs little to see which.
constexpr std::size_t few_groups = 4;

class Builder {
 public:
  Builder(const Mesh& source, const ClusterOptions& options, const Context& context)
      : source_(source), options_(options), context_(context), output_(source) {}

  Result<ClusterGraph> run() {
    prepare();
    make_leaves();
    for (std::uint32_t level = 0; level < most_levels && !live_.clusters.empty() && !context_.cancelled(); ++level) {
      if (live_.clusters.size() == 1 && live_.clusters[0].failures == 0) break;
      round();
    }
    if (context_.cancelled()) return Error{ErrorCode::Cancelled, "building the cluster graph was cancelled", ""};
    if (!live_.clusters.empty()) report_level(0, last_error_m_);
    for (const LiveCluster& c : live_.clusters) output_.end_cluster(c.draft, "");
    return output_.finish();
  }

 private:
  void prepare() {
    for (FaceId f = 0; f < source_.triangle_count(); ++f) {
      const VertexId* v = &source_.indices[3 * std::size_t{f}];
      live_.faces.push_back({{v[0], v[1], v[2]}, f});
    }
    const std::uint32_t full = options_.max_triangles - options_.max_triangles / 64;
    blocks_ = cut_blocks(live_.faces, source_.vertices.positions, block_clusters * full, full);
    number_vertices();
    Weld weld = weld_by_position(ground_.values.positions);
    ground_.deviation_m.assign(weld.point_count(), 0.0F);
    ground_.locked.assign(weld.point_count(), 0);
    ground_.point_of = std::move(weld.point_of);
    find_border();
    diagonal_m_ = bounds(source_).diagonal_m();
    total_ = static_cast<double>(source_.triangle_count());
  }

  // In the order in which the faces use them.
  void number_vertices() {
    std::vector<VertexId> number(source_.vertex_count(), none);
    std::vector<VertexId> order;
    for (LiveFace& f : live_.faces) {
      for (VertexId& v : f.vertex) {
        if (number[v] == none) {
          number[v] = static_cast<VertexId>(order.size());
          order.push_back(v);
        }
        v = number[v];
      }
    }
    ground_.values = gathered(source_.vertices, order);
  }

  void find_border() {
    ground_.border.assign(ground_.deviation_m.size(), 0);
    std::vector<std::array<std::uint32_t, 3>> faces(live_.faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (std::size_t k = 0; k < 3; ++k) faces[f][k] = ground_.point_of[live_.faces[f].vertex[k]];
    }
    const std::vector<EdgeOfFace> edges = sorted_edges(faces, static_cast<std::uint32_t>(ground_.border.size()));
    for (std::size_t i = 0; i < edges.size();) {
      std::size_t end = i + 1;
      while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
      if (end == i + 1) ground_.border[edges[i].low] = ground_.border[edges[i].high] = 1;
      i = end;
    }
  }

  void make_leaves() {
    std::vector<Pieces> pieces(blocks_.size());
    parallel_for_each(blocks_.size(), 1, context_, [&](std::size_t i) {
      pieces[i] = split({live_.faces.begin() + blocks_[i].begin, live_.faces.begin() + blocks_[i].end}, ground_,
                        options_.max_triangles);
      for (const Range& c : pieces[i].clusters) put_in_order({pieces[i].faces.data() + c.begin, c.size()}, source_);
    });
    live_ = {};
    for (const Pieces& piece : pieces) {
      for (const Range& c : piece.clusters) add_live({piece.faces.data() + c.begin, c.size()}, ground_.values, 0, none);
    }
  }

  std::uint32_t add_live(std::span<const LiveFace> faces, const VertexArrays& values, std::uint32_t level,
                         GroupId maker) {
    const std::uint32_t draft = output_.add_cluster(faces, values, level, maker);
    const auto begin = static_cast<std::uint32_t>(live_.faces.size());
    live_.faces.insert(live_.faces.end(), faces.begin(), faces.end());
    live_.clusters.push_back({{begin, static_cast<std::uint32_t>(live_.faces.size())}, draft, level, 0});
    return draft;
  }

  void report_level(std::uint32_t groups, double error_m) {
    ClusterLevel level;
    level.clusters = static_cast<std::uint32_t>(live_.clusters.size());
    level.groups = groups;
    level.triangles = live_.faces.size();
    level.mean_fill = static_cast<double>(level.triangles) / std::max(1U, level.clusters);
    level.error_m = error_m;
    output_.add_level(level);
  }

  void round() {
    const Grouping grouping = group_clusters(live_, ended_, ground_, options_.group_clusters);
    report_level(static_cast<std::uint32_t>(grouping.groups.size()), last_error_m_);
    const Work work{source_, ground_, live_, grouping, options_, diagonal_m_};
    std::vector<GroupResult> results = simplified(work);
    if (context_.cancelled()) return;
    const Live before = std::move(live_);
    live_ = {};
    for (std::size_t i = 0; i < results.size(); ++i) {
      if (results[i].reduced) {
        accept(before, grouping.groups[i], results[i]);
      } else {
        postpone(before, grouping.groups[i], results[i]);
      }
      results[i] = {};
    }
    context_.report("clusters", 1.0 - static_cast<double>(live_.faces.size()) / total_);
  }

  [[nodiscard]] std::vector<GroupResult> simplified(const Work& work) const {
    const std::vector<Group>& groups = work.grouping.groups;
    std::vector<GroupResult> careful(groups.size());
    std::vector<GroupResult> free(groups.size() <= few_groups ? groups.size() : 0);
    parallel_for_each(careful.size() + free.size(), 1, context_, [&](std::size_t i) {
      const Group& group = groups[i % groups.size()];
      GroupResult& result = i < groups.size() ? careful[i] : free[i - groups.size()];
      const auto scruples = i < groups.size() ? collapse::Scruples::UntilStuck : collapse::Scruples::None;
      result = simplify_group(work, group, failures_of(group), scruples, context_);
    });
    for (std::size_t i = 0; i < free.size(); ++i) {
      const bool better = free[i].reduced && (!careful[i].reduced || free[i].error_m < careful[i].error_m);
      if (better) careful[i] = std::move(free[i]);
    }
    return careful;
  }

  [[nodiscard]] std::uint32_t failures_of(const Group& group) const {
    std::uint32_t most = 0;
    for (const std::uint32_t c : group.clusters) most = std::max(most, live_.clusters[c].failures);
    return most;
  }

  void accept(const Live& before, const Group& group, GroupResult& result) {
    take_values(result);
    std::vector<std::uint32_t> members;
    std::uint32_t level = 0;
    for (const std::uint32_t c : group.clusters) {
      members.push_back(before.clusters[c].draft);
      level = std::max(level, before.clusters[c].level + 1);
    }
    for (LiveFace& f : result.faces) {
      for (VertexId& v : f.vertex) v = result.vertices[v];
    }
    const GroupId id = output_.begin_group();
    std::vector<std::uint32_t> made;
    for (const Range& c : result.clusters) {
      made.push_back(add_live({result.faces.data() + c.begin, c.size()}, ground_.values, level, id));
    }
    const double error_m = options_.error == ErrorMeasure::Distance ? result.error_m : mean_edge_m(result.faces);
    for (std::uint32_t i = 0; i < result.vertices.size(); ++i) end_of_[result.vertices[i]] = result.survivor[i];
    output_.end_group(id, error_m, members, made, [&](VertexId v) { return result.vertices[end_of_[v]]; });
    last_error_m_ = std::max(last_error_m_, error_m);
  }

  void take_values(const GroupResult& result) {
    if (end_of_.empty()) end_of_.assign(ground_.values.size(), 0);
    for (std::uint32_t i = 0; i < result.vertices.size(); ++i) {
      const VertexId v = result.vertices[i];
      const std::uint32_t end = result.point[result.survivor[i]];
      if (ground_.border[ground_.point_of[v]] != 0) ground_.border[end] = 1;
      float& deviation = ground_.deviation_m[result.point[i]];
      deviation = std::max(deviation, result.deviation_m[i]);
      if (result.locked[i] != 0) continue;
      ground_.point_of[v] = result.point[i];
      ground_.values.positions[v] = result.values.positions[i];
      if (!result.values.normals.empty()) ground_.values.normals[v] = result.values.normals[i];
      if (!result.values.uvs.empty()) ground_.values.uvs[v] = result.values.uvs[i];
      if (!result.values.colors.empty()) ground_.values.colors[v] = result.values.colors[i];
    }
  }

  [[nodiscard]] double mean_edge_m(const std::vector<LiveFace>& faces) const {
    double area = 0.0;
    for (const LiveFace& f : faces) {
      const auto& p = ground_.values.positions;
      const glm::dvec3 a{p[f.vertex[0]]};
      area += 0.5 * glm::length(glm::cross(glm::dvec3{p[f.vertex[1]]} - a, glm::dvec3{p[f.vertex[2]]} - a));
    }
    return std::sqrt(area / static_cast<double>(faces.size()));
  }

  void postpone(const Live& before, const Group& group, const GroupResult& result) {
    for (const std::uint32_t c : group.clusters) {
      LiveCluster cluster = before.clusters[c];
      const auto faces = before.faces_of(cluster);
      ++cluster.failures;
      if (cluster.failures >= most_failures) {
        end(cluster, faces, result.cause);
        continue;
      }
      const auto begin = static_cast<std::uint32_t>(live_.faces.size());
      live_.faces.insert(live_.faces.end(), faces.begin(), faces.end());
      cluster.faces = {begin, static_cast<std::uint32_t>(live_.faces.size())};
      live_.clusters.push_back(cluster);
    }
  }

  void end(const LiveCluster& cluster, std::span<const LiveFace> faces, const std::string& cause) {
    output_.end_cluster(cluster.draft, cause);
    ended_.insert(ended_.end(), faces.begin(), faces.end());
    for (const LiveFace& f : faces) {
      for (const VertexId v : f.vertex) ground_.locked[ground_.point_of[v]] = 1;
    }
  }

  const Mesh& source_;
  const ClusterOptions& options_;
  const Context& context_;
  Output output_;
  Ground ground_;
  Live live_;
  std::vector<LiveFace> ended_;
  std::vector<Range> blocks_;          // of the faces of the source
  std::vector<std::uint32_t> end_of_;  // per vertex of the ground: place of its survivor in the group at hand
  double diagonal_m_ = 0.0;
  double total_ = 0.0;
  double last_error_m_ = 0.0;
};

}  // namespace

Result<ClusterGraph> build_cluster_graph(const Mesh& mesh, const ClusterOptions& options, const Context& context) {
  if (Status status = validate(mesh); !status.ok()) return status.error();
  if (options.max_triangles < 16 || options.max_triangles > 255) {
    return Error{ErrorCode::BadArgument, "a cluster has 16 to 255 triangles", "max_triangles"};
  }
  if (options.group_clusters < min_group || options.group_clusters > 24) {
    return Error{ErrorCode::BadArgument, "a group has 8 to 24 clusters", "group_clusters"};
  }
  return Builder{mesh, options, context}.run();
}

}  // namespace lodestone
