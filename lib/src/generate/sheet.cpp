// SPDX-License-Identifier: MIT
#include "generate/sheet.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace lodestone::generate {

namespace {

constexpr std::uint32_t max_triangles = 100'000'000;
constexpr std::uint32_t max_textures = 10'000;

// Texels left around a chart, so that filtering never reaches its neighbour in the image.
double gutter_px(double cell_px) { return cell_px >= 64.0 ? 4.0 : (cell_px >= 16.0 ? 2.0 : 0.5); }

std::uint32_t share(std::uint32_t total, std::uint32_t i, std::uint32_t count) {
  return static_cast<std::uint32_t>(std::uint64_t{total} * i / count);
}

// Charts of texture k are neighbours in the chart grid; inside the image they fill a square grid of cells.
void place_in_images(SheetLayout& layout) {
  const auto chart_count = static_cast<std::uint32_t>(layout.charts.size());
  for (std::uint32_t k = 0; k < layout.texture_count; ++k) {
    const std::uint32_t begin = share(chart_count, k, layout.texture_count);
    const std::uint32_t end = share(chart_count, k + 1, layout.texture_count);
    const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(end - begin))));
    const std::uint32_t cell_px = layout.texture_size_px / std::max(1U, side);
    const double cell = cell_px;
    const double gutter = gutter_px(cell);
    for (std::uint32_t i = begin; i < end; ++i) {
      Chart& chart = layout.charts[i];
      chart.texture = k;
      chart.x_px = cell * ((i - begin) % side) + gutter;
      const std::uint32_t row = (i - begin) / side;
      chart.y_px = cell * row + gutter;
      chart.width_px = cell - 2.0 * gutter;
      chart.height_px = chart.width_px;
      chart.gutter_px = gutter;
    }
  }
}

// From the neighbours along both directions of the grid; on its border from one side.
glm::vec3 grid_normal(const std::vector<glm::vec3>& grid, std::uint32_t width, std::uint32_t height, std::uint32_t x,
                      std::uint32_t y) {
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return glm::dvec3{grid[std::size_t{j} * width + i]}; };
  const glm::dvec3 along = at(std::min(x + 1, width - 1), y) - at(x == 0 ? 0 : x - 1, y);
  const glm::dvec3 up = at(x, std::min(y + 1, height - 1)) - at(x, y == 0 ? 0 : y - 1);
  const glm::dvec3 normal = glm::cross(along, up);
  const double length = glm::length(normal);
  return length > 0.0 ? glm::vec3{normal / length} : glm::vec3{0.0F, 0.0F, 1.0F};
}

struct ChartStart {
  std::size_t vertex = 0;
  std::size_t face = 0;
};

void fill_chart(const SheetLayout& layout, const Chart& chart, const ChartStart& start,
                const std::vector<glm::vec3>& grid, Mesh& mesh) {
  const std::uint32_t width = layout.columns + 1;
  const std::uint32_t across = chart.column_end - chart.column_begin;
  const std::uint32_t up = chart.row_end - chart.row_begin;
  std::size_t v = start.vertex;
  for (std::uint32_t j = 0; j <= up; ++j) {
    for (std::uint32_t i = 0; i <= across; ++i, ++v) {
      const std::uint32_t x = chart.column_begin + i;
      const std::uint32_t y = chart.row_begin + j;
      mesh.vertices.positions[v] = glm::vec3{grid[std::size_t{y} * width + x]};
      mesh.vertices.normals[v] = grid_normal(grid, width, layout.rows + 1, x, y);
      mesh.vertices.uvs[v] = {(chart.x_px + chart.width_px * i / across) / layout.texture_size_px,
                              (chart.y_px + chart.height_px * j / up) / layout.texture_size_px};
    }
  }
  std::size_t f = start.face;
  for (std::uint32_t j = 0; j < up; ++j) {
    for (std::uint32_t i = 0; i < across; ++i, f += 2) {
      const auto a = static_cast<VertexId>(start.vertex + std::size_t{j} * (across + 1) + i);
      const VertexId b = a + 1;
      const VertexId c = a + across + 1;
      const VertexId d = c + 1;
      // Diagonals alternate, so that ridges do not run all one way.
      const bool odd = ((chart.column_begin + i + chart.row_begin + j) & 1U) != 0;
      const VertexId corners[6] = {a, b, odd ? c : d, odd ? b : a, d, c};
      std::copy_n(corners, 6, mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * f));
      mesh.face_materials[f] = chart.texture;
      mesh.face_materials[f + 1] = chart.texture;
    }
  }
}

