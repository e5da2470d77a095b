// SPDX-License-Identifier: MIT
// Line plots as pictures: axes with round ticks, lines, dots, shaded areas and a legend.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include <lodestone/image.h>

namespace lodestone::render {

enum class LegendCorner : std::uint8_t { TopRight, BottomLeft };

enum class Axis : std::uint8_t { Linear, Logarithmic };

/// One curve. Points that are not finite, or not above 0 on a logarithmic axis, are left out.
struct Curve {
  enum class Style : std::uint8_t {
    Line,
    Dots,
    Area,  ///< filled between the points and `floor`, which has as many
  };
  std::string name;  ///< in the legend; empty = not listed
  Style style = Style::Line;
  glm::u8vec3 color{31, 119, 180};
  std::vector<glm::dvec2> points;
  std::vector<double> floor{};
};

struct Plot {
  std::string title;
  std::string x_title;
  std::string y_title;
  Axis x_axis = Axis::Linear;
  Axis y_axis = Axis::Linear;
  LegendCorner legend = LegendCorner::TopRight;
  std::vector<Curve> curves;  ///< drawn in order
  std::uint32_t width_px = 900;
  std::uint32_t height_px = 560;
};

/// The colours that curves should be given, in order; well apart for the colour-blind too (Okabe and Ito 2008).
[[nodiscard]] glm::u8vec3 curve_color(std::size_t index) noexcept;

/// Axes span all points. RGB.
[[nodiscard]] Image draw_plot(const Plot& plot);

}  // namespace lodestone::render
