// SPDX-License-Identifier: MIT
// Based on: Wang et al. 2023, section 3 (pages of at most 128 KB filled with parts of groups, the first with the
// roots). Differs: nodes already stand group by group from coarse to fine, so filling pages in that order keeps
// dependent and neighbouring groups near each other.
#include <lodestone/cluster_file.h>

#include <algorithm>
#include <cmath>

#include "cluster_file/page_codec.h"
#include "output_file.h"

namespace lodestone {
namespace {

using namespace cluster_file;

// A page is closed before it could outgrow its limit by one more cluster of the largest size.
constexpr std::size_t largest_cluster_bytes = 255 * (3 * 4 + 2 * 2 + 2 * 4 + 4 + 4) + 255 * 4 * 3;
constexpr std::size_t open_page_bytes = max_page_bytes - largest_cluster_bytes - 16 * ColumnCount;

// Never inlined: g++ 12 at -O3 leaves out a rounding to float where it can see that the float becomes a double again
// (x and y of glm::dvec3{glm::vec3{v}}), and spheres then miss what they enclose by a rounding.
[[gnu::noinline]] float in_single(double value) { return static_cast<float>(value); }

class Writer {
 public:
  Writer(const ClusterGraph& graph, const ClusterWriteOptions& options, const Context& context)
      : graph_(graph), options_(options), context_(context) {}

  Result<ClusterFileSize> write(const std::filesystem::path& file) {
    describe();
    describe_textures(file);
    if (Status status = fill_pages(); !status.ok()) return status.error();
    keep_promises(header_.outline.graph);
    auto out = OutputFile::create(file);
    if (!out) return out.error();
    const Bytes head = write_header(header_);
    out->write(head.data(), head.size());
    ClusterFileSize size{.file_bytes = head.size(), .pages = static_cast<std::uint32_t>(header_.pages.size())};
    for (std::size_t p = 0; p < packed_.size(); ++p) {
      out->write(packed_[p].data(), packed_[p].size());
      size.file_bytes += packed_[p].size();
      size.page_bytes_max = std::max<std::uint64_t>(size.page_bytes_max, header_.pages[p].raw_bytes);
    }
    for (const TextureEntry& entry : header_.textures) {
      const auto& bytes = *graph_.textures[entry.texture].encoded;
      out->write(bytes.data(), bytes.size());
      size.file_bytes += bytes.size();
    }
    if (const Status done = out->commit(); !done.ok()) return done.error();
    return size;
  }

 private:
  void describe() {
    header_.generator = "lodestone";
    header_.normals = !graph_.vertices.normals.empty();
    header_.uvs = !graph_.vertices.uvs.empty();
    header_.colors = !graph_.vertices.colors.empty();
    Box box;
    for (const glm::vec3& p : graph_.vertices.positions) box.add(glm::dvec3{p});
    const glm::dvec3 size = box.size();
    header_.grid.bits = options_.position_bits;
    if (!box.empty()) header_.grid.corner = box.min;
    const double longest = std::max({size.x, size.y, size.z, 1e-6});
    header_.grid.step_m = longest / (std::exp2(options_.position_bits) - 1.0);
    ClusterGraph& outline = header_.outline;
    static_cast<Surroundings&>(outline) = graph_;
    outline.graph = graph_.graph;
    outline.levels = graph_.levels;
    outline.roots = graph_.roots;
    codec_ = {header_.grid, header_.normals, header_.uvs, header_.colors};
    // Snapping moves a vertex by half the diagonal of a cell at most.
    const double half_cell_m = std::sqrt(3.0) / 2.0 * header_.grid.step_m;
    for (std::size_t g = 1; g < outline.graph.groups.size(); ++g) outline.graph.groups[g].error_m += half_cell_m;
    for (ClusterLevel& level : outline.levels) level.error_m += half_cell_m;
    outline.graph.parts.clear();
    number_targets();
  }

  // Files beside stay where they are; what came inside another file goes inside this one.
  void describe_textures(const std::filesystem::path& file) {
    for (std::uint32_t i = 0; i < graph_.textures.size(); ++i) {
      Texture& texture = header_.outline.textures[i];
      texture.encoded.reset();
      texture.image.reset();
      const auto& bytes = graph_.textures[i].encoded;
      if (!texture.path.empty()) {
        texture.path = std::filesystem::path{texture.path}.lexically_proximate(file.parent_path()).generic_string();
      } else if (bytes != nullptr) {
        header_.textures.push_back({i, bytes->size(), model_file::checksum(*bytes)});
      }
    }
  }

  // A vertex's place among the vertices of all that its group made.
  void number_targets() {
    place_.assign(graph_.vertices.size(), 0);
    std::vector<std::uint32_t> count(graph_.graph.groups.size(), 0);
    maker_of_.assign(graph_.clusters.size(), none);
    for (const LodLink& link : graph_.graph.links) {
      for (NodeId n = link.nodes.begin; link.maker != none && n != link.nodes.end; ++n) maker_of_[n] = link.maker;
    }
    for (NodeId n = 0; n < graph_.clusters.size(); ++n) {
      if (maker_of_[n] == none) continue;
      const Range vertices = graph_.clusters[n].vertices;
      for (std::uint32_t v = vertices.begin; v != vertices.end; ++v) place_[v] = count[maker_of_[n]]++;
    }
  }