void name_looks(const SheetLayout& layout, const SheetKind& kind, Mesh& mesh) {
  for (std::uint32_t k = 0; k < layout.texture_count; ++k) {
    std::string number = std::to_string(k);
    number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
    Texture texture;
    texture.name = kind.texture_name + "_" + number;
    Material material;
    material.name = texture.name;
    material.texture = k;
    mesh.textures.push_back(std::move(texture));
    mesh.materials.push_back(std::move(material));
  }
  mesh.features.push_back({.id = kind.texture_name, .semantic_class = kind.semantic_class, .parent = none});
  mesh.face_features.assign(mesh.face_materials.size(), 0);
}

}  // namespace

Result<Mesh> finish(Mesh mesh, const GenerateOptions& options, const Context& context) {
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "generation was cancelled", {}};
  const std::uint32_t made = mesh.triangle_count();
  std::vector<Warning> warnings;
  // Sheets of many triangles are off by up to 2 %.
  if (options.triangles > 0 && made > options.triangles + options.triangles / 50 + 1) {
    warnings.push_back({std::to_string(options.triangles) + " triangles are too few to draw this, the plainest has " +
                            std::to_string(made),
                        {}});
  }
  return {std::move(mesh), std::move(warnings)};
}

Status check_options(const GenerateOptions& options) {
  const auto bad = [](const char* message, const char* where) { return Error{ErrorCode::BadArgument, message, where}; };
  if (options.triangles > max_triangles) return bad("at most 100 million triangles can be generated", "triangles");
  if (options.textures > max_textures) return bad("at most 10,000 textures can be generated", "textures");
  if (options.texture_size_px < 16 || options.texture_size_px > 8192) {
    return bad("the texture size must lie between 16 and 8192 pixels", "texture_size_px");
  }
  if (options.charts > max_textures) return bad("at most 10,000 charts can be generated", "charts");
  if (options.charts != 0 && options.charts < options.textures) {
    return bad("there must be at least one chart per texture", "charts");
  }
  return Done{};
}

SheetLayout lay_out(const GenerateOptions& options, const SheetKind& kind) {
  SheetLayout layout;
  layout.texture_size_px = options.texture_size_px;
  const std::uint32_t wanted_textures = options.textures == 0 ? kind.natural_textures : options.textures;
  const std::uint32_t chart_count = std::max(wanted_textures, options.charts);
  layout.texture_count = options.textures == 0 ? std::min(wanted_textures, chart_count) : wanted_textures;
  const double aspect = kind.width_m / kind.height_m;
  const auto chart_rows = std::max(1U, static_cast<std::uint32_t>(std::lround(std::sqrt(chart_count / aspect))));

  const double cells = 0.5 * (options.triangles == 0 ? kind.natural_triangles : options.triangles);
  const std::uint32_t most_in_row = (chart_count + chart_rows - 1) / chart_rows;
  layout.rows = std::max(chart_rows, static_cast<std::uint32_t>(std::lround(std::sqrt(cells / aspect))));
  layout.columns = std::max(most_in_row, static_cast<std::uint32_t>(std::lround(cells / layout.rows)));
  for (std::uint32_t r = 0; r < chart_rows; ++r) {
    const std::uint32_t in_row = share(chart_count, r + 1, chart_rows) - share(chart_count, r, chart_rows);
    for (std::uint32_t c = 0; c < in_row; ++c) {
      Chart chart;
      chart.column_begin = share(layout.columns, c, in_row);
      chart.column_end = share(layout.columns, c + 1, in_row);
      chart.row_begin = share(layout.rows, r, chart_rows);
      chart.row_end = share(layout.rows, r + 1, chart_rows);
      layout.charts.push_back(chart);
    }
  }
  place_in_images(layout);
  return layout;
}

