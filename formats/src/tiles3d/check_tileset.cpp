// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include <lodestone/outcrop.h>
#include <lodestone/tileset_writer.h>

#include "tiles3d/read_tileset.h"

namespace lodestone {
namespace {

using Key = std::array<std::uint32_t, 6>;  // two positions, bit by bit

class Checker {
 public:
  Checker(const Tileset& tileset, const Context& context) : tileset_(tileset), context_(context) {}

  Result<TilesetCheck> run() {
    levels_.resize(tileset_.level_count);
    for (std::uint32_t i = 0; i < tileset_.tiles.size(); ++i) {
      if (context_.cancelled()) return Error{ErrorCode::Cancelled, "checking was cancelled", ""};
      check_place(i);
      if (Status status = check_content(i); !status) return status.error();
      context_.report("check", static_cast<double>(i + 1) / static_cast<double>(tileset_.tiles.size()));
    }
    for (std::size_t level = 0; level < levels_.size(); ++level) count_open(levels_[level], level);
    return std::move(result_);
  }

 private:
  void fault(std::uint32_t tile, const std::string& what) {
    constexpr std::size_t most = 10;
    if (result_.faults.size() < most) result_.faults.push_back(tileset_.tiles[tile].uri + ": " + what);
  }
  void check_place(std::uint32_t i) {
    const TilesetTile& tile = tileset_.tiles[i];
    if (tile.parent == none) return;
    const TilesetTile& parent = tileset_.tiles[tile.parent];
    if (!(tile.geometric_error < parent.geometric_error)) {
      ++result_.errors_not_monotone;
      fault(i, "its error is not below its parent's");
    }
    const double slack = 1e-9 * parent.bounds.diagonal_m();
    if (glm::any(glm::lessThan(tile.bounds.min, parent.bounds.min - slack)) ||
        glm::any(glm::greaterThan(tile.bounds.max, parent.bounds.max + slack))) {
      ++result_.children_outside_parent;
      fault(i, "its box is not inside its parent's");
    }
  }
  Status check_content(std::uint32_t i) {
    const TilesetTile& tile = tileset_.tiles[i];
    if (tile.uri.empty()) return Done{};
    auto content = read_tile(tileset_, i, LoadTextures::Reference);
    if (!content) return content.error();
    ++result_.tiles;
    result_.bytes += content->file_bytes;
    const Mesh& mesh = content->mesh;
    if (tile.children.empty()) result_.triangles += surface_triangle_count(mesh);
    bool outside = false;
    for (const glm::vec3& p : mesh.vertices.positions) {
      const glm::dvec3 at = mesh.origin + glm::dvec3{p};
      outside =
          outside || glm::any(glm::lessThan(at, tile.bounds.min)) || glm::any(glm::greaterThan(at, tile.bounds.max));
    }
    if (outside) {
      ++result_.contents_outside_box;
      fault(i, "a vertex lies outside its box");
    }
    for (std::size_t c = 0; c < mesh.indices.size(); ++c) {
      if (is_skirt(mesh, static_cast<FaceId>(c / 3))) continue;
      const glm::vec3& a = mesh.vertices.positions[mesh.indices[c]];
      const glm::vec3& b = mesh.vertices.positions[mesh.indices[c % 3 == 2 ? c - 2 : c + 1]];
      const std::array<std::uint32_t, 3> ka = bits(a);
      const std::array<std::uint32_t, 3> kb = bits(b);
      if (ka == kb) continue;
      const auto& low = std::min(ka, kb);
      const auto& high = std::max(ka, kb);
      levels_[tile.level].push_back({low[0], low[1], low[2], high[0], high[1], high[2]});
    }
    return Done{};
  }
  static std::array<std::uint32_t, 3> bits(const glm::vec3& p) {
    const auto one = [](float x) { return std::bit_cast<std::uint32_t>(x == 0.0F ? 0.0F : x); };
    return {one(p.x), one(p.y), one(p.z)};
  }
  void count_open(std::vector<Key>& edges, std::size_t level) {
    std::sort(edges.begin(), edges.end());
    std::uint64_t open = 0;
    for (std::size_t i = 0; i < edges.size();) {
      std::size_t end = i + 1;
      while (end < edges.size() && edges[end] == edges[i]) ++end;
      if (end == i + 1) ++open;
      i = end;
    }
    const std::uint64_t border = level < tileset_.open_edges.size() ? tileset_.open_edges[level] : 0;
    result_.seams_open += open > border ? open - border : 0;
  }

  const Tileset& tileset_;
  const Context& context_;
  TilesetCheck result_;
  std::vector<std::vector<Key>> levels_;  // edges of all tiles
};

}  // namespace

Result<TilesetCheck> check_tileset(const std::filesystem::path& tileset_json, const Context& context) {
  const auto tileset = read_tileset(tileset_json);
  if (!tileset) return tileset.error();
  return Checker{*tileset, context}.run();
}

}  // namespace lodestone