  Status fill_pages() {
    LodGraph& graph = header_.outline.graph;
    for (GroupId g = 0; g < graph.groups.size(); ++g) {
      LodGroup& group = graph.groups[g];
      group.parts.begin = static_cast<std::uint32_t>(graph.parts.size());
      for (NodeId n = group.nodes.begin; n != group.nodes.end; ++n) {
        if (context_.cancelled()) return Error{ErrorCode::Cancelled, "writing was cancelled", ""};
        if (page_bytes() > open_page_bytes) close_page(n);
        const auto page = static_cast<PageId>(packed_.size());
        if (graph.parts.size() == group.parts.begin || graph.parts.back().page != page) {
          graph.parts.push_back({{n, n}, page});
        }
        graph.parts.back().nodes.end = n + 1;
        add_cluster(n, g);
      }
      group.parts.end = static_cast<std::uint32_t>(graph.parts.size());
    }
    if (!graph.nodes.empty()) close_page(static_cast<NodeId>(graph.nodes.size()));
    graph.page_count = static_cast<std::uint32_t>(packed_.size());
    return Done{};
  }

  [[nodiscard]] std::size_t page_bytes() const {
    std::size_t bytes = 0;
    for (const auto& column : columns_) bytes += column.size_bytes();
    return bytes;
  }

  void add_cluster(NodeId node, GroupId group) {
    const Cluster& from = graph_.clusters[node];
    Piece piece;
    VertexArrays decoded;
    for (std::uint32_t v = from.vertices.begin; v != from.vertices.end; ++v) {
      piece.vertices.push_back(codec_.words_of(graph_.vertices, v));
      codec_.append(piece.vertices.back(), decoded);
      if (group != 0) piece.targets.push_back(place_[graph_.morph_targets[v]]);
    }
    piece.indices.assign(graph_.indices.begin() + 3 * std::ptrdiff_t{from.triangles.begin},
                         graph_.indices.begin() + 3 * std::ptrdiff_t{from.triangles.end});
    ClusterGraph& outline = header_.outline;
    Cluster to{.level = from.level};
    to.vertices = {vertex_count_, vertex_count_ + from.vertices.size()};
    to.triangles = {triangle_count_, triangle_count_ + from.triangles.size()};
    to.sections.begin = static_cast<std::uint32_t>(outline.sections.size());
    for (std::uint32_t s = from.sections.begin; s != from.sections.end; ++s) {
      ClusterSection section = graph_.sections[s];
      section.triangles.begin = section.triangles.begin - from.triangles.begin + triangle_count_;
      section.triangles.end = section.triangles.end - from.triangles.begin + triangle_count_;
      outline.sections.push_back(section);
      piece.section_ends.push_back(section.triangles.end - triangle_count_);
    }
    to.sections.end = static_cast<std::uint32_t>(outline.sections.size());
    if (!graph_.face_features.empty()) {
      outline.face_features.insert(outline.face_features.end(), graph_.face_features.begin() + from.triangles.begin,
                                   graph_.face_features.begin() + from.triangles.end);
    }
    vertex_count_ = to.vertices.end;
    triangle_count_ = to.triangles.end;
    outline.clusters.push_back(to);
    outline.graph.nodes[node].bounds = stored_bounds(graph_.graph.nodes[node].bounds.center, decoded);
    encode(codec_, piece, carry_, columns_);
  }

  // In the precision of the header, and around what a reader will see.
  static Sphere stored_bounds(const glm::dvec3& center, const VertexArrays& decoded) {
    Sphere sphere{{in_single(center.x), in_single(center.y), in_single(center.z)}, 0.0};
    for (const glm::vec3& p : decoded.positions) {
      sphere.radius_m = std::max(sphere.radius_m, glm::length(glm::dvec3{p} - sphere.center));
    }
    sphere.radius_m = std::nextafter(in_single(sphere.radius_m * (1.0 + 1e-6)), 3e38F);
    return sphere;
  }

  void close_page(NodeId end) {
    const model_file::PackedBlock block = model_file::pack_columns(columns_);
    PageEntry entry;
    entry.offset = offset_;
    entry.stored_bytes = static_cast<std::uint32_t>(block.bytes.size());
    entry.raw_bytes = static_cast<std::uint32_t>(block.raw_bytes);
    entry.compressed = block.compressed;
    entry.checksum = model_file::checksum(block.bytes);
    entry.nodes = {header_.pages.empty() ? 0 : header_.pages.back().nodes.end, end};
    header_.pages.push_back(entry);
    offset_ += block.bytes.size();
    packed_.push_back(block.bytes);
    for (auto& column : columns_) column.clear();
    carry_ = {};
    context_.report("pages", static_cast<double>(end) / static_cast<double>(graph_.clusters.size()));
  }

  const ClusterGraph& graph_;
  const ClusterWriteOptions& options_;
  const Context& context_;
  Header header_;
  Codec codec_;
  WrittenColumns columns_;
  Carry carry_;
  std::vector<Bytes> packed_;
  std::vector<std::uint32_t> place_;  // per vertex
  std::vector<GroupId> maker_of_;     // per node
  std::uint32_t vertex_count_ = 0;
  std::uint32_t triangle_count_ = 0;
  std::uint64_t offset_ = 0;
};

}  // namespace

Result<ClusterFileSize> write_cluster_graph(const ClusterGraph& graph, const std::filesystem::path& file,
                                            const ClusterWriteOptions& options, const Context& context) {
  if (options.position_bits < 8 || options.position_bits > 24) {
    return Error{ErrorCode::BadArgument, "positions take 8 to 24 bits", file.string()};
  }
  return Writer{graph, options, context}.write(file);
}

}  // namespace lodestone
