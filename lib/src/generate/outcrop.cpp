// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "generate/noise.h"
#include "generate/outcrop_field.h"
#include "generate/pixels.h"
#include "generate/sheet.h"

namespace lodestone {

namespace generate {
namespace {

SheetKind outcrop_kind(const OutcropField& field) {
  SheetKind kind;
  kind.width_m = OutcropField::width_m;
  kind.height_m = OutcropField::profile_m;
  kind.natural_triangles = 200'000;
  kind.natural_textures = 4;
  kind.texture_name = "outcrop";
  kind.semantic_class = "ReliefFeature";
  kind.position = [&field](double s, double t, double cell) { return field.position(s, t, cell); };
  return kind;
}

// Colours by stratigraphic height, finely laminated, looked up per texel.
class StrataColors {
 public:
  explicit StrataColors(const OutcropField& field) {
    const auto& beds = field.beds();
    low_m_ = beds.front().base_m;
    const double high_m = beds.back().base_m + beds.back().thickness_m;
    per_m_ = color_count / (high_m - low_m_);
    colors_.reserve(color_count);
    std::size_t bed = 0;
    for (std::size_t i = 0; i < color_count; ++i) {
      const double s = low_m_ + (static_cast<double>(i) + 0.5) / per_m_;
      while (bed + 1 < beds.size() && beds[bed + 1].base_m <= s) ++bed;
      const double lamina =
          0.10 * noise(field.seed() + 90, s * 9.0, 0.5) + 0.07 * noise(field.seed() + 91, s * 31.0, 0.5);
      const double grading = 0.12 * ((s - beds[bed].base_m) / beds[bed].thickness_m - 0.5);
      colors_.push_back(beds[bed].color * static_cast<float>(1.0 + lamina + grading));
    }
  }
  [[nodiscard]] const glm::vec3& at(float strata_m) const noexcept {
    const double place = (strata_m - low_m_) * per_m_;
    return colors_[static_cast<std::size_t>(std::clamp(place, 0.0, color_count - 1.0))];
  }

 private:
  static constexpr std::size_t color_count = 16384;
  double low_m_ = 0;
  double per_m_ = 0;
  std::vector<glm::vec3> colors_;
};

// What is sampled on a coarse raster and interpolated between.
struct Coarse {
  float strata_m, face, turf, crack, relief_m, light;
};

class RockPainter {
 public:
  explicit RockPainter(const OutcropField& field) : field_(field), strata_(field), table_(field.seed() + 95) {}

  // All but the light, which takes the neighbours.
  [[nodiscard]] Coarse coarse(double s, double t, double step_m) const noexcept {
    const RockSample rock = field_.sample(s, t, step_m);
    return {static_cast<float>(rock.strata_m), rock.face, rock.turf, rock.crack,
            static_cast<float>(rock.relief_m), 1.0F};
  }

  [[nodiscard]] glm::vec3 texel(double s, double t, const Coarse& c) const noexcept {
    const float broad = table_.at(s / 23.0, t / 23.0);
    const float mid = table_.at(s / 5.1 + 0.3, t / 5.1);
    const float fine = table_.at(s / 1.7, t / 1.7 + 0.7);
    const float hair = table_.at(s / 9.0 + 0.11, t / 9.0 + 0.4);
    const float streak = table_.at(s / 7.0 + 0.02 * fine, t / 60.0);
    glm::vec3 color{0.0F};
    if (c.face > 0.0F) {
      color = strata_.at(c.strata_m + 0.05F * mid) * (1.0F + 0.20F * fine + 0.16F * mid);
      color *= 1.0F - 0.38F * glm::smoothstep(0.12F, 0.5F, streak) * glm::smoothstep(-0.3F, 0.3F, broad);  // varnish
      color = glm::mix(color, glm::vec3{0.58F, 0.34F, 0.20F}, 0.30F * glm::smoothstep(0.1F, 0.5F, mid * broad * 4.0F));
      const float crust = glm::smoothstep(0.34F, 0.46F, mid + 0.35F * fine + 0.25F * broad);
      color = glm::mix(color, glm::vec3{0.60F, 0.62F, 0.50F}, 0.55F * crust);  // lichen
      const float orange = glm::smoothstep(0.52F, 0.58F, hair + 0.4F * fine - 0.25F * broad);
      color = glm::mix(color, glm::vec3{0.72F, 0.47F, 0.16F}, 0.6F * orange);
      const float open = 1.0F - glm::smoothstep(0.006F, 0.022F, std::abs(hair + 0.15F * fine));  // hair cracks
      color *= 1.0F - 0.42F * open * glm::smoothstep(-0.2F, 0.2F, broad);
    }
    const glm::vec3 scree = glm::vec3{0.50F, 0.43F, 0.34F} * (1.0F + 0.35F * fine + 0.25F * mid);
    const glm::vec3 grass =
        glm::mix(glm::vec3{0.30F, 0.36F, 0.15F}, glm::vec3{0.50F, 0.46F, 0.24F}, 0.5F + 0.6F * mid) *
        (1.0F + 0.4F * fine);
    color = glm::mix(scree, color, c.face);
    color = glm::mix(color, grass, c.turf * glm::smoothstep(-0.35F, 0.1F, mid + c.turf - 0.6F));
    return color * c.light * (1.0F - 0.62F * c.crack);
  }

