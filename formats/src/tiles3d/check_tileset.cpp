// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include <lodestone/outcrop.h>
#include <lodestone/tileset_writer.h>

#include "tiles3d/read_tileset.h"

namespace lodestone {
namespace {

using Key = std::array<std::uint32_t, 6>;  // two positions, bit by bit

class Checker {
 public:
  Checker(const Tileset& tileset, const Context& context)
      : tileset_(tileset), context_(context), needed_(tileset.tiles.size()) {}

  Result<TilesetCheck> run() {
    std::vector<std::uint32_t> order(tileset_.tiles.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return tileset_.tiles[a].level < tileset_.tiles[b].level;
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (context_.cancelled()) return Error{ErrorCode::Cancelled, "checking was cancelled", ""};
      const std::uint32_t level = tileset_.tiles[order[i]].level;
      check_place(order[i]);
      if (Status status = check_content(order[i]); !status) return status.error();
      if (i + 1 == order.size() || tileset_.tiles[order[i + 1]].level != level) count_open(level);
      context_.report("check", static_cast<double>(i + 1) / static_cast<double>(order.size()));
    }
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
    Box& needed = needed_[i];  // children were looked at before
    for (const glm::vec3& p : mesh.vertices.positions) {
      const glm::dvec3 at = mesh.origin + glm::dvec3{p};
      needed.add(at);
      outside =
          outside || glm::any(glm::lessThan(at, tile.bounds.min)) || glm::any(glm::greaterThan(at, tile.bounds.max));
    }
    if (outside) {
      ++result_.contents_outside_box;
      fault(i, "a vertex lies outside its box");
    }
    const double slack_m = 0.01 * tile.bounds.diagonal_m();
    if (glm::any(glm::lessThan(tile.bounds.min, needed.min - slack_m)) ||
        glm::any(glm::greaterThan(tile.bounds.max, needed.max + slack_m))) {
      ++result_.loose_boxes;
      fault(i, "its box is larger than what it holds");
    }
    if (tile.parent != none) {
      needed_[tile.parent].add(needed.min);
      needed_[tile.parent].add(needed.max);
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
      edges_.push_back({low[0], low[1], low[2], high[0], high[1], high[2]});
    }
    return Done{};
  }
  static std::array<std::uint32_t, 3> bits(const glm::vec3& p) {
    const auto one = [](float x) { return std::bit_cast<std::uint32_t>(x == 0.0F ? 0.0F : x); };
    return {one(p.x), one(p.y), one(p.z)};
  }
  void count_open(std::uint32_t level) {
    std::sort(edges_.begin(), edges_.end());
    std::uint64_t open = 0;
    for (std::size_t i = 0; i < edges_.size();) {
      std::size_t end = i + 1;
      while (end < edges_.size() && edges_[end] == edges_[i]) ++end;
      if (end == i + 1) ++open;
      i = end;
    }
    const std::uint64_t border = level < tileset_.open_edges.size() ? tileset_.open_edges[level] : 0;
    result_.seams_open += open > border ? open - border : 0;
    edges_.clear();
  }

  const Tileset& tileset_;
  const Context& context_;
  TilesetCheck result_;
  std::vector<Box> needed_;  // per tile: of its content and those below
  std::vector<Key> edges_;   // of all tiles of the level at hand
};

}  // namespace

Result<TilesetCheck> check_tileset(const std::filesystem::path& tileset_json, const Context& context) {
  const auto tileset = read_tileset(tileset_json);
  if (!tileset) return tileset.error();
  return Checker{*tileset, context}.run();
}

}  // namespace lodestone
