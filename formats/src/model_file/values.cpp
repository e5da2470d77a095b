// SPDX-License-Identifier: MIT
// Based on: Meyer et al. 2010, "On floating-point normal vectors" (octahedral normals).
#include "values.h"

#include <algorithm>
#include <cstring>

namespace lodestone::model_file {
namespace {

// The grid keeps four texels of a texture 1024 wide, one of 4096: finer than any filter shows.
constexpr double finest_uv_step = 1.0 / 4096.0;

double sign_of(double x) noexcept { return x < 0.0 ? -1.0 : 1.0; }

void normal_to_grid(const float* n, std::uint32_t bits, std::uint32_t* words) noexcept {
  const double sum =
      std::abs(static_cast<double>(n[0])) + std::abs(static_cast<double>(n[1])) + std::abs(static_cast<double>(n[2]));
  double u = sum > 0.0 ? n[0] / sum : 0.0;
  double v = sum > 0.0 ? n[1] / sum : 0.0;
  if (n[2] < 0.0F) {
    const double folded = (1.0 - std::abs(v)) * sign_of(u);
    v = (1.0 - std::abs(u)) * sign_of(v);
    u = folded;
  }
  const double top = static_cast<double>((1U << bits) - 1);
  words[0] = static_cast<std::uint32_t>(std::floor(limited(u * 0.5 + 0.5, 0.0, 1.0) * top + 0.5));
  words[1] = static_cast<std::uint32_t>(std::floor(limited(v * 0.5 + 0.5, 0.0, 1.0) * top + 0.5));
}

void normal_from_grid(const std::uint32_t* words, std::uint32_t bits, float* n) noexcept {
  const double top = static_cast<double>((1U << bits) - 1);
  double x = static_cast<std::int32_t>(words[0]) / top * 2.0 - 1.0;
  double y = static_cast<std::int32_t>(words[1]) / top * 2.0 - 1.0;
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z < 0.0) {
    const double folded = (1.0 - std::abs(y)) * sign_of(x);
    y = (1.0 - std::abs(x)) * sign_of(y);
    x = folded;
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  n[0] = static_cast<float>(x / length);
  n[1] = static_cast<float>(y / length);
  n[2] = static_cast<float>(z / length);
}

}  // namespace

ValueLayout layout_of(const VertexArrays& vertices, std::uint32_t normal_words) {
  ValueLayout layout{
      .normals = !vertices.normals.empty(), .uvs = !vertices.uvs.empty(), .colors = !vertices.colors.empty()};
  layout.normal_words = layout.normals ? normal_words : 0;
  return layout;
}

void get_floats(const VertexArrays& vertices, VertexId slot, std::uint32_t* words) noexcept {
  const auto copy = [&](const auto& array) {
    if (array.empty()) return;
    std::memcpy(words, &array[slot], sizeof(array[slot]));
    words += sizeof(array[slot]) / 4;
  };
  copy(vertices.positions);
  copy(vertices.normals);
  copy(vertices.uvs);
  copy(vertices.colors);
}

Grid choose_grid(const Box& box, const VertexArrays& vertices, std::uint32_t bits) {
  Grid grid{.bits = bits};
  const glm::dvec3 size = box.size();
  const double side = std::max({size.x, size.y, size.z});
  grid.corner = box.empty() ? glm::dvec3{0.0} : box.min;
  grid.step_m = side > 0.0 ? side / static_cast<double>((1U << bits) - 1) : 1.0;
  grid.normal_bits = std::clamp(bits, 8U, 12U);
  double largest = 0.0;
  for (const auto& uv : vertices.uvs) largest = std::max({largest, std::abs(double{uv.x}), std::abs(double{uv.y})});
  grid.uv_step = std::max(finest_uv_step, largest / 1.0e9);
  return grid;
}

void to_grid(const Grid& grid, const ValueLayout& layout, const std::uint32_t* floats, std::uint32_t* words) noexcept {
  for (int i = 0; i < 3; ++i) {
    words[i] = GridSpace::nearest((double{std::bit_cast<float>(floats[i])} - grid.corner[i]) / grid.step_m);
  }
  const std::uint32_t* from = floats + 3;
  if (layout.normals) {
    float n[3];
    std::memcpy(n, from, sizeof(n));
    normal_to_grid(n, grid.normal_bits, words + layout.normal());
    from += 3;
  }
  if (layout.uvs) {
    for (std::uint32_t i = 0; i < 2; ++i) {
      words[layout.uv() + i] = GridSpace::nearest(double{std::bit_cast<float>(from[i])} / grid.uv_step);
    }
    from += 2;
  }
  if (layout.colors) words[layout.color()] = *from;
}

void from_grid(const Grid& grid, const ValueLayout& layout, const std::uint32_t* words,
               std::uint32_t* floats) noexcept {
  const glm::vec3 point = grid_point(grid, {words[0], words[1], words[2]});
  for (int i = 0; i < 3; ++i) floats[i] = std::bit_cast<std::uint32_t>(point[i]);
  std::uint32_t* to = floats + 3;
  if (layout.normals) {
    float n[3];
    normal_from_grid(words + layout.normal(), grid.normal_bits, n);
    std::memcpy(to, n, sizeof(n));
    to += 3;
  }
  if (layout.uvs) {
    for (std::uint32_t i = 0; i < 2; ++i) {
      to[i] = FloatSpace::nearest(static_cast<std::int32_t>(words[layout.uv() + i]) * grid.uv_step);
    }
    to += 2;
  }
  if (layout.colors) *to = words[layout.color()];
}

}  // namespace lodestone::model_file
