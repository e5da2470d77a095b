// SPDX-License-Identifier: MIT
/// \file
/// View-dependent detail of anything too large for one level: clusters of triangles, tiles of an outcrop, tiles of
/// terrain. One graph, one rule that selects what to draw.
///
/// A *node* is drawn whole or not at all (a cluster, a tile). A *group* is a set of nodes that are replaced together by
/// fewer, coarser ones: its `nodes` are the fine side, the nodes that it *made* are the coarse side and are in turn
/// nodes of coarser groups. A group is either refined (its nodes are drawn, or what is finer than they are) or not
/// (what it made is drawn, or what is coarser). So a node is drawn if its own group is refined and the group that made
/// it is not; a leaf was made by none, and the roots lie in group 0, which is always refined.
///
///     tree of tiles    every tile with children is a group: its nodes are the children, it made the tile itself
///     cluster graph    8 to 32 clusters are merged, simplified inside their locked border, and split again
///
/// A cut is valid, that is it shows every part of the model exactly once and without cracks, if and only if a group is
/// refined only where all groups that hold what it made are. select_cut() keeps to that by construction, whatever the
/// camera, the budget or the missing pages; validate() guarantees in addition that the projected error never grows from
/// a group to a finer one, so that no finer group is passed over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/result.h>
#include <lodestone/types.h>
#include <lodestone/view.h>

namespace lodestone {

using GroupId = std::uint32_t;
using NodeId = std::uint32_t;
using PageId = std::uint32_t;

/// What is drawn whole.
struct LodNode {
  Sphere bounds;  ///< of what is drawn, relative to the graph's origin
  std::uint32_t triangle_count = 0;
};

/// A run of nodes of one group that were all made by the same group: they appear and vanish together.
struct LodLink {
  GroupId maker = none;  ///< `none`: leaves, which nothing refines
  Range nodes;
};

/// The nodes of one group that lie on one page.
struct LodPart {
  Range nodes;
  PageId page = 0;
};

/// Nodes replaced together.
struct LodGroup {
  /// Encloses the group's nodes, what it made, and the bounds of the makers of its nodes.
  Sphere bounds;
  /// How far what the group made may deviate from the source, metres: above the error of every maker of its nodes.
  /// Infinite for group 0.
  double error_m = 0.0;
  Range nodes;                       ///< fine side
  Range links;                       ///< cover `nodes`, makers ascending, leaves (none) last
  Range parts;                       ///< cover `nodes`, pages ascending
  std::uint32_t parent_count = 0;    ///< groups that hold what this one made
  std::uint32_t triangle_count = 0;  ///< of its nodes
  std::uint32_t made_triangle_count = 0;
};

/// Flat arrays, immutable once built, shared by any number of threads. Groups stand before the makers of their nodes:
/// from coarse to fine.
struct LodGraph {
  std::vector<LodGroup> groups;
  std::vector<LodLink> links;
  std::vector<LodNode> nodes;
  std::vector<LodPart> parts;
  std::uint32_t page_count = 0;

