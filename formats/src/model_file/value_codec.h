// SPDX-License-Identifier: MIT
// One vertex value to and from columns. `Io` is a ColumnSink or a ColumnSource: its code(column, value) returns the
// value it wrote, or ignores its argument and returns the one it read, so that writing and reading are the same text.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "stack_codec.h"
#include "values.h"

namespace lodestone::model_file {

struct ColumnSink {
  static constexpr bool writing = true;
  WrittenColumns* columns = nullptr;
  std::uint32_t code(std::uint32_t column, std::uint32_t value) {
    (*columns)[column].put(value);
    return value;
  }
};

struct ColumnSource {
  static constexpr bool writing = false;
  ReadColumns* columns = nullptr;
  std::uint32_t code(std::uint32_t column, std::uint32_t /*value*/) noexcept { return (*columns)[column].get(); }
};

template <class Io>
std::uint32_t code_difference(Io& io, std::uint32_t column, std::uint32_t value, std::uint32_t predicted) {
  return predicted + unzigzag(io.code(column, zigzag(value - predicted)));
}

// What is expected of a value before it is known.
struct Guess {
  glm::dvec3 position{0.0};                   // in the numbers of the space: metres or steps
  glm::dvec3 across{0.0};                     // normal of the plane it should lie on, any length; 0 = unknown
  glm::dvec3 normal{0.0};                     // float space: direction, any length
  std::array<std::uint32_t, 2> octahedral{};  // grid
  glm::dvec2 uv{0.0};
  std::uint32_t color = 0;
};

// The axis of the largest component; the first of equals.
[[nodiscard]] inline int main_axis(const glm::dvec3& v) noexcept {
  const double x = std::abs(v.x);
  const double y = std::abs(v.y);
  const double z = std::abs(v.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

template <class Space, class Io>
class ValueCodec {
 public:
  explicit ValueCodec(const ValueLayout& layout) : layout_(layout) {}

  // `group`: NewValues, MovedValues or EditValues. Two coordinates along the plane come first; they tell where on the
  // plane the third should be. Inlined so that the words stay in registers.
  [[gnu::always_inline]] PositionWords code_position(Io& io, std::uint32_t group, const Guess& guess,
                                                     const std::uint32_t* words) const {
    const int depth = main_axis(guess.across);
    const int i = depth == 2 ? 0 : depth + 1;
    const int j = depth == 0 ? 2 : depth - 1;
    const std::uint32_t first = code_word(io, group, words[i], guess.position[i]);
    const std::uint32_t second = code_word(io, group + 1, words[j], guess.position[j]);
    double slope = 0.0;
    if (guess.across[depth] != 0.0) {
      slope = (guess.across[i] * (Space::number(first) - guess.position[i]) +
               guess.across[j] * (Space::number(second) - guess.position[j])) /
              guess.across[depth];
    }
    const std::uint32_t third = code_word(io, group + 2, words[depth], guess.position[depth] - slope);
    return {depth == 0   ? third
            : depth == 1 ? second
                         : first,
            depth == 1   ? third
            : depth == 2 ? second
                         : first,
            depth == 2   ? third
            : depth == 0 ? second
                         : first};
  }

  // Everything else, in place.
  void code_attributes(Io& io, std::uint32_t group, const Guess& guess, std::uint32_t* words) const {
    if (layout_.normals) code_normal(io, group + 3, guess, words + layout_.normal());
    if (layout_.uvs) {
      for (int i = 0; i < 2; ++i) {
        std::uint32_t& word = words[layout_.uv() + i];
        word = code_word(io, group + 6 + i, word, guess.uv[i]);
      }
    }
    if (layout_.colors) code_color(io, group + 8, guess, words[layout_.color()]);
  }

 private:
  static std::uint32_t code_word(Io& io, std::uint32_t column, std::uint32_t word, double guess) {
    const std::uint32_t predicted = Space::nearest(guess);
    return Space::restore(io.code(column, Space::residual(word, predicted)), predicted);
  }

  // The longest component of a unit vector follows from the two others up to rounding.
  void code_normal(Io& io, std::uint32_t column, const Guess& guess, std::uint32_t* words) const {
    if (layout_.normal_words == 2) {
      for (int i = 0; i < 2; ++i) {
        words[i] = code_word(io, column + i, words[i], static_cast<std::int32_t>(guess.octahedral[i]));
      }
      return;
    }
    const int depth = main_axis(guess.normal);
    const int i = depth == 2 ? 0 : depth + 1;
    const int j = depth == 0 ? 2 : depth - 1;
    const double square =
        guess.normal.x * guess.normal.x + guess.normal.y * guess.normal.y + guess.normal.z * guess.normal.z;
    const double length = square > 0.0 ? std::sqrt(square) : 1.0;
    words[i] = code_word(io, column, words[i], guess.normal[i] / length);
    words[j] = code_word(io, column + 1, words[j], guess.normal[j] / length);
    const double x = Space::number(words[i]);
    const double y = Space::number(words[j]);
    const double rest = 1.0 - x * x - y * y;
    const double longest = rest > 0.0 ? std::sqrt(rest) : 0.0;
    words[depth] = code_word(io, column + 2, words[depth], guess.normal[depth] < 0.0 ? -longest : longest);
  }

  static void code_color(Io& io, std::uint32_t column, const Guess& guess, std::uint32_t& word) {
    std::uint32_t out = 0;
    for (std::uint32_t shift = 0; shift < 32; shift += 8) {
      const auto predicted = static_cast<std::uint8_t>(guess.color >> shift);
      const auto difference = static_cast<std::int8_t>(static_cast<std::uint8_t>(word >> shift) - predicted);
      const std::uint32_t coded = io.code(column, zigzag(static_cast<std::uint32_t>(std::int32_t{difference})));
      out |= ((predicted + unzigzag(coded)) & 0xFFU) << shift;
    }
    word = out;
  }

  ValueLayout layout_;
};

}  // namespace lodestone::model_file
