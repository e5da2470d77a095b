// SPDX-License-Identifier: MIT
// Switch distances of a model from pictures of it: renders, measures, fits, designs, compares and checks. What the verb
// `distances` calls; the numbers come from lodestone/perception.h.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lodestone/perception.h>

namespace lodestone::render {

/// A side that is looked at.
struct LookedAt {
  std::string name;  ///< "front", "back", "left", "right", or the azimuth in degrees
  double azimuth_rad = 0.0;
};

struct StudyOptions {
  Display display{};
  /// Names as in LookedAt; "all" stands for the four sides. Pooled to one plan (the pixels of all are added up).
  std::vector<std::string> sides{"front"};
  std::uint32_t levels = 0;  ///< level 0 not counted, 1..16; 0 = chosen by marginal gain
  std::uint32_t samples = 200;
  Sampling sampling = Sampling::EqualSteps;
  std::uint32_t supersample = 1;  ///< of the pictures, 1..4; 1 = off, as in the paper
  /// Samples reach from d1 to so many d1; the paper's 1068.48 m over 68.48 m.
  double reach_ratio = 15.6;
  /// Most of the object's pixels that may differ noticeably from full detail at a switch.
  double noticeable_limit = 0.01;
  /// Distances, besides those of the plans, at which a level is looked for that passes the same limit: what a
  /// continuous model needs. 0 = none. Each takes some ten pictures of every side.
  std::uint32_t needed_levels = 0;
};

struct SideStudy {
  LookedAt side;
  std::vector<DetailSample> samples;
  DetailFit fit;
  SwitchPlan design;
};

/// One level at its switch distance against full detail there, over all sides.
struct LevelCheck {
  double distance_m = 0.0;  ///< from the camera
  double ssim = 1.0;
  double noticeable_ratio = 0.0;  ///< of the pixels that the object has in either
};

struct PlanCheck {
  std::vector<LevelCheck> levels;
  [[nodiscard]] double worst_noticeable_ratio() const noexcept;
  [[nodiscard]] double worst_ssim() const noexcept;
};

/// The level that a continuous model needs from a distance.
struct NeededCheck {
  Level level = 0;
  std::uint32_t triangles = 0;
  LevelCheck check;
};

struct SwitchStudy {
  Sphere bounds;  ///< relative to the model's origin
  double first_m = 0.0;
  double last_m = 0.0;
  double focal_px = 0.0;
  std::vector<SideStudy> sides;
  std::vector<DetailSample> samples;     ///< pooled
  DetailFit fit;                         ///< of the pooled samples, as `design`
  SwitchPlan design;                     ///< least redundancy
  SwitchPlan plan;                       ///< the same, settled on the levels there are
  std::vector<SwitchPlan> alternatives;  ///< equal intervals of 1.46, 2.92, 4.38 d1, exponential 2 and 3
  PlanCheck plan_check;
  /// The plan with its levels refined one by one until no more than `noticeable_limit` of the pixels differ noticeably:
  /// equation 17 bounds how far a surface moves, not what becomes visible when a wall swallows a pane of another
  /// colour. Switches that save less than a twentieth of the triangles after that go beyond the last.
  /// The plan to use.
  SwitchPlan measured;
  PlanCheck measured_check;
  /// The equal intervals with all their levels as fine as the cost of `measured` allows.
  std::vector<SwitchPlan> same_cost;
  std::vector<PlanCheck> same_cost_checks;
  /// At even steps of the logarithm of the distance from d1 on, never finer with distance; none if none were asked for.
  std::vector<NeededCheck> needed;
  /// The vision model itself on the first side at d1: rendered, simulated, difference (black = none, white = most).
  VisionCheck vision;
  Image rendered;
  Image seen;
  Image difference;
};

/// Errors: BadArgument for options out of range or a model without triangles; Cancelled; Unsupported without OSMesa.
/// Warnings of the fits are passed on.
[[nodiscard]] Result<SwitchStudy> study_switch_distances(std::shared_ptr<const ProgressiveModel> model,
                                                         const StudyOptions& options, const Context& context = {});

}  // namespace lodestone::render