  [[nodiscard]] bool empty() const noexcept { return nodes.empty(); }
};

/// A group and a node as a producer knows them, in any order.
struct GroupDraft {
  Sphere bounds;  ///< a good centre and a first radius; enlarged as needed
  double error_m = 0.0;
};
struct NodeDraft {
  Sphere bounds;
  std::uint32_t triangle_count = 0;
  GroupId group = none;  ///< draft that it is a node of; `none` for a root
  GroupId maker = none;  ///< draft that made it; `none` for a leaf
};

/// How far one group's error must be above the next finer one's: leaves a morph some way to go.
inline constexpr double default_error_step = 1e-6;

/// Puts drafts in order and makes the promises of validate() true: errors are raised until each exceeds those below it
/// by the share `error_step`, spheres are enlarged until they enclose, with a millionth to spare. Each node gets a page
/// of its own, in the order of nodes (siblings in a tree are neighbours); a producer of shared pages sets `parts` and
/// `page_count` afterwards.
struct AssembledGraph {
  LodGraph graph;
  std::vector<std::uint32_t> node_draft;   ///< per node of the graph: which draft it was
  std::vector<std::uint32_t> group_draft;  ///< per group of the graph: which draft it was; `none` for group 0
};
/// O(n log n). BadData if drafts are referred to that do not exist, if groups hold what was made of them, or a number
/// is not finite.
[[nodiscard]] Result<AssembledGraph> assemble_graph(std::span<const GroupDraft> groups,
                                                    std::span<const NodeDraft> nodes,
                                                    double error_step = default_error_step);

/// The same for a graph whose nodes' bounds or groups' errors were changed: raises and enlarges, never the reverse.
void keep_promises(LodGraph& graph, double error_step = default_error_step);

/// Checks everything that select_cut() relies on: ranges, order, counts, strictly increasing errors, enclosing spheres.
/// O(size). For graphs from files: nothing is trusted.
[[nodiscard]] Status validate(const LodGraph& graph);

enum class Culling : std::uint8_t {
  None,
  Frustum,  ///< What lies outside the view is neither refined nor returned.
};

struct CutOptions {
  /// A group is refined if its error covers more than this on the screen.
  double error_px = 1.0;
  /// Most triangles of the cut, those outside the view included; the groups with the largest error are refined first.
  /// 0 = no limit. The roots are drawn in any case.
  std::uint64_t triangle_budget = 0;
  Culling culling = Culling::Frustum;
  /// One per page, nonzero = loaded; empty = all are. A group whose nodes are not all loaded is not refined: what it
  /// made stands in. The pages of group 0 are taken as loaded.
  std::span<const std::uint8_t> resident;
};

/// A group that should be refined but whose pages are missing.
struct MissingGroup {
  GroupId group = none;
  double error_px = 0.0;  ///< what is drawn instead deviates so much: the priority of loading
};

/// Buffers of select_cut(), one per thread; they grow to what a graph needs and are then kept.
class CutScratch {
 public:
  /// Grows the buffers to the worst case of this graph, so that select_cut() allocates nothing.
  void reserve(const LodGraph& graph);

  /// The last cut's refined groups, parents before children.
  [[nodiscard]] std::span<const GroupId> refined() const noexcept { return refined_; }
  /// Groups that the last cut would have refined had they been loaded, in the order they were met.
  [[nodiscard]] std::span<const MissingGroup> missing() const noexcept { return missing_; }

 private:
  friend class CutSelection;
  struct Candidate {
    double error_px = 0.0;
    GroupId group = none;
  };
  std::vector<std::uint32_t> state_;  // per group: refined parents met so far, or that it is refined
  std::vector<GroupId> refined_;
  std::vector<Candidate> candidates_;
  std::vector<MissingGroup> missing_;
};

/// What the cut amounts to.
struct CutSummary {
  std::uint64_t triangle_count = 0;  ///< of the nodes returned
  double max_error_px = 0.0;         ///< of what is drawn inside the view: above the limit if budget or pages lack
  std::uint32_t groups_tested = 0;   ///< how many errors were projected
};

/// The nodes to draw from `view` (relative to the graph's origin), replaced in `out`, in an order that depends on the
/// input only. Walks from the roots and looks only at groups whose parents are refined: the time is proportional to
/// what is drawn, not to the model. Allocates nothing once scratch and `out` have grown (CutScratch::reserve).
/// Precondition: the graph is valid.
CutSummary select_cut(const LodGraph& graph, const View& view, const CutOptions& options, CutScratch& scratch,
                      std::vector<NodeId>& out) noexcept;

/// How far the nodes of a refined group have travelled towards what the group made, 0..1: 1 when the group's error has
/// come down to the limit (so that the exchange cannot be seen), 0 when it stands so high that one of its nodes' makers
/// has reached the limit (so that their exchange cannot either). One number for the whole group, whose border does not
/// move, so nothing opens. A group one of whose nodes' makers is refined must be at 0, because finer nodes do not
/// travel along; here that holds for every cut made with the same limit. Group 0 stays at 0.
[[nodiscard]] double morph_weight(const LodGraph& graph, const View& view, double error_px, GroupId group) noexcept;

}  // namespace lodestone
