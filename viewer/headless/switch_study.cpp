// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, section 5.
#include "switch_study.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "detail_stage.h"

namespace lodestone::render {
namespace {

constexpr double equal_ratios[] = {1.46, 2.92, 4.38};  // the paper's 100, 200 and 300 m over its d1
constexpr double exponential_factors[] = {2.0, 3.0};

Result<std::vector<LookedAt>> sides_of(const std::vector<std::string>& names, const Sides& sides) {
  const std::vector<LookedAt> four{
      {"front", sides.front_rad}, {"back", sides.back_rad()}, {"left", sides.left_rad()}, {"right", sides.right_rad()}};
  std::vector<LookedAt> found;
  for (const std::string& name : names) {
    if (name == "all") {
      found.insert(found.end(), four.begin(), four.end());
      continue;
    }
    const auto known = std::find_if(four.begin(), four.end(), [&](const LookedAt& s) { return s.name == name; });
    if (known != four.end()) {
      found.push_back(*known);
      continue;
    }
    double degrees = 0.0;
    const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), degrees);
    if (fault != std::errc{} || end != name.data() + name.size() || !(std::abs(degrees) <= 360.0)) {
      return Error{ErrorCode::BadArgument,
                   "unknown side '" + name + "', use front, back, left, right, all or degrees clockwise from north",
                   ""};
    }
    found.push_back({name, degrees * std::numbers::pi / 180.0});
  }
  if (found.empty()) return Error{ErrorCode::BadArgument, "name at least one side to look at", ""};
  return found;
}

Status check(const StudyOptions& options) {
  const auto refuse = [](const char* message) { return Error{ErrorCode::BadArgument, message, ""}; };
  const Display& d = options.display;
  if (!(d.dots_per_inch > 0.0 && std::isfinite(d.dots_per_inch)) ||
      !(d.viewing_distance_m > 0.0 && std::isfinite(d.viewing_distance_m))) {
    return refuse("dots per inch and viewing distance must be above 0");
  }
  if (options.levels > 16) return refuse("a plan has at most 16 levels");
  if (options.samples < 4) return refuse("a fit needs at least 4 samples");
  if (!(options.reach_ratio > 1.0)) return refuse("samples must reach beyond the first distance");
  return Done{};
}

// One study on its way.
class Studying {
 public:
  Studying(std::shared_ptr<const ProgressiveModel> model, const StudyOptions& options, const Context& context,
           DetailStage& stage)
      : model_(std::move(model)), options_(options), context_(context), stage_(stage), vision_(options.display) {}

  [[nodiscard]] Result<SwitchStudy> run();

 private:
  [[nodiscard]] Status sample_sides(const std::vector<LookedAt>& sides);
  [[nodiscard]] Status fit_and_design();
  [[nodiscard]] Status compare();
  [[nodiscard]] Result<LevelCheck> check_level(Level level, double distance_m);
  [[nodiscard]] Result<PlanCheck> check_levels(const SwitchPlan& plan);
  [[nodiscard]] Status refine_levels();
  [[nodiscard]] Result<std::pair<Level, LevelCheck>> coarsest_unnoticed(Level from, double distance_m);
  [[nodiscard]] Status look_once();
  [[nodiscard]] Result<SwitchPlan> design(const DetailFit& fit) const;
  [[nodiscard]] double beyond_m() const { return study_.last_m - study_.first_m; }
  void add_cost(SwitchPlan& plan) const {
    lodestone::add_cost(plan, *model_, study_.first_m, beyond_m(), study_.focal_px);
  }

  std::shared_ptr<const ProgressiveModel> model_;
  const StudyOptions& options_;
  const Context& context_;
  DetailStage& stage_;
  VisionModel vision_;
  SwitchStudy study_;
  std::uint32_t levels_ = 0;
  std::vector<Warning> warnings_;
};

