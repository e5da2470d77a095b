// SPDX-License-Identifier: MIT
#include "plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "caption.h"

namespace lodestone::render {
namespace {

constexpr std::uint32_t left_px = 84;
constexpr std::uint32_t right_px = 24;
constexpr std::uint32_t top_px = 34;
constexpr std::uint32_t bottom_px = 54;
constexpr std::uint32_t letter_px = 7;  // of the caption's font
constexpr glm::u8vec3 grid_color{226, 226, 226};
constexpr glm::u8vec3 frame_color{120, 120, 120};

struct Scale {
  Axis axis = Axis::Linear;
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  [[nodiscard]] bool takes(double v) const { return std::isfinite(v) && (axis == Axis::Linear || v > 0.0); }
  [[nodiscard]] double of(double v) const { return axis == Axis::Linear ? v : std::log10(v); }
  void add(double v) {
    if (!takes(v)) return;
    low = std::min(low, of(v));
    high = std::max(high, of(v));
  }
  // 0..1 along the axis.
  [[nodiscard]] double place(double v) const { return (of(v) - low) / (high - low); }
  // Gives an axis without extent one, and a little room above.
  void settle() {
    if (!(low <= high)) low = high = 0.0;
    if (axis == Axis::Linear) low = std::min(low, 0.0);
    if (high - low < 1e-12) high = low + 1.0;
    if (axis == Axis::Linear) high += 0.04 * (high - low);
  }
  [[nodiscard]] std::vector<double> ticks() const;
};

// Values at round places: 1, 2, 5 times a power of ten.
std::vector<double> Scale::ticks() const {
  std::vector<double> ticks;
  if (axis == Axis::Logarithmic) {
    const bool few_decades = high - low < 2.5;
    for (double decade = std::floor(low); decade <= high; decade += 1.0) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double v = digit * std::pow(10.0, decade);
        if ((digit == 1.0 || few_decades) && of(v) >= low - 1e-9 && of(v) <= high + 1e-9) ticks.push_back(v);
      }
    }
    return ticks;
  }
  const double rough = (high - low) / 6.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double digit = rough / power;
  const double step = power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
  for (double i = std::ceil(low / step - 1e-9); i * step <= high; i += 1.0) ticks.push_back(i * step);
  return ticks;
}

std::string tick_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", std::abs(value) < 1e-12 ? 0.0 : value);
  return text;
}

class Canvas {
 public:
  explicit Canvas(const Plot& plot) : plot_(plot) {
    image_ = Image{plot.width_px, plot.height_px, 3, {}};
    image_.pixels.assign(std::size_t{3} * plot.width_px * plot.height_px, 255);
    x_.axis = plot.x_axis;
    y_.axis = plot.y_axis;
    for (const Curve& curve : plot.curves) {
      for (const glm::dvec2& p : curve.points) {
        x_.add(p.x);
        y_.add(p.y);
      }
      for (const double v : curve.floor) y_.add(v);
    }
    x_.settle();
    y_.settle();
  }

  [[nodiscard]] Image draw() {
    draw_grid();
    for (const Curve& curve : plot_.curves) draw_curve(curve);
    draw_frame();
    draw_legend();
    return std::move(image_);
  }

 private:
  [[nodiscard]] double right() const { return static_cast<double>(plot_.width_px - right_px); }
  [[nodiscard]] double bottom() const { return static_cast<double>(plot_.height_px - bottom_px); }
  [[nodiscard]] std::optional<glm::dvec2> place(const glm::dvec2& p) const {
    if (!x_.takes(p.x) || !y_.takes(p.y)) return std::nullopt;
    return glm::dvec2{left_px + x_.place(p.x) * (right() - left_px), bottom() - y_.place(p.y) * (bottom() - top_px)};
  }

