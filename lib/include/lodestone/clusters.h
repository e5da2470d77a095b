// SPDX-License-Identifier: MIT
/// \file
/// One large model at many resolutions at once: fine near the camera, coarse far away, no crack, and no pop. Source:
/// Wang et al. 2023, "An edge-locking LOD method for eliminating boundary cracks in 3D geological models".
///
/// The mesh is cut into clusters of at most 128 triangles. Neighbouring clusters form groups; a group's triangles are
/// merged, simplified to half inside its border, which does not move, and cut into clusters again, half as many; the
/// next round groups across the old borders. Any cut that select_cut() returns fits together along the borders, which
/// are the same vertices on both sides bit for bit.
///
///     auto graph = lodestone::build_cluster_graph(mesh);
///     select_cut(graph->graph, view, {.error_px = 1.0}, scratch, cut);
///     for (NodeId n : cut) draw(graph->clusters[n]);
///
/// New here: every vertex knows where the simplification took it, so that a group can *morph* into what it made before
/// it is exchanged (morph_weight(), morph()). Its border stays, so nothing opens.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/edge_collapse.h>
#include <lodestone/lod_graph.h>
#include <lodestone/mesh.h>

namespace lodestone {

/// What a group's error is.
enum class ErrorMeasure : std::uint8_t {
  Distance,  ///< how far its surface may lie from the source: what the rest of the library means by error
  Area,      ///< the paper's: grows with the triangles; the root of their mean area, metres. No bound of anything.
};

struct ClusterOptions {
  /// Triangles of a cluster, 16..255. 128 is what the paper and graphics cards like.
  std::uint32_t max_triangles = 128;
  /// Clusters of a group that are aimed at, 8..24 (a group has at most 32). More leave fewer locked vertices and give
  /// coarser steps.
  std::uint32_t group_clusters = 20;
  Attributes attributes = Attributes::All;
  ErrorMeasure error = ErrorMeasure::Distance;
};

/// Triangles of one material in a cluster.
struct ClusterSection {
  MaterialId material = 0;
  Range triangles;
};

/// A node of the graph. Vertices shared with other clusters are repeated, bit for bit.
struct Cluster {
  Range vertices;   ///< at most 255
  Range triangles;  ///< at most ClusterOptions::max_triangles
  Range sections;   ///< cover the triangles, materials ascending
  std::uint32_t level = 0;
};

/// What one round made; level 0 are the leaves.
struct ClusterLevel {
  std::uint32_t clusters = 0;
  std::uint32_t groups = 0;  ///< that these clusters were put into; 0 at the top
  std::uint64_t triangles = 0;
  double mean_fill = 0.0;  ///< triangles of a cluster
  double error_m = 0.0;    ///< largest
};

/// A cluster that nothing coarser stands for.
struct ClusterRoot {
  NodeId node = none;
  std::string cause;  ///< empty for the one root of a model that was reduced to the end
};

struct ClusterGraph : Surroundings {
  LodGraph graph;
  std::vector<Cluster> clusters;  ///< per node
  std::vector<ClusterSection> sections;
  VertexArrays vertices;  ///< of all clusters
  /// Per vertex: the vertex, of a cluster that its group made, to which the simplification took it. Itself in roots.
  std::vector<VertexId> morph_targets;
  std::vector<std::uint8_t> indices;     ///< 3 per triangle, counted from the cluster's first vertex
  std::vector<FeatureId> face_features;  ///< per triangle, or empty
  std::vector<ClusterLevel> levels;      ///< finest first
  std::vector<ClusterRoot> roots;
};

/// Builds the graph. Works on dirty input; where a group cannot be halved (everything locked) it is tried in other
/// groupings, and what still cannot is listed in `roots` with the cause. The same bytes for any number of workers.
/// Errors: BadData from validate(mesh), BadArgument, Cancelled. Seconds per million triangles and memory:
/// docs/clusters.md.
[[nodiscard]] Result<ClusterGraph> build_cluster_graph(const Mesh& mesh, const ClusterOptions& options = {},
                                                       const Context& context = {});

/// The clusters of a cut as one mesh; vertices are not welded.
[[nodiscard]] Mesh extract(const ClusterGraph& graph, std::span<const NodeId> cut);

/// The vertices of one cluster at morph weight `weight` (0..1, see morph_weight() of its group), appended to `out`:
/// positions, uvs and colours on straight lines, normals turned and brought back to unit length. What a vertex shader
/// does, for those without one.
void morph(const ClusterGraph& graph, NodeId node, double weight, VertexArrays& out);

/// The same as extract(), each cluster morphed by `weights[group of the cluster]`. Precondition for a surface without
/// cracks: the weight is 0 for groups one of whose nodes' makers is refined.
[[nodiscard]] Mesh extract_morphed(const ClusterGraph& graph, std::span<const NodeId> cut,
                                   std::span<const double> weights);

/// The group of every node.
[[nodiscard]] std::vector<GroupId> groups_of_nodes(const LodGraph& graph);

/// Whether each position (by place in ClusterGraph::vertices) belongs to the true border: the source had a free edge
/// there, or the simplification took such a vertex there.
[[nodiscard]] std::vector<std::uint8_t> true_border(const ClusterGraph& graph);

/// What is wrong with a mesh made from a cut.
struct CutFaults {
  std::uint32_t cracks = 0;       ///< edges used by one triangle, off the true border
  std::uint32_t t_junctions = 0;  ///< of these, those on which a vertex of another crack lies
};
/// Of extract() or extract_morphed() of that cut. `border` from true_border().
[[nodiscard]] CutFaults find_faults(const ClusterGraph& graph, std::span<const NodeId> cut, const Mesh& mesh,
                                    std::span<const std::uint8_t> border);

/// Group border invariance, of every group, exhaustive: edges that one face of the fine side of a group uses (its
/// border, where the surroundings have the other face) and that its coarse side lacks, and edges that one face of the
/// coarse side uses but not so on the fine side. The true border is left out. 0 means that no cut whatever can crack.
/// O(size).
[[nodiscard]] std::uint64_t changed_border_edges(const ClusterGraph& graph);

}  // namespace lodestone