Status Studying::sample_sides(const std::vector<LookedAt>& sides) {
  std::vector<std::vector<DetailSample>> all;
  std::vector<double> distances_m;
  for (const LookedAt& side : sides) {
    const RenderAtDistance render = [&](double distance_m) { return stage_.picture(side.azimuth_rad, distance_m); };
    Context part = context_;
    part.progress = [&](std::string_view stage, double fraction) {
      context_.report(stage, (static_cast<double>(all.size()) + fraction) / static_cast<double>(sides.size()));
    };
    const SamplingOptions sampling{study_.first_m, options_.reach_ratio * study_.first_m, options_.samples,
                                   options_.sampling};
    auto samples = all.empty() ? sample_perceptual_metric(sampling, vision_, render, part)
                               : sample_metric_at(distances_m, vision_, render, part);
    if (!samples) return samples.error();
    if (all.empty()) {
      for (const DetailSample& sample : *samples) distances_m.push_back(sample.distance_m);
    }
    study_.sides.push_back({side, *samples, {}, {}});
    all.push_back(std::move(*samples));
  }
  study_.samples = pool_sides(all);
  return Done{};
}

Result<SwitchPlan> Studying::design(const DetailFit& fit) const {
  auto plan = design_switches(fit, levels_, beyond_m());
  if (plan) add_cost(*plan);
  return plan;
}

Status Studying::fit_and_design() {
  auto fit = fit_detail(study_.samples);
  if (!fit) return fit.error();
  study_.fit = *fit;
  warnings_ = std::move(fit.warnings());
  levels_ = options_.levels > 0 ? options_.levels : choose_level_count(study_.fit, beyond_m());
  auto plan = design(study_.fit);
  if (!plan) return plan.error();
  study_.plan = std::move(*plan);
  for (SideStudy& side : study_.sides) {
    auto own = fit_detail(side.samples);
    if (!own) return own.error();
    side.fit = *own;
    auto own_plan = design(side.fit);
    if (!own_plan) return own_plan.error();
    side.plan = std::move(*own_plan);
  }
  return Done{};
}

Status Studying::compare() {
  for (const double ratio : equal_ratios) {
    study_.alternatives.push_back(equal_intervals(study_.fit, levels_, ratio * study_.first_m, beyond_m()));
  }
  for (const double factor : exponential_factors) {
    study_.alternatives.push_back(exponential_intervals(study_.fit, levels_, factor, study_.first_m, beyond_m()));
  }
  for (SwitchPlan& plan : study_.alternatives) add_cost(plan);
  auto checked = check_levels(study_.plan);
  if (!checked) return checked.error();
  study_.plan_check = std::move(*checked);
  if (Status status = refine_levels(); !status) return status;
  for (std::size_t i = 0; i < std::size(equal_ratios); ++i) {
    SwitchPlan plan = study_.alternatives[i];
    match_cost(plan, study_.measured.cost, *model_, study_.first_m, beyond_m(), study_.focal_px);
    auto same_cost = check_levels(plan);
    if (!same_cost) return same_cost.error();
    study_.same_cost.push_back(std::move(plan));
    study_.same_cost_checks.push_back(std::move(*same_cost));
  }
  return Done{};
}

Result<LevelCheck> Studying::check_level(Level level, double distance_m) {
  LevelCheck check{distance_m, 0.0, 0.0};
  double pixels = 0.0;
  for (const SideStudy& side : study_.sides) {
    if (context_.cancelled()) return Error{ErrorCode::Cancelled, "cancelled", ""};
    stage_.set_level(model_->record_count());
    const auto full = stage_.picture(side.side.azimuth_rad, distance_m);
    if (!full) return full.error();
    stage_.set_level(level);
    const auto coarse = stage_.picture(side.side.azimuth_rad, distance_m);
    if (!coarse) return coarse.error();
    const auto seen = check_vision(full->image, coarse->image, full->mask, vision_);
    if (!seen) return seen.error();
    const auto count = static_cast<double>(std::count(full->mask.begin(), full->mask.end(), std::uint8_t{1}));
    check.ssim += seen->ssim * count;
    check.noticeable_ratio += seen->noticeable_ratio * count;
    pixels += count;
  }
  stage_.set_level(model_->record_count());
  check.ssim /= pixels;
  check.noticeable_ratio /= pixels;
  return check;
}

Result<PlanCheck> Studying::check_levels(const SwitchPlan& plan) {
  PlanCheck checked;
  for (std::size_t i = 0; i < plan.switch_m.size(); ++i) {
    auto level = check_level(plan.levels[i], study_.first_m + plan.switch_m[i]);
    if (!level) return level.error();
    checked.levels.push_back(*level);
  }
  return checked;
}

