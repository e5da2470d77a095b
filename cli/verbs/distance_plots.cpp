// SPDX-License-Identifier: MIT
#include "distance_plots.h"

#include <cmath>

#include <lodestone/formats.h>

#include "viewer/headless/plot.h"

namespace lodestone::cli {
namespace {

using render::Curve;
using render::SwitchStudy;

constexpr int curve_steps = 500;

// Points of the fit over distances from the camera.
Curve fit_curve(const SwitchStudy& study, double end_m) {
  Curve curve{"fit", Curve::Style::Line, render::curve_color(0), {}};
  for (int i = 0; i <= curve_steps; ++i) {
    const double x_m = (end_m - study.first_m) * i / curve_steps;
    curve.points.emplace_back(study.first_m + x_m, study.fit(x_m));
  }
  return curve;
}

render::Plot metric_plot(const SwitchStudy& study) {
  Curve samples{"samples", Curve::Style::Dots, render::curve_color(1), {}};
  for (const DetailSample& sample : study.samples) samples.points.emplace_back(sample.distance_m, sample.metric);
  const double end_m = study.samples.back().distance_m;
  render::Plot plot{.title = {}, .x_title = "distance, m", .y_title = "perceptual metric"};
  plot.curves = {std::move(samples), fit_curve(study, end_m)};
  return plot;
}

// What a plan draws: the detail at the beginning of each level, held to its end.
render::Plot redundancy_plot(const SwitchStudy& study) {
  const double end_m = study.samples.back().distance_m;
  const auto& switch_m = study.design.switch_m;
  Curve drawn{"drawn", Curve::Style::Line, render::curve_color(1), {}};
  Curve area{"not seen", Curve::Style::Area, render::curve_color(6), {}};
  for (std::size_t i = 0; i < switch_m.size(); ++i) {
    const double from_m = study.first_m + switch_m[i];
    const double to_m = std::min(end_m, i + 1 < switch_m.size() ? study.first_m + switch_m[i + 1] : end_m);
    if (from_m >= to_m) break;
    const double level = study.fit(switch_m[i]);
    drawn.points.emplace_back(from_m, level);
    drawn.points.emplace_back(to_m, level);
    for (int k = 0; k <= curve_steps; ++k) {
      const double x_m = from_m + (to_m - from_m) * k / curve_steps;
      area.points.emplace_back(x_m, level);
      area.floor.push_back(study.fit(x_m - study.first_m));
    }
  }
  render::Plot plot{.title = {}, .x_title = "distance, m", .y_title = "perceptual metric"};
  plot.curves = {std::move(area), fit_curve(study, end_m), std::move(drawn)};
  plot.curves[1].name = "seen (fit)";
  return plot;
}

Curve steps_of(const SwitchStudy& study, const SwitchPlan& plan, const glm::u8vec3& color) {
  Curve curve{plan.name, Curve::Style::Line, color, {}};
  for (std::size_t i = 0; i < plan.switch_m.size(); ++i) {
    const double to_m = i + 1 < plan.switch_m.size() ? study.first_m + plan.switch_m[i + 1] : study.last_m;
    curve.points.emplace_back(study.first_m + plan.switch_m[i], plan.triangles[i]);
    curve.points.emplace_back(to_m, plan.triangles[i]);
  }
  return curve;
}

// Figure 14, with the continuous model: the coarsest level that equation 17 allows at every distance, and what was
// measured to be needed.
render::Plot triangle_plot(const SwitchStudy& study, const ProgressiveModel& model) {
  render::Plot plot{.title = {},
                    .x_title = "distance, m",
                    .y_title = "triangles",
                    .x_axis = render::Axis::Logarithmic,
                    .y_axis = render::Axis::Logarithmic,
                    .legend = render::LegendCorner::BottomLeft};
  for (std::size_t i = study.alternatives.size(); i-- > 0;) {
    plot.curves.push_back(steps_of(study, study.alternatives[i], render::curve_color(2 + i)));
  }
  plot.curves.push_back(steps_of(study, study.design, render::curve_color(0)));
  if (study.plan.switch_m != study.design.switch_m) {
    plot.curves.push_back(steps_of(study, study.plan, render::curve_color(7)));
  }
  plot.curves.push_back(steps_of(study, study.measured, glm::u8vec3{0}));
  Curve continuous{"continuous, half a pixel", Curve::Style::Line, render::curve_color(1), {}};
  for (int i = 0; i <= curve_steps; ++i) {
    const double distance_m = study.first_m * std::pow(study.last_m / study.first_m, double(i) / curve_steps);
    const Level level = model.level_of_error(imperceptible_error_m(distance_m, study.focal_px));
    continuous.points.emplace_back(distance_m, model.info(level).triangles);
  }
  plot.curves.push_back(std::move(continuous));
  Curve needed{"continuous, as needed", Curve::Style::Dots, render::curve_color(1), {}};
  for (const render::NeededCheck& n : study.needed) needed.points.emplace_back(n.check.distance_m, n.triangles);
  if (!needed.points.empty()) plot.curves.push_back(std::move(needed));
  return plot;
}

}  // namespace

Status write_distance_plots(const SwitchStudy& study, const ProgressiveModel& model,
                            const std::filesystem::path& folder) {
  const std::pair<const char*, Image> pictures[] = {
      {"metric.png", draw_plot(metric_plot(study))},
      {"redundancy.png", draw_plot(redundancy_plot(study))},
      {"triangles.png", draw_plot(triangle_plot(study, model))},
      {"rendered.png", study.rendered},
      {"seen.png", study.seen},
      {"difference.png", study.difference},
  };
  for (const auto& [name, image] : pictures) {
    if (Status written = write_image(image, folder / name); !written) return written;
  }
  return Done{};
}

}  // namespace lodestone::cli
