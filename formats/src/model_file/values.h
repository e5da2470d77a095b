// SPDX-License-Identifier: MIT
// Vertex values as the file keeps them: words, each predicted from words already known and stored as a difference.
//
// Two spaces. Float: a word is the bits of a float, lossless; differences are taken between floats put in order as
// integers (Lindstrom and Isenburg 2006). Grid: a word is a whole number of steps.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <lodestone/mesh.h>

#include "columns.h"

namespace lodestone::model_file {

// Steps of the grid that --quantize snaps to.
struct Grid {
  std::uint32_t bits = 0;  // per coordinate of the model's box; 0 = lossless, no grid
  glm::dvec3 corner{0.0};  // metres, relative to the origin
  double step_m = 0.0;
  std::uint32_t normal_bits = 0;  // per octahedral coordinate
  double uv_step = 0.0;
};

// Which attributes a vertex has, and where their words lie in a value.
struct ValueLayout {
  bool normals = false, uvs = false, colors = false;
  std::uint32_t normal_words = 0;  // 3 floats, or 2 octahedral coordinates

  [[nodiscard]] std::uint32_t normal() const noexcept { return 3; }
  [[nodiscard]] std::uint32_t uv() const noexcept { return 3 + normal_words; }
  [[nodiscard]] std::uint32_t color() const noexcept { return uv() + (uvs ? 2U : 0U); }
  [[nodiscard]] std::uint32_t words() const noexcept { return color() + (colors ? 1U : 0U); }
};
inline constexpr std::uint32_t max_value_words = 9;

// `normal_words`: 3 in float space, 2 on a grid.
[[nodiscard]] ValueLayout layout_of(const VertexArrays& vertices, std::uint32_t normal_words);

// The words of a position, kept apart from the others because what was stored word by word a moment ago is slow to load
// again in one piece, and a struct of three copied as bytes would be.
struct PositionWords {
  std::uint32_t x = 0, y = 0, z = 0;
  void store(std::uint32_t* words) const noexcept {
    words[0] = x;
    words[1] = y;
    words[2] = z;
  }
};

// A value as floats (the words of ModelData::value_xor).
void get_floats(const VertexArrays& vertices, VertexId slot, std::uint32_t* words) noexcept;
// All but the position of such a value.
inline void set_attributes(VertexArrays& vertices, const ValueLayout& floats, VertexId slot,
                           const std::uint32_t* words) noexcept {
  if (floats.normals) std::memcpy(&vertices.normals[slot], words + floats.normal(), 12);
  if (floats.uvs) std::memcpy(&vertices.uvs[slot], words + floats.uv(), 8);
  if (floats.colors) std::memcpy(&vertices.colors[slot], words + floats.color(), 4);
}

// Grid words of a value given as float words, and back. `layout` is that of the grid words.
void to_grid(const Grid& grid, const ValueLayout& layout, const std::uint32_t* floats, std::uint32_t* words) noexcept;
[[nodiscard]] glm::vec3 grid_point(const Grid& grid, PositionWords words) noexcept;
void from_grid(const Grid& grid, const ValueLayout& layout, const std::uint32_t* words, std::uint32_t* floats) noexcept;

// The grid of a model: `bits` per coordinate of the longest side of its box.
[[nodiscard]] Grid choose_grid(const Box& box, const VertexArrays& vertices, std::uint32_t bits);

// NaN gives `low`.
[[nodiscard]] inline double limited(double x, double low, double high) noexcept {
  return x > low ? (x < high ? x : high) : low;
}

struct FloatSpace {
  static constexpr bool on_grid = false;
  [[nodiscard]] static double number(std::uint32_t word) noexcept { return std::bit_cast<float>(word); }
  [[nodiscard]] static std::uint32_t nearest(double x) noexcept {
    return std::bit_cast<std::uint32_t>(static_cast<float>(limited(x, -3.0e38, 3.0e38)));
  }
  // Floats in ascending order become ascending integers.
  [[nodiscard]] static std::uint32_t ordered(std::uint32_t word) noexcept {
    return (word >> 31) != 0 ? ~word : word | 0x80000000U;
  }
  [[nodiscard]] static std::uint32_t disordered(std::uint32_t word) noexcept {
    return (word >> 31) != 0 ? word & 0x7FFFFFFFU : ~word;
  }
  [[nodiscard]] static std::uint32_t residual(std::uint32_t word, std::uint32_t predicted) noexcept {
    return zigzag(ordered(word) - ordered(predicted));
  }
  [[nodiscard]] static std::uint32_t restore(std::uint32_t residual, std::uint32_t predicted) noexcept {
    return disordered(ordered(predicted) + unzigzag(residual));
  }
};

struct GridSpace {
  static constexpr bool on_grid = true;
  [[nodiscard]] static double number(std::uint32_t word) noexcept { return static_cast<std::int32_t>(word); }
  [[nodiscard]] static std::uint32_t nearest(double x) noexcept {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(limited(x, -2.0e9, 2.0e9) + 0.5)));
  }
  [[nodiscard]] static std::uint32_t residual(std::uint32_t word, std::uint32_t predicted) noexcept {
    return zigzag(word - predicted);
  }
  [[nodiscard]] static std::uint32_t restore(std::uint32_t residual, std::uint32_t predicted) noexcept {
    return predicted + unzigzag(residual);
  }
};

inline glm::vec3 grid_point(const Grid& grid, PositionWords words) noexcept {
  const auto coordinate = [&grid](int axis, std::uint32_t word) {
    const double x = grid.corner[axis] + static_cast<std::int32_t>(word) * grid.step_m;
    return std::bit_cast<float>(FloatSpace::nearest(x));
  };
  return {coordinate(0, words.x), coordinate(1, words.y), coordinate(2, words.z)};
}

}  // namespace lodestone::model_file
