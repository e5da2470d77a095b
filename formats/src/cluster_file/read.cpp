// SPDX-License-Identifier: MIT
#include <lodestone/cluster_file.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "cluster_file/page_codec.h"
#include "reader.h"

namespace lodestone {

using namespace cluster_file;

struct ClusterFile::State {
  Input input;
  Header header;
  Codec codec;
  std::uint64_t pages_at = 0;
  std::vector<GroupId> group_of;             // per node
  std::vector<std::uint32_t> made_vertices;  // per group: vertices of all that it made

  explicit State(Input from) : input(std::move(from)) {}
};

namespace {

constexpr std::uint64_t max_file_bytes = 1ULL << 40;

Error fault(const Input& input, std::string message, ErrorCode code = ErrorCode::BadData) {
  return Error{code, std::move(message), input.name()};
}

// Vertices of what each group made.
std::vector<std::uint32_t> count_made(const ClusterGraph& outline) {
  std::vector<std::uint32_t> made(outline.graph.groups.size(), 0);
  for (const LodLink& link : outline.graph.links) {
    for (NodeId n = link.nodes.begin; link.maker != none && n != link.nodes.end; ++n) {
      made[link.maker] += outline.clusters[n].vertices.size();
    }
  }
  return made;
}

// Those that lie behind the pages.
std::optional<Error> read_textures(const Input& input, std::uint64_t pages_at, Header& header) {
  std::uint64_t at = pages_at;
  if (!header.pages.empty()) at += header.pages.back().offset + header.pages.back().stored_bytes;
  for (const TextureEntry& entry : header.textures) {
    if (at > input.size() || entry.bytes > input.size() - at) return fault(input, "the file ends inside a texture");
    auto bytes = std::make_shared<std::vector<std::uint8_t>>(entry.bytes);
    if (input.read(at, *bytes) != bytes->size() || model_file::checksum(*bytes) != entry.checksum) {
      return fault(input, "an embedded texture is damaged");
    }
    header.outline.textures[entry.texture].encoded = std::move(bytes);
    at += entry.bytes;
  }
  return std::nullopt;
}

}  // namespace

ClusterFile::ClusterFile(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
ClusterFile::~ClusterFile() = default;

const LodGraph& ClusterFile::graph() const noexcept { return state_->header.outline.graph; }
const ClusterGraph& ClusterFile::outline() const noexcept { return state_->header.outline; }

PageId ClusterFile::page_of(NodeId node) const noexcept {
  const auto& pages = state_->header.pages;
  const auto at =
      std::upper_bound(pages.begin(), pages.end(), node, [](NodeId n, const PageEntry& p) { return n < p.nodes.end; });
  return static_cast<PageId>(at - pages.begin());
}

Result<std::shared_ptr<const ClusterFile>> ClusterFile::open(const std::filesystem::path& file) {
  auto input = Input::open(file, max_file_bytes);
  if (!input) return input.error();
  auto state = std::make_unique<State>(*input);
  Bytes bytes(model_file::prologue_bytes);
  bytes.resize(input->read(0, bytes));
  std::uint64_t size = 0;
  if (auto wrong = model_file::sealed_size(lodg_file, bytes, size)) return fault(*input, wrong->message, wrong->code);
  if (size > input->size()) return fault(*input, "the file ends inside its header; copy it again");
  bytes.resize(size);
  if (input->read(0, bytes) != size) return fault(*input, "the file cannot be read", ErrorCode::Unreadable);
  if (auto wrong = read_header(bytes, state->header)) return fault(*input, wrong->message, wrong->code);
  const Header& header = state->header;
  state->codec = {header.grid, header.normals, header.uvs, header.colors};
  state->pages_at = size;
  state->group_of = groups_of_nodes(header.outline.graph);
  state->made_vertices = count_made(header.outline);
  if (auto wrong = read_textures(*input, size, state->header)) return *wrong;
  for (Texture& texture : state->header.outline.textures) {
    if (texture.path.empty()) continue;
    if (const auto beside = find_beside(file.parent_path(), texture.path)) texture.path = beside->string();
  }
  return std::shared_ptr<const ClusterFile>(new ClusterFile(std::move(state)));
}

Result<ClusterPage> ClusterFile::load(PageId page) const {
  const State& s = *state_;
  const PageEntry& entry = s.header.pages[page];
  const auto broken = [&](const char* what) { return fault(s.input, "page " + std::to_string(page) + " " + what); };
  Bytes stored(entry.stored_bytes);
  if (s.input.read(s.pages_at + entry.offset, stored) != stored.size())
    return broken("lies beyond the end of the file");
  if (model_file::checksum(stored) != entry.checksum) return broken("is damaged");
  Bytes raw(entry.raw_bytes);
  if (!entry.compressed) raw = stored;
  if (entry.compressed && !model_file::unpack(stored, raw)) return broken("does not unpack");
  ReadColumns columns;
  if (!model_file::split_columns(raw, columns)) return broken("has no valid table");
  ClusterPage result;
  result.nodes = entry.nodes;
  Carry carry;
  const ClusterGraph& outline = s.header.outline;
  for (NodeId n = entry.nodes.begin; n != entry.nodes.end; ++n) {
    const Cluster& cluster = outline.clusters[n];
    const GroupId group = s.group_of[n];
    Piece piece;
    for (std::uint32_t i = cluster.sections.begin; i != cluster.sections.end; ++i) {
      piece.section_ends.push_back(outline.sections[i].triangles.end - cluster.triangles.begin);
    }
    if (!decode(s.codec, cluster.vertices.size(), group != 0, carry, columns, piece)) return broken("makes no sense");
    result.first_vertex.push_back(result.vertices.size());
    result.first_triangle.push_back(static_cast<std::uint32_t>(result.indices.size() / 3));
    for (const Words& words : piece.vertices) s.codec.append(words, result.vertices);
    result.indices.insert(result.indices.end(), piece.indices.begin(), piece.indices.end());
    if (group == 0) result.morph_targets.insert(result.morph_targets.end(), cluster.vertices.size(), none);
    for (const std::uint32_t target : piece.targets) {
      if (target >= s.made_vertices[group]) return broken("has a vertex that goes nowhere");
      result.morph_targets.push_back(target);
    }
  }
  const VertexArrays& v = result.vertices;
  result.bytes = v.positions.size() * sizeof(glm::vec3) + v.normals.size() * sizeof(glm::vec3) +
                 v.uvs.size() * sizeof(glm::vec2) + v.colors.size() * sizeof(glm::u8vec4) +
                 result.morph_targets.size() * 4 + result.indices.size() + result.first_vertex.size() * 8;
  return result;
}

Result<ClusterGraph> read_cluster_graph(const std::filesystem::path& file, const Context& context) {
  auto opened = ClusterFile::open(file);
  if (!opened) return opened.error();
  const ClusterFile& source = **opened;
  ClusterGraph graph = source.outline();
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  std::vector<std::uint32_t> targets;
  for (PageId p = 0; p < graph.graph.page_count; ++p) {
    if (context.cancelled()) return Error{ErrorCode::Cancelled, "reading was cancelled", file.string()};
    const auto page = source.load(p);
    if (!page) return page.error();
    append(graph.vertices.positions, page->vertices.positions);
    append(graph.vertices.normals, page->vertices.normals);
    append(graph.vertices.uvs, page->vertices.uvs);
    append(graph.vertices.colors, page->vertices.colors);
    append(graph.indices, page->indices);
    append(targets, page->morph_targets);
  }
  // From places among what a group made to vertices.
  std::vector<std::vector<std::uint32_t>> made(graph.graph.groups.size());
  std::vector<GroupId> maker(graph.clusters.size(), none);
  for (const LodLink& link : graph.graph.links)
    std::fill(maker.begin() + link.nodes.begin, maker.begin() + link.nodes.end, link.maker);
  for (NodeId n = 0; n < graph.clusters.size(); ++n) {
    const Range vertices = graph.clusters[n].vertices;
    for (std::uint32_t v = vertices.begin; maker[n] != none && v != vertices.end; ++v) made[maker[n]].push_back(v);
  }
  const std::vector<GroupId> group_of = groups_of_nodes(graph.graph);
  graph.morph_targets.resize(targets.size());
  for (NodeId n = 0; n < graph.clusters.size(); ++n) {
    const Range vertices = graph.clusters[n].vertices;
    for (std::uint32_t v = vertices.begin; v != vertices.end; ++v) {
      graph.morph_targets[v] = targets[v] == none ? v : made[group_of[n]][targets[v]];
    }
  }
  return graph;
}

bool is_cluster_file(const std::filesystem::path& file) {
  const auto input = Input::open(file, max_file_bytes);
  std::uint8_t front[sizeof(lodg_file.magic)] = {};
  return input && input->read(0, front) == sizeof(front) && std::memcmp(front, lodg_file.magic, sizeof(front)) == 0;
}

}  // namespace lodestone
