// SPDX-License-Identifier: MIT
// A tileset on the screen: the tiles that the camera needs, on the GPU while they are drawn.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include <lodestone/tile_loader.h>

#include "renderer.h"

namespace lodestone::render {

class TileScene {
 public:
  /// Reads the root tile. Nothing can be drawn if it cannot be read (status().failures says why).
  TileScene(const Gl& gl, std::shared_ptr<const TilePyramid> pyramid, const PagerOptions& options = {});

  /// Takes in what was loaded and asks for what the view lacks. With `dt_s` 0 tiles are exchanged without fading.
  void update(const View& view, double dt_s);
  /// Waits until all that the view needs is there.
  void settle(const View& view);

  /// To be drawn since the last update. Valid until the next.
  [[nodiscard]] std::span<const Item> items() const { return items_; }
  [[nodiscard]] std::uint32_t triangle_count() const;
  [[nodiscard]] const Box& bounds() const { return pyramid_->bounds(); }
  /// The side that most of it faces, for a first view. 0 if the root cannot be read.
  [[nodiscard]] double yaw_rad() const;
  /// `asked`, or if that is Automatic, Photograph where the root has photographs on it.
  [[nodiscard]] Lighting lighting(Lighting asked) const;
  void set_error_px(double error_px) { pager_.set_error_px(error_px); }
  [[nodiscard]] PagerStatus status() const { return pager_.status(); }
  /// False while tiles are on their way or are exchanged.
  [[nodiscard]] bool still() const { return !pager_.fading() && pager_.status().wanted_tiles == 0; }

 private:
  struct Tile {
    Tile(const Gl& gl, const Mesh& mesh) : sorted(mesh), geometry(gl, sorted.arrays()), surfaces(gl, mesh) {}
    SortedMesh sorted;
    Geometry geometry;
    Surfaces surfaces;
  };
  void show(std::span<const NodeId> drawn);

  const Gl& gl_;
  std::shared_ptr<const TilePyramid> pyramid_;
  TilePager pager_;
  std::map<NodeId, std::unique_ptr<Tile>> tiles_;
  std::vector<Item> items_;
};

}  // namespace lodestone::render