 private:
  const OutcropField& field_;
  StrataColors strata_;
  NoiseTable table_;
};

Coarse blend(const Coarse& a, const Coarse& b, float t) noexcept {
  return {a.strata_m + (b.strata_m - a.strata_m) * t,
          a.face + (b.face - a.face) * t,
          a.turf + (b.turf - a.turf) * t,
          a.crack + (b.crack - a.crack) * t,
          a.relief_m + (b.relief_m - a.relief_m) * t,
          a.light + (b.light - a.light) * t};
}

// Knots of the coarse raster, a row at a time from the top of a band down.
class CoarseRows {
 public:
  CoarseRows(const RockPainter& painter, const TexelWindow& window, std::uint32_t step)
      : painter_(painter), window_(window), step_(step), row_(knots() + 1), next_(knots() + 1) {}

  // Makes rows `y` and `y + step` ready.
  void start(std::int64_t y) {
    sample(y - step_, next_);
    advance(y - step_);
    advance(y);
  }
  // Takes the row `step` below `y` into view.
  void advance(std::int64_t y) {
    row_.swap(next_);
    sample(y + step_, next_);
    // Light from the upper left, baked in as in a photograph: slopes of the relief, dimmed in hollows.
    const auto per_m = static_cast<float>(1.0 / (step_ * window_.ds_m));
    for (std::uint32_t k = 0; k + 1 < next_.size(); ++k) {
      const float ds = next_[k + 1].relief_m - next_[k].relief_m;
      const float dt = row_[k].relief_m - next_[k].relief_m;
      const float slope = glm::clamp((0.5F * ds - 0.75F * dt) * per_m, -1.4F, 1.4F);
      next_[k].light = 0.92F + 0.30F * slope + glm::clamp(0.12F * next_[k].relief_m, -0.2F, 0.15F);
    }
  }
  [[nodiscard]] Coarse at(std::uint32_t x, float down) const noexcept {
    const std::uint32_t k = (x - window_.x_begin) / step_;
    const float across = static_cast<float>((x - window_.x_begin) % step_) / static_cast<float>(step_);
    return blend(blend(row_[k], row_[k + 1], across), blend(next_[k], next_[k + 1], across), down);
  }

 private:
  [[nodiscard]] std::uint32_t knots() const { return (window_.x_end - window_.x_begin + step_ - 1) / step_ + 1; }
  void sample(std::int64_t y, std::vector<Coarse>& row) const {
    const double t = window_.t0_m + static_cast<double>(y - window_.y_begin) * window_.dt_m;
    const double step_m = step_ * window_.ds_m;
    for (std::size_t k = 0; k < row.size(); ++k) {
      row[k] = painter_.coarse(window_.s0_m + static_cast<double>(k) * step_m, t, step_m);
    }
  }

  const RockPainter& painter_;
  const TexelWindow& window_;
  std::uint32_t step_;
  std::vector<Coarse> row_, next_;
};

// Rows [first, last) of a window.
void paint_rows(const RockPainter& painter, const TexelWindow& w, std::uint32_t step, std::uint32_t first,
                std::uint32_t last, Image& image) {
  CoarseRows rows{painter, w, step};
  for (std::uint32_t y0 = first; y0 < last; y0 += step) {
    if (y0 == first) {
      rows.start(y0);
    } else {
      rows.advance(y0);
    }
    for (std::uint32_t y = y0; y < std::min(last, y0 + step); ++y) {
      const float down = static_cast<float>(y - y0) / static_cast<float>(step);
      const double t = w.t0_m + (y - w.y_begin) * w.dt_m;
      for (std::uint32_t x = w.x_begin; x < w.x_end; ++x) {
        put(image, x, y, painter.texel(w.s0_m + (x - w.x_begin) * w.ds_m, t, rows.at(x, down)));
      }
    }
  }
}

}  // namespace
}  // namespace generate

Image outcrop_texture(const GenerateOptions& options, std::uint32_t index, const Context& context) {
  using namespace generate;
  const OutcropField field{options.seed};
  const SheetKind kind = outcrop_kind(field);
  const SheetLayout layout = lay_out(options, kind);
  const RockPainter painter{field};
  Image image = blank(options.texture_size_px);
  for (const TexelWindow& w : texel_windows(layout, kind, index)) {
    const std::uint32_t step = w.ds_m < 0.012 ? 4 : (w.ds_m < 0.03 ? 2 : 1);
    constexpr std::size_t band = 64;  // a multiple of every step
    parallel_chunks(w.y_end - w.y_begin, band, context, [&](std::size_t begin, std::size_t end) {
      paint_rows(painter, w, step, w.y_begin + static_cast<std::uint32_t>(begin),
                 w.y_begin + static_cast<std::uint32_t>(end), image);
    });
  }
  return image;
}

Result<Mesh> generate_outcrop(const GenerateOptions& options, const Context& context) {
  using namespace generate;
  if (Status status = check_options(options); !status) return status.error();
  const OutcropField field{options.seed};
  const SheetKind kind = outcrop_kind(field);
  Mesh mesh = make_sheet(lay_out(options, kind), kind, {677'400.0, 5'403'200.0, 412.0}, context);
  return with_pixels(std::move(mesh), options, context, outcrop_texture);
}

}  // namespace lodestone