  void blend(int x, int y, const glm::u8vec3& color, double share) {
    if (x < 0 || y < 0 || x >= static_cast<int>(image_.width) || y >= static_cast<int>(image_.height)) return;
    std::uint8_t* pixel = image_.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    for (int c = 0; c < 3; ++c) {
      pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + (color[c] - pixel[c]) * share));
    }
  }

  // Smooth: a pixel is covered as much as its middle lies within the width.
  void line(const glm::dvec2& a, const glm::dvec2& b, const glm::u8vec3& color, double width_px) {
    const double reach = 0.5 * width_px + 0.5;
    const glm::dvec2 along = b - a;
    const double square = std::max(glm::dot(along, along), 1e-12);
    for (int y = static_cast<int>(std::min(a.y, b.y) - reach); y <= static_cast<int>(std::max(a.y, b.y) + reach); ++y) {
      for (int x = static_cast<int>(std::min(a.x, b.x) - reach); x <= static_cast<int>(std::max(a.x, b.x) + reach);
           ++x) {
        const glm::dvec2 p{x + 0.5, y + 0.5};
        const double t = std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0);
        const double distance = glm::length(p - (a + along * t));
        if (distance < reach) blend(x, y, color, std::min(1.0, reach - distance));
      }
    }
  }

  void draw_area(const Curve& curve) {
    for (std::size_t i = 0; i + 1 < curve.points.size() && i + 1 < curve.floor.size(); ++i) {
      const auto a = place(curve.points[i]);
      const auto b = place(curve.points[i + 1]);
      const auto a_floor = place({curve.points[i].x, curve.floor[i]});
      const auto b_floor = place({curve.points[i + 1].x, curve.floor[i + 1]});
      if (!a || !b || !a_floor || !b_floor) continue;
      // Columns whose middle lies between the two points, so that neighbours do not overlap.
      for (int x = static_cast<int>(std::ceil(a->x - 0.5)); x + 0.5 < b->x; ++x) {
        const double t = (x + 0.5 - a->x) / std::max(b->x - a->x, 1e-9);
        const double from = a->y + t * (b->y - a->y);
        const double to = a_floor->y + t * (b_floor->y - a_floor->y);
        for (int y = static_cast<int>(std::min(from, to)); y < static_cast<int>(std::max(from, to)); ++y) {
          blend(x, y, curve.color, 0.28);
        }
      }
    }
  }

  void draw_curve(const Curve& curve) {
    if (curve.style == Curve::Style::Area) return draw_area(curve);
    std::optional<glm::dvec2> before;
    for (const glm::dvec2& point : curve.points) {
      const auto at = place(point);
      if (curve.style == Curve::Style::Dots && at) line(*at, *at, curve.color, 4.0);
      if (curve.style == Curve::Style::Line && at && before) line(*before, *at, curve.color, 1.8);
      before = at;
    }
  }

  void draw_grid() {
    for (const double tick : x_.ticks()) {
      const double x = left_px + x_.place(tick) * (right() - left_px);
      line({x, top_px}, {x, bottom()}, grid_color, 1.0);
      const std::string text = tick_text(tick);
      write(x - 0.5 * static_cast<double>(text.size() * letter_px), bottom() + 6.0, text);
    }
    for (const double tick : y_.ticks()) {
      const double y = bottom() - y_.place(tick) * (bottom() - top_px);
      line({left_px, y}, {right(), y}, grid_color, 1.0);
      const std::string text = tick_text(tick);
      write(left_px - 8.0 - static_cast<double>(text.size() * letter_px), y - 7.0, text);
    }
  }

  void draw_frame() {
    line({left_px, top_px}, {left_px, bottom()}, frame_color, 1.0);
    line({left_px, bottom()}, {right(), bottom()}, frame_color, 1.0);
    write(left_px, 10.0, plot_.y_title + (plot_.title.empty() ? "" : "    " + plot_.title));
    write(right() - static_cast<double>(plot_.x_title.size() * letter_px), bottom() + 28.0, plot_.x_title);
  }

  void draw_legend() {
    constexpr double row_px = 18.0;
    std::size_t longest = 0;
    std::size_t rows = 0;
    for (const Curve& curve : plot_.curves) {
      longest = std::max(longest, curve.name.size());
      if (!curve.name.empty()) ++rows;
    }
    const double text_px = static_cast<double>(longest * letter_px) + 12.0;
    const bool low = plot_.legend == LegendCorner::BottomLeft;
    const double x = low ? left_px + 46.0 : right() - text_px;
    double y = low ? bottom() - 10.0 - row_px * static_cast<double>(rows) : top_px + 10.0;
    for (const Curve& curve : plot_.curves) {
      if (curve.name.empty()) continue;
      const double middle = y + 7.0;
      line({x - 34.0, middle}, {x + text_px, middle}, glm::u8vec3{255}, 17.0);  // curves do not run through the text
      if (curve.style == Curve::Style::Dots) line({x - 20.0, middle}, {x - 20.0, middle}, curve.color, 5.0);
      if (curve.style == Curve::Style::Line) line({x - 32.0, middle}, {x - 10.0, middle}, curve.color, 2.0);
      if (curve.style == Curve::Style::Area) line({x - 30.0, middle}, {x - 12.0, middle}, curve.color, 8.0);
      write(x, y, curve.name);
      y += row_px;
    }
  }

  void write(double x, double y, const std::string& text) {
    draw_caption(image_, static_cast<std::uint32_t>(std::max(0.0, x)), static_cast<std::uint32_t>(std::max(0.0, y)),
                 image_.width, text);
  }

  const Plot& plot_;
  Image image_;
  Scale x_;
  Scale y_;
};

}  // namespace

glm::u8vec3 curve_color(std::size_t index) noexcept {
  constexpr std::array<glm::u8vec3, 8> colors{
      glm::u8vec3{213, 94, 0},   glm::u8vec3{0, 114, 178}, glm::u8vec3{0, 158, 115}, glm::u8vec3{204, 121, 167},
      glm::u8vec3{86, 180, 233}, glm::u8vec3{230, 159, 0}, glm::u8vec3{90, 90, 90},  glm::u8vec3{128, 60, 160}};
  return colors[index % colors.size()];
}

Image draw_plot(const Plot& plot) { return Canvas{plot}.draw(); }

}  // namespace lodestone::render
