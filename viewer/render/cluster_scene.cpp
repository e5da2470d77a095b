// SPDX-License-Identifier: MIT
#include "cluster_scene.h"

#include <algorithm>
#include <cmath>

namespace lodestone::render {
namespace {

constexpr int most_updates = 2000;

template <class Visit>
void for_each_array(const VertexArrays& from, VertexArrays& to, Visit visit) {
  visit(from.positions, to.positions);
  visit(from.normals, to.normals);
  visit(from.uvs, to.uvs);
  visit(from.colors, to.colors);
}

// Elements begin..end of every array, appended.
void append(const VertexArrays& from, Range range, VertexArrays& to) {
  for_each_array(from, to, [&](const auto& source, auto& out) {
    if (!source.empty()) out.insert(out.end(), source.begin() + range.begin, source.begin() + range.end);
  });
}

// A colour of its own for each node: hues a golden section apart, in two brightnesses; linear light.
glm::vec4 cluster_color(NodeId node) {
  const double hue = 6.0 * std::fmod(node * 0.6180339887498949, 1.0);
  const double light = node % 2 == 0 ? 0.62 : 0.38;
  const auto channel = [&](double at) {
    const double distance = std::abs(std::remainder(hue - at, 6.0));
    return static_cast<float>(light * (0.12 + 0.88 * std::clamp(2.0 - distance, 0.0, 1.0)));
  };
  return {channel(0.0), channel(2.0), channel(4.0), 1.0F};
}

}  // namespace

// The nodes of one group on one page, ready to draw at any phase of the morph.
struct ClusterScene::Part {
  VertexArrays own;
  VertexArrays target;                     // where each vertex travels to
  std::vector<std::uint16_t> indices;      // a page holds at most 128 KB, so fewer vertices than that
  std::vector<std::uint32_t> first_index;  // per node of the part, and one past the end
  std::unique_ptr<Geometry> geometry;
};

ClusterScene::ClusterScene(const Gl& gl, std::shared_ptr<const ClusterFile> file, const ClusterSceneOptions& options)
    : gl_(gl),
      file_(std::move(file)),
      options_(options),
      streamer_(file_, options.stream),
      morph_(file_->graph(), std::max(options.morph_seconds, 1e-3)),
      surfaces_(gl, file_->outline()),
      group_of_(groups_of_nodes(file_->graph())) {
  const LodGraph& graph = file_->graph();
  part_of_.resize(graph.nodes.size());
  for (std::uint32_t p = 0; p < graph.parts.size(); ++p) {
    const Range nodes = graph.parts[p].nodes;
    std::fill(part_of_.begin() + nodes.begin, part_of_.begin() + nodes.end, p);
  }
  parts_.resize(graph.parts.size());
  made_.resize(graph.groups.size());
  for (const LodLink& link : graph.links) {
    if (link.maker != none) made_[link.maker].push_back(link.nodes);
  }
  scratch_.reserve(graph);
  find_bounds();
}

ClusterScene::~ClusterScene() = default;

// The roots, and as far around them as what is finer may lie.
void ClusterScene::find_bounds() {
  const LodGraph& graph = file_->graph();
  if (graph.empty()) return;
  Box box;
  for (NodeId n = graph.groups[0].nodes.begin; n != graph.groups[0].nodes.end; ++n) {
    const ClusterPage* page = streamer_.page(file_->page_of(n));
    if (page == nullptr) continue;
    const std::uint32_t first = page->first_vertex[n - page->nodes.begin];
    for (std::uint32_t v = first; v != first + outline().clusters[n].vertices.size(); ++v) {
      box.add(glm::dvec3{page->vertices.positions[v]});
    }
  }
  if (box.empty()) return;
  const double error_m = graph.groups.size() > 1 ? graph.groups[1].error_m : 0.0;
  bounds_ = {box.min - error_m, box.max + error_m};
}

ClusterFrame ClusterScene::update(const View& view, CutOptions options, double dt_s) {
  streamer_.update(scratch_, morph_.refined());
  drop_parts_without_page();
  options.resident = streamer_.resident();
  ClusterFrame frame;
  if (options_.morph_seconds > 0.0) {
    frame.cut = morph_.update(view, options, dt_s, scratch_, cut_);
  } else {
    frame.cut = select_cut(file_->graph(), view, options, scratch_, cut_);
  }
  frame.clusters = static_cast<std::uint32_t>(cut_.size());
  frame.missing_groups = static_cast<std::uint32_t>(scratch_.missing().size());
  frame.settled = scratch_.missing().empty() && (options_.morph_seconds <= 0.0 || morph_.settled());
  return frame;
}

ClusterFrame ClusterScene::load(const View& view, const CutOptions& options) {
  ClusterFrame frame = update(view, options, 0.0);
  for (int i = 0; i < most_updates && frame.missing_groups > 0; ++i) {
    const std::uint64_t bytes = streamer_.resident_bytes();
    streamer_.update(scratch_, morph_.refined());
    streamer_.wait();
    frame = update(view, options, 0.0);
    if (streamer_.resident_bytes() == bytes) break;  // the budget is full, or what is missing is broken
  }
  return frame;
}

ClusterFrame ClusterScene::settle(const View& view, const CutOptions& options) {
  ClusterFrame frame = load(view, options);
  for (int i = 0; i < most_updates && !frame.settled; ++i) {
    frame = update(view, options, options_.morph_seconds);
    if (frame.missing_groups > 0 && morph_.settled()) break;
  }
  return frame;
}

void ClusterScene::drop_parts_without_page() {
  const LodGraph& graph = file_->graph();
  for (std::uint32_t p = 0; p < parts_.size(); ++p) {
    if (parts_[p] != nullptr && streamer_.page(graph.parts[p].page) == nullptr) parts_[p].reset();
  }
}

// The vertices that a group made, in the order in which morph targets are counted. They lie on pages of the groups
// above, which are loaded wherever this one is drawn.
VertexArrays ClusterScene::made_vertices(GroupId group) const {
  VertexArrays made;
  for (const Range& nodes : made_[group]) {
    for (NodeId n = nodes.begin; n != nodes.end; ++n) {
      const ClusterPage* page = streamer_.page(file_->page_of(n));
      if (page == nullptr) return {};
      const std::uint32_t first = page->first_vertex[n - page->nodes.begin];
      append(page->vertices, {first, first + outline().clusters[n].vertices.size()}, made);
    }
  }
  return made;
}

const ClusterScene::Part& ClusterScene::part(std::uint32_t index) {
  if (parts_[index] != nullptr) return *parts_[index];
  const LodPart& from = file_->graph().parts[index];
  const ClusterPage& page = *streamer_.page(from.page);
  const GroupId group = group_of_[from.nodes.begin];
  auto part = std::make_unique<Part>();
  const VertexArrays made = made_vertices(group);
  for (NodeId n = from.nodes.begin; n != from.nodes.end; ++n) {
    const std::uint32_t at = n - page.nodes.begin;
    const Cluster& cluster = outline().clusters[n];
    const std::uint32_t base = part->own.size();
    const Range vertices{page.first_vertex[at], page.first_vertex[at] + cluster.vertices.size()};
    append(page.vertices, vertices, part->own);
    for (std::uint32_t v = vertices.begin; v != vertices.end; ++v) {
      const std::uint32_t to = page.morph_targets[v];
      const bool travels = to < made.size();
      append(travels ? made : page.vertices, travels ? Range{to, to + 1} : Range{v, v + 1}, part->target);
    }
    part->first_index.push_back(static_cast<std::uint32_t>(part->indices.size()));
    const std::uint32_t first = 3 * page.first_triangle[at];
    for (std::uint32_t i = first; i != first + 3 * cluster.triangles.size(); ++i) {
      part->indices.push_back(static_cast<std::uint16_t>(base + page.indices[i]));
    }
  }
  part->first_index.push_back(static_cast<std::uint32_t>(part->indices.size()));
  part->geometry = std::make_unique<Geometry>(gl_, DrawArrays{.positions = part->own.positions,
                                                              .normals = part->own.normals,
                                                              .uvs = part->own.uvs,
                                                              .colors = part->own.colors,
                                                              .indices = std::as_bytes(std::span{part->indices}),
                                                              .index_bytes = 2,
                                                              .draws = {},
                                                              .target = &part->target});
  parts_[index] = std::move(part);
  return *parts_[index];
}

// Draws one after the other of one material are one draw, unless each cluster has its own colour.
void ClusterScene::add_item(std::uint32_t part_index, std::span<const NodeId> nodes, Coloring coloring) {
  const Part& drawn = part(part_index);
  const std::size_t first_draw = draws_.size();
  const NodeId first_node = file_->graph().parts[part_index].nodes.begin;
  for (const NodeId n : nodes) {
    const Cluster& cluster = outline().clusters[n];
    for (std::uint32_t s = cluster.sections.begin; s != cluster.sections.end; ++s) {
      const ClusterSection& section = outline().sections[s];
      const std::uint32_t first =
          drawn.first_index[n - first_node] + 3 * (section.triangles.begin - cluster.triangles.begin);
      const std::uint32_t count = 3 * section.triangles.size();
      const bool goes_on = draws_.size() > first_draw && coloring != Coloring::Clusters &&
                           draws_.back().material == section.material &&
                           draws_.back().first_index + draws_.back().index_count == first;
      if (goes_on) {
        draws_.back().index_count += count;
        continue;
      }
      draws_.push_back({section.material, first, count});
      if (coloring == Coloring::Clusters) colors_.push_back(cluster_color(n));
    }
  }
  const double weight = weights().empty() ? 0.0 : weights()[group_of_[nodes.front()]];
  items_.push_back({.geometry = drawn.geometry.get(),
                    .surfaces = &surfaces_,
                    .size_m = bounds_.diagonal_m(),
                    .morph = static_cast<float>(weight),
                    .draws = std::span{draws_}.subspan(first_draw),
                    .draw_colors = coloring == Coloring::Clusters ? std::span{colors_}.subspan(first_draw)
                                                                  : std::span<const glm::vec4>{}});
}

std::span<const Item> ClusterScene::items(Coloring coloring) {
  items_.clear();
  draws_.clear();
  colors_.clear();
  std::size_t most_draws = 0;  // room first, because items refer to what is appended
  for (const NodeId n : cut_) most_draws += outline().clusters[n].sections.size();
  draws_.reserve(most_draws);
  colors_.reserve(most_draws);
  for (std::size_t begin = 0; begin < cut_.size();) {
    const std::uint32_t p = part_of_[cut_[begin]];
    std::size_t end = begin;
    while (end < cut_.size() && part_of_[cut_[end]] == p) ++end;
    add_item(p, std::span{cut_}.subspan(begin, end - begin), coloring);
    begin = end;
  }
  return items_;
}

}  // namespace lodestone::render
