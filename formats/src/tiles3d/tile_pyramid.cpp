// SPDX-License-Identifier: MIT
#define XXH_INLINE_ALL  // header only
#include <lodestone/tile_loader.h>

#include <xxhash.h>

#include <algorithm>

#include "tiles3d/fetch.h"
#include "tiles3d/osgb_files.h"
#include "tiles3d/read_tileset.h"
#include "tiles3d/tileset_json.h"

namespace lodestone {

struct TilePyramid::Content {
  Tileset tileset;
  LodGraph graph;
  std::vector<std::uint32_t> tile_of_node;
  [[nodiscard]] Status make_graph(const std::string& name);
  std::unique_ptr<TileCache> cache;  // has a lock of its own
  std::unique_ptr<OsgbFiles> osgb;   // of an .osgb root; likewise
};

namespace {

// Where a tileset lies and what it says: another build has other boxes or errors, or at least another build.json.
std::uint64_t source_of(const std::filesystem::path& tileset_json, std::span<const std::uint8_t> text) {
  const std::string place = is_address(tileset_json)
                                ? tileset_json.string()
                                : std::filesystem::absolute(tileset_json).lexically_normal().string();
  std::uint64_t hash = XXH64(text.data(), text.size(), XXH64(place.data(), place.size(), 0));
  const auto build = fetch(tileset_json.parent_path() / "build.json", most_tileset_bytes);
  return build ? XXH64(build->data(), build->size(), hash) : hash;
}

Result<std::vector<std::uint8_t>> index_of(OsgbFiles& files) {
  const auto text = files.index();
  if (!text) return text.error();
  return std::vector<std::uint8_t>(text->begin(), text->end());
}

}  // namespace

TilePyramid::TilePyramid() = default;
TilePyramid::~TilePyramid() = default;

Result<std::shared_ptr<const TilePyramid>> TilePyramid::open(const std::filesystem::path& root,
                                                             const std::optional<TileCacheOptions>& cache) {
  std::shared_ptr<TilePyramid> out{new TilePyramid};
  out->content_ = std::make_unique<Content>();
  Content& content = *out->content_;
  if (is_osgb(root)) content.osgb = std::make_unique<OsgbFiles>(root);
  const auto text = content.osgb ? index_of(*content.osgb) : fetch(root, most_tileset_bytes);
  if (!text) return text.error();
  auto tileset = parse_tileset(*text, root.string());
  if (!tileset) return tileset.error();
  content.tileset = std::move(*tileset);
  content.tileset.folder = root.parent_path();
  if (Status status = content.make_graph(root.string()); !status) return status.error();
  if (cache && !content.osgb) {
    auto opened = TileCache::open(*cache, source_of(root, *text));
    if (!opened) return opened.error();
    content.cache = std::move(*opened);
  }
  return std::shared_ptr<const TilePyramid>{std::move(out)};
}

Status TilePyramid::Content::make_graph(const std::string& name) {
  std::vector<GroupDraft> groups;
  std::vector<NodeDraft> nodes;
  std::vector<GroupId> group_of(tileset.tiles.size(), none);
  for (std::uint32_t i = 0; i < tileset.tiles.size(); ++i) {  // parents stand before children
    const TilesetTile& tile = tileset.tiles[i];
    if (tile.uri.empty()) {
      return Error{ErrorCode::Unsupported, "a tile without content cannot be shown", name};
    }
    const Sphere sphere{tile.bounds.center(), 0.5 * tile.bounds.diagonal_m()};
    if (!tile.children.empty()) {
      group_of[i] = static_cast<GroupId>(groups.size());
      groups.push_back({sphere, std::max(0.0, tile.geometric_error) / client_error_px});
    }
    nodes.push_back(
        {.bounds = sphere, .group = tile.parent == none ? none : group_of[tile.parent], .maker = group_of[i]});
  }
  auto assembled = assemble_graph(groups, nodes);
  if (!assembled) return Error{assembled.error().code, assembled.error().message, name};
  graph = std::move(assembled->graph);
  tile_of_node = std::move(assembled->node_draft);
  return Done{};
}

const LodGraph& TilePyramid::graph() const noexcept { return content_->graph; }
const glm::dvec3& TilePyramid::origin() const noexcept { return content_->tileset.origin; }
const Box& TilePyramid::bounds() const noexcept { return content_->tileset.tiles.front().bounds; }
const std::string& TilePyramid::name(NodeId tile) const noexcept {
  return content_->tileset.tiles[content_->tile_of_node[tile]].uri;
}

TileCacheStatus TilePyramid::cache_status() const {
  return content_->cache ? content_->cache->status() : TileCacheStatus{};
}

Result<Mesh> TilePyramid::load(NodeId tile, LoadTextures textures) const {
  if (content_->osgb) return content_->osgb->tile(name(tile), textures);
  auto loaded = read_tile(content_->tileset, content_->tile_of_node[tile], textures, content_->cache.get());
  if (!loaded) return loaded.error();
  return std::move(loaded->mesh);
}

Mesh merged(std::span<const Mesh* const> tiles) {
  Mesh out;
  const auto has = [&](auto member) {
    return std::any_of(tiles.begin(), tiles.end(), [&](const Mesh* m) { return !(m->vertices.*member).empty(); });
  };
  const bool normals =
      std::all_of(tiles.begin(), tiles.end(), [](const Mesh* m) { return !m->vertices.normals.empty(); });
  const bool uvs = has(&VertexArrays::uvs);
  const bool colors = has(&VertexArrays::colors);
  for (const Mesh* tile : tiles) {
    const VertexArrays& from = tile->vertices;
    const std::uint32_t first_vertex = out.vertices.size();
    const auto first_texture = static_cast<std::uint32_t>(out.textures.size());
    const auto first_material = static_cast<MaterialId>(out.materials.size());
    for (const glm::vec3& p : from.positions) out.vertices.positions.push_back(p + glm::vec3{tile->origin});
    if (normals) out.vertices.normals.insert(out.vertices.normals.end(), from.normals.begin(), from.normals.end());
    const auto append = [&](bool wanted, auto& to, const auto& values, auto otherwise) {
      if (!wanted) return;
      to.insert(to.end(), values.begin(), values.end());
      to.resize(out.vertices.positions.size(), otherwise);
    };
    append(uvs, out.vertices.uvs, from.uvs, glm::vec2{0.0F});
    append(colors, out.vertices.colors, from.colors, glm::u8vec4{255});
    for (const Texture& texture : tile->textures) out.textures.push_back(texture);
    for (Material material : tile->materials) {
      if (material.texture != none) material.texture += first_texture;
      out.materials.push_back(std::move(material));
    }
    for (const VertexId v : tile->indices) out.indices.push_back(first_vertex + v);
    for (FaceId f = 0; f < tile->triangle_count(); ++f) {
      out.face_materials.push_back(first_material + tile->face_material(f));
    }
  }
  return out;
}

}  // namespace lodestone
