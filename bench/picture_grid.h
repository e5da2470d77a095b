// SPDX-License-Identifier: MIT
// Pictures of meshes side by side, all seen from where one of them just fills the picture.
#pragma once

#include <algorithm>
#include <cstdio>

#include "viewer/headless/headless.h"

namespace bench {

class PictureGrid {
 public:
  PictureGrid(std::size_t columns, std::size_t rows, const lodestone::render::RenderOptions& options)
      : options_(options) {
    grid_.width = static_cast<std::uint32_t>(columns) * options.width_px;
    grid_.height = static_cast<std::uint32_t>(rows) * options.height_px;
    grid_.channels = 3;
    grid_.pixels.assign(std::size_t{3} * grid_.width * grid_.height, 255);
  }

  void draw(std::size_t column, std::size_t row, const lodestone::Mesh& mesh, const lodestone::Mesh& framed) {
    lodestone::render::RenderOptions options = options_;
    if (const auto view = lodestone::render::view_of_mesh(framed, options)) {
      options.camera.eye_m = framed.origin + view->eye;
      options.camera.target_m = framed.origin + view->eye + view->forward;
    }
    const auto picture = lodestone::render::render_mesh(mesh, options);
    if (!picture) {
      std::fprintf(stderr, "%s\n", lodestone::to_line(picture.error()).c_str());
      return;
    }
    for (std::uint32_t y = 0; y < options.height_px; ++y) {
      std::copy_n(picture->image.at(0, y), std::size_t{3} * options.width_px,
                  grid_.at(static_cast<std::uint32_t>(column) * options.width_px,
                           static_cast<std::uint32_t>(row) * options.height_px + y));
    }
  }

  [[nodiscard]] const lodestone::Image& image() const { return grid_; }

 private:
  lodestone::render::RenderOptions options_;
  lodestone::Image grid_;
};

}  // namespace bench