Mesh make_sheet(const SheetLayout& layout, const SheetKind& kind, const glm::dvec3& origin, const Context& context) {
  const std::uint32_t width = layout.columns + 1;
  const std::uint32_t height = layout.rows + 1;
  std::vector<glm::vec3> grid(std::size_t{width} * height, glm::vec3{0.0F});
  const double cell_m = kind.width_m / layout.columns;
  parallel_for_each(height, 8, context, [&](std::size_t j) {
    const double t = kind.height_m * static_cast<double>(j) / layout.rows;
    for (std::uint32_t i = 0; i < width; ++i) {
      grid[j * width + i] = glm::vec3{kind.position(kind.width_m * i / layout.columns, t, cell_m)};
    }
  });

  Mesh mesh;
  mesh.origin = origin;
  mesh.crs = "EPSG:25832";
  std::vector<ChartStart> starts;
  ChartStart next;
  for (const Chart& chart : layout.charts) {
    starts.push_back(next);
    const std::size_t across = chart.column_end - chart.column_begin;
    const std::size_t up = chart.row_end - chart.row_begin;
    next.vertex += (across + 1) * (up + 1);
    next.face += 2 * across * up;
  }
  mesh.vertices.positions.resize(next.vertex, glm::vec3{0.0F});
  mesh.vertices.normals.resize(next.vertex, glm::vec3{0.0F});
  mesh.vertices.uvs.resize(next.vertex, glm::vec2{0.0F});
  mesh.indices.resize(3 * next.face);
  mesh.face_materials.resize(next.face);
  parallel_for_each(layout.charts.size(), 1, context,
                    [&](std::size_t c) { fill_chart(layout, layout.charts[c], starts[c], grid, mesh); });
  name_looks(layout, kind, mesh);
  return mesh;
}

std::vector<TexelWindow> texel_windows(const SheetLayout& layout, const SheetKind& kind, std::uint32_t texture) {
  std::vector<TexelWindow> windows;
  for (const Chart& chart : layout.charts) {
    if (chart.texture != texture) continue;
    const double s_m = kind.width_m * chart.column_begin / layout.columns;
    const double t_m = kind.height_m * chart.row_begin / layout.rows;
    const double top_px = layout.texture_size_px - chart.y_px - chart.height_px;  // rows count from the top
    TexelWindow window;
    window.x_begin = static_cast<std::uint32_t>(std::floor(chart.x_px - chart.gutter_px));
    window.x_end = static_cast<std::uint32_t>(std::floor(chart.x_px + chart.width_px + chart.gutter_px));
    window.y_begin = static_cast<std::uint32_t>(std::floor(top_px - chart.gutter_px));
    window.y_end = static_cast<std::uint32_t>(std::floor(top_px + chart.height_px + chart.gutter_px));
    window.ds_m = kind.width_m * (chart.column_end - chart.column_begin) / layout.columns / chart.width_px;
    window.dt_m = -kind.height_m * (chart.row_end - chart.row_begin) / layout.rows / chart.height_px;
    window.s0_m = s_m + (window.x_begin + 0.5 - chart.x_px) * window.ds_m;
    window.t0_m = t_m + (window.y_begin + 0.5 - top_px - chart.height_px) * window.dt_m;
    windows.push_back(window);
  }
  return windows;
}

}  // namespace lodestone::generate
