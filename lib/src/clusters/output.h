// SPDX-License-Identifier: MIT
// The clusters as they are made, and what becomes of them.
#pragma once

#include <vector>

#include <lodestone/clusters.h>

#include "clusters/live.h"

namespace lodestone::clusters {

class Output {
 public:
  explicit Output(const Mesh& source) : source_(source) {}

  // Adds a cluster of faces, put in order, between vertices whose present values are in `values`; returns its node
  // draft.
  std::uint32_t add_cluster(std::span<const LiveFace> faces, const VertexArrays& values, std::uint32_t level,
                            GroupId maker);

  // A group of the clusters given; `made`: those it made, added already.
  GroupId begin_group() {
    groups_.emplace_back();
    return static_cast<GroupId>(groups_.size() - 1);
  }
  // `end_of(v)`: where the simplification took vertex v of the ground.
  template <class EndOf>
  void end_group(GroupId group, double error_m, const std::vector<std::uint32_t>& members,
                 const std::vector<std::uint32_t>& made, EndOf end_of) {
    for (const std::uint32_t m : made) {
      for (std::uint32_t i = clusters_[m].vertices.begin; i != clusters_[m].vertices.end; ++i) {
        if (place_[vertex_of_[i]] == none) place_[vertex_of_[i]] = i;
      }
    }
    for (const std::uint32_t m : members) {
      nodes_[m].group = group;
      for (std::uint32_t i = clusters_[m].vertices.begin; i != clusters_[m].vertices.end; ++i) {
        result_.morph_targets[i] = place_[end_of(vertex_of_[i])];
      }
    }
    for (const std::uint32_t m : made) {
      for (std::uint32_t i = clusters_[m].vertices.begin; i != clusters_[m].vertices.end; ++i) {
        place_[vertex_of_[i]] = none;
      }
    }
    set_bounds(group, error_m, members, made);
  }
  void add_level(const ClusterLevel& level) { result_.levels.push_back(level); }
  void end_cluster(std::uint32_t draft, const std::string& cause) { causes_.push_back({draft, cause}); }

  [[nodiscard]] Result<ClusterGraph> finish();

 private:
  void set_bounds(GroupId group, double error_m, const std::vector<std::uint32_t>& members,
                  const std::vector<std::uint32_t>& made);

  const Mesh& source_;
  ClusterGraph result_;
  std::vector<Cluster> clusters_;     // per node draft
  std::vector<VertexId> vertex_of_;   // per vertex of the result: which one of the ground it was
  std::vector<std::uint32_t> place_;  // per vertex of the ground, while it is looked for
  std::vector<NodeDraft> nodes_;
  std::vector<GroupDraft> groups_;
  std::vector<std::pair<std::uint32_t, std::string>> causes_;
};

}  // namespace lodestone::clusters
