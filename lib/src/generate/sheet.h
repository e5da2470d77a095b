// SPDX-License-Identifier: MIT
// Outcrop and terrain alike: one surface over a rectangle of parameters, cut into a grid of uv charts that are laid out
// in texture images.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lodestone/context.h>
#include <lodestone/generate.h>
#include <lodestone/mesh.h>

namespace lodestone::generate {

// A rectangle of grid cells with its place in an image.
struct Chart {
  std::uint32_t column_begin = 0, column_end = 0;  // in cells; vertices run from begin to end inclusive
  std::uint32_t row_begin = 0, row_end = 0;
  std::uint32_t texture = 0;
  double x_px = 0, y_px = 0, width_px = 0, height_px = 0;  // in the image, from its bottom-left, gutter excluded
  double gutter_px = 0;
};

struct SheetLayout {
  std::uint32_t columns = 0, rows = 0;  // cells of the whole grid
  std::uint32_t texture_count = 0;
  std::uint32_t texture_size_px = 0;
  std::vector<Chart> charts;  // grouped by texture
};

// What a kind of sheet brings: its size, its shape and its looks. Parameters are metres along the surface.
struct SheetKind {
  double width_m = 0, height_m = 0;
  std::uint32_t natural_triangles = 0, natural_textures = 0;
  std::string texture_name, semantic_class;
  std::function<glm::dvec3(double s_m, double t_m, double cell_m)> position;
};

[[nodiscard]] Status check_options(const GenerateOptions& options);
// What every generator ends with: the mesh, with a warning if fewer triangles were asked than its kind takes, or the
// error that it was cancelled.
[[nodiscard]] Result<Mesh> finish(Mesh mesh, const GenerateOptions& options, const Context& context);
[[nodiscard]] SheetLayout lay_out(const GenerateOptions& options, const SheetKind& kind);
[[nodiscard]] Mesh make_sheet(const SheetLayout& layout, const SheetKind& kind, const glm::dvec3& origin,
                              const Context& context);

// Where an image's texels lie on the surface. Beyond the charts (in the gutters) the neighbourhood goes on, so that
// filtering across a seam meets the same colours on both sides.
struct TexelWindow {
  std::uint32_t x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;  // image columns and rows, from the top-left
  double s0_m = 0, t0_m = 0;                                     // surface place of the centre of (x_begin, y_begin)
  double ds_m = 0, dt_m = 0;                                     // step per column and per row (dt < 0: rows run down)
};
[[nodiscard]] std::vector<TexelWindow> texel_windows(const SheetLayout& layout, const SheetKind& kind,
                                                     std::uint32_t texture);

}  // namespace lodestone::generate