// From far to near, so that no level is coarser than one farther away.
Status Studying::refine_levels() {
  study_.measured = study_.plan;
  study_.measured_check = study_.plan_check;
  SwitchPlan& plan = study_.measured;
  plan.name += ", measured";
  double end_m = beyond_m();
  plan.cost = study_.first_m * model_->triangle_count();
  for (std::size_t i = plan.levels.size(); i-- > 0;) {
    LevelCheck& check = study_.measured_check.levels[i];
    const Level farther = i + 1 < plan.levels.size() ? plan.levels[i + 1] : 0;
    if (farther > plan.levels[i] || check.noticeable_ratio > options_.noticeable_limit) {
      auto found = coarsest_unnoticed(std::max(plan.levels[i], farther), check.distance_m);
      if (!found) return found.error();
      plan.levels[i] = found->first;
      check = found->second;
    }
    plan.triangles[i] = model_->info(plan.levels[i]).triangles;
    plan.cost += (end_m - plan.switch_m[i]) * plan.triangles[i];
    end_m = plan.switch_m[i];
  }
  return Done{};
}

// Halves the stack above a level that shows: the upper end always passes, the finest level being full detail.
Result<std::pair<Level, LevelCheck>> Studying::coarsest_unnoticed(Level from, double distance_m) {
  auto check = check_level(from, distance_m);
  if (!check) return check.error();
  if (check->noticeable_ratio <= options_.noticeable_limit) return std::pair{from, *check};
  Level shows = from;
  std::pair<Level, LevelCheck> passes{model_->record_count(), {distance_m, 1.0, 0.0}};
  while (passes.first - shows > 1) {
    const Level middle = shows + (passes.first - shows) / 2;
    check = check_level(middle, distance_m);
    if (!check) return check.error();
    if (check->noticeable_ratio > options_.noticeable_limit) {
      shows = middle;
    } else {
      passes = {middle, *check};
    }
  }
  return passes;
}

Status Studying::look_once() {
  auto picture = stage_.picture(study_.sides.front().side.azimuth_rad, study_.first_m);
  if (!picture) return picture.error();
  auto seen = vision_.simulate(picture->image);
  if (!seen) return seen.error();
  auto map = difference_map(*picture, vision_);
  if (!map) return map.error();
  auto vision = check_simulation(*picture, vision_);
  if (!vision) return vision.error();
  study_.rendered = std::move(picture->image);
  study_.seen = std::move(*seen);
  study_.difference = std::move(*map);
  study_.vision = std::move(*vision);
  return Done{};
}

Result<SwitchStudy> Studying::run() {
  const Sides sides = find_sides(model_->extract(model_->record_count()));
  const auto looked_at = sides_of(options_.sides, sides);
  if (!looked_at) return looked_at.error();
  study_.bounds = sides.bounds;
  study_.focal_px = focal_length_px(options_.display);
  study_.first_m = first_distance_m(sides.bounds.radius_m, options_.display.fov_y_rad);
  study_.last_m = last_distance_m(sides.bounds.radius_m, study_.focal_px);
  if (!(study_.first_m > 0.0) || !std::isfinite(study_.last_m)) {
    return Error{ErrorCode::BadArgument, "the model has no extent, so there is no distance to look from", ""};
  }
  if (Status status = sample_sides(*looked_at); !status) return status.error();
  if (Status status = fit_and_design(); !status) return status.error();
  if (Status status = compare(); !status) return status.error();
  if (Status status = look_once(); !status) return status.error();
  return {std::move(study_), std::move(warnings_)};
}

}  // namespace

double PlanCheck::worst_noticeable_ratio() const noexcept {
  double worst = 0.0;
  for (const LevelCheck& level : levels) worst = std::max(worst, level.noticeable_ratio);
  return worst;
}

double PlanCheck::worst_ssim() const noexcept {
  double worst = 1.0;
  for (const LevelCheck& level : levels) worst = std::min(worst, level.ssim);
  return worst;
}

Result<SwitchStudy> study_switch_distances(std::shared_ptr<const ProgressiveModel> model, const StudyOptions& options,
                                           const Context& context) {
  if (Status status = check(options); !status) return status.error();
  auto stage = DetailStage::create(model, options.display, options.supersample);
  if (!stage) return stage.error();
  return Studying{std::move(model), options, context, **stage}.run();
}

}  // namespace lodestone::render
