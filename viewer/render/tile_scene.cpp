// SPDX-License-Identifier: MIT
#include "tile_scene.h"

#include "detailed_side.h"

namespace lodestone::render {

TileScene::TileScene(const Gl& gl, std::shared_ptr<const TilePyramid> pyramid, const PagerOptions& options)
    : gl_(gl), pyramid_(std::move(pyramid)), pager_(pyramid_, options) {}

void TileScene::update(const View& view, double dt_s) { show(pager_.update(view, dt_s)); }

// Not by the pager's settle(): what is uploaded on the way lets go of its pixels.
void TileScene::settle(const View& view) {
  for (update(view, 0.0); pager_.status().wanted_tiles > 0; update(view, 0.0)) pager_.wait();
}

void TileScene::show(std::span<const NodeId> drawn) {
  // What the pager has let go of must not be referred to any more.
  std::erase_if(tiles_, [&](const auto& tile) { return pager_.content(tile.first) == nullptr; });
  items_.clear();
  for (const NodeId n : drawn) {
    const Mesh& mesh = *pager_.content(n);
    std::unique_ptr<Tile>& tile = tiles_[n];
    if (!tile) {
      tile = std::make_unique<Tile>(gl_, mesh);
      pager_.forget_pixels(n);
    }
    items_.push_back({.geometry = &tile->geometry,
                      .surfaces = &tile->surfaces,
                      .offset_m = mesh.origin,
                      .size_m = bounds().diagonal_m(),
                      .share = pager_.share(n)});
  }
}

std::uint32_t TileScene::triangle_count() const {
  std::uint32_t count = 0;
  for (const Item& item : items_) count += item.geometry->arrays().triangle_count();
  return count;
}

double TileScene::yaw_rad() const {
  const Mesh* root = pager_.content(0);
  return root != nullptr ? detailed_yaw_rad(SortedMesh{*root}.arrays()) : 0.0;
}

Lighting TileScene::lighting(Lighting asked) const {
  const Mesh* root = pager_.content(0);
  if (asked != Lighting::Automatic || root == nullptr) return asked;
  return root->textures.empty() ? Lighting::Lamps : Lighting::Photograph;
}

}  // namespace lodestone::render
