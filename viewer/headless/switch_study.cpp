// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, section 5.
#include "switch_study.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "detail_stage.h"
#include "level_checker.h"

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
  if (options.needed_levels > 1000) return refuse("at most 1000 distances can be looked at for needed levels");
  if (options.samples < 4) return refuse("a fit needs at least 4 samples");
  if (!(options.reach_ratio > 1.0)) return refuse("samples must reach beyond the first distance");
  return Done{};
}

// One study on its way.
class Studying {
 public:
  Studying(std::shared_ptr<const ProgressiveModel> model, const StudyOptions& options, const Context& context,
           DetailStage& stage)
      : model_(std::move(model)),
        options_(options),
        context_(context),
        stage_(stage),
        checker_(model_, options.display, options.noticeable_limit, stage, context),
        vision_(checker_.vision()) {}

  [[nodiscard]] Result<SwitchStudy> run();

 private:
  [[nodiscard]] Status sample_sides(const std::vector<LookedAt>& sides);
  [[nodiscard]] Status fit_and_design();
  [[nodiscard]] Status compare();
  [[nodiscard]] Result<PlanCheck> check_levels(const SwitchPlan& plan);
  [[nodiscard]] Status refine_levels();
  [[nodiscard]] Status move_idle();
  [[nodiscard]] Result<std::pair<Level, LevelCheck>> best_beyond(Level last, double last_m);
  [[nodiscard]] Status find_needed();
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
  LevelChecker checker_;
  const VisionModel& vision_;
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
  if (!plan) return plan;
  add_cost(*plan);
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
  study_.design = std::move(*plan);
  study_.plan = study_.design;
  settle_switches(study_.plan, study_.fit, *model_, study_.first_m, beyond_m(), study_.focal_px);
  for (SideStudy& side : study_.sides) {
    auto own = fit_detail(side.samples);
    if (!own) return own.error();
    side.fit = *own;
    auto own_plan = design(side.fit);
    if (!own_plan) return own_plan.error();
    side.design = std::move(*own_plan);
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

Result<PlanCheck> Studying::check_levels(const SwitchPlan& plan) {
  PlanCheck checked;
  for (std::size_t i = 0; i < plan.switch_m.size(); ++i) {
    auto level = checker_.check(plan.levels[i], study_.first_m + plan.switch_m[i]);
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
  plan.name = "measured";
  for (std::size_t i = plan.levels.size(); i-- > 0;) {
    LevelCheck& check = study_.measured_check.levels[i];
    const Level farther = i + 1 < plan.levels.size() ? plan.levels[i + 1] : 0;
    if (farther > plan.levels[i] || check.noticeable_ratio > options_.noticeable_limit) {
      auto found =
          checker_.coarsest_unnoticed(std::max(plan.levels[i], farther), model_->record_count(), check.distance_m);
      if (!found) return found.error();
      plan.levels[i] = found->first;
      check = found->second;
    }
    plan.triangles[i] = model_->info(plan.levels[i]).triangles;
  }
  if (Status status = move_idle(); !status) return status;
  double end_m = beyond_m();
  plan.cost = study_.first_m * model_->triangle_count();
  for (std::size_t i = plan.levels.size(); i-- > 0; end_m = plan.switch_m[i]) {
    plan.cost += (end_m - plan.switch_m[i]) * plan.triangles[i];
  }
  plan.redundancy = redundancy(study_.fit, plan.switch_m, beyond_m());
  return Done{};
}

// Refined levels may be nearly the same: a switch that saves less than a twentieth of the triangles goes beyond the
// last one instead, to where it saves most.
Status Studying::move_idle() {
  constexpr double least_saving = 0.05;
  SwitchPlan& plan = study_.measured;
  for (std::size_t turn = plan.levels.size(); turn > 0; --turn) {
    std::size_t idle = 1;
    while (idle < plan.levels.size() && plan.triangles[idle] < (1.0 - least_saving) * plan.triangles[idle - 1]) ++idle;
    if (idle >= plan.levels.size()) break;
    auto found = best_beyond(plan.levels.back(), study_.first_m + plan.switch_m.back());
    if (!found) return found.error();
    if (model_->info(found->first).triangles >= (1.0 - least_saving) * plan.triangles.back()) break;
    // The finer of the two levels serves both ranges.
    const auto at = static_cast<std::ptrdiff_t>(idle);
    plan.switch_m.erase(plan.switch_m.begin() + at);
    plan.levels.erase(plan.levels.begin() + at);
    plan.triangles.erase(plan.triangles.begin() + at);
    study_.measured_check.levels.erase(study_.measured_check.levels.begin() + at);
    plan.switch_m.push_back(found->second.distance_m - study_.first_m);
    plan.levels.push_back(found->first);
    plan.triangles.push_back(model_->info(found->first).triangles);
    study_.measured_check.levels.push_back(found->second);
  }
  return Done{};
}

// The level and distance beyond `last_m` at which switching saves most. The level `last` serves until then.
Result<std::pair<Level, LevelCheck>> Studying::best_beyond(Level last, double last_m) {
  constexpr int steps = 8;
  std::pair<Level, LevelCheck> best{last, {last_m, 1.0, 0.0}};
  double most = 0.0;
  for (int k = 1; k < steps; ++k) {
    const double distance_m = last_m * std::pow(study_.last_m / last_m, double(k) / steps);
    const Level unmoved =
        model_->level_of_error(imperceptible_error_m(distance_m, study_.focal_px) * 2.0 * study_.plan.allowed_px);
    auto found = checker_.coarsest_unnoticed(std::min(last, unmoved), model_->record_count(), distance_m);
    if (!found) return found.error();
    const double fewer = double(model_->info(last).triangles) - model_->info(found->first).triangles;
    if (fewer * (study_.last_m - distance_m) > most) {
      most = fewer * (study_.last_m - distance_m);
      best = *found;
    }
  }
  return best;
}

// From near to far, never finer than nearer: a bar thinner than a pixel takes a larger share of fewer pixels by going
// away, but is not seen better for that.
Status Studying::find_needed() {
  const std::uint32_t count = options_.needed_levels;
  Level level = model_->record_count();
  for (std::uint32_t k = 0; k < count; ++k) {
    const double distance_m = study_.first_m * std::pow(study_.last_m / study_.first_m, double(k) / count);
    const Level unmoved = model_->level_of_error(imperceptible_error_m(distance_m, study_.focal_px));
    context_.report("checking", double(k) / count);
    auto found = checker_.coarsest_unnoticed(std::min(unmoved, level), level, distance_m);
    if (!found) return found.error();
    level = found->first;
    study_.needed.push_back({level, model_->info(level).triangles, found->second});
  }
  return Done{};
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
  checker_.look_at(*looked_at);
  if (Status status = sample_sides(*looked_at); !status) return status.error();
  if (Status status = fit_and_design(); !status) return status.error();
  if (Status status = compare(); !status) return status.error();
  if (Status status = find_needed(); !status) return status.error();
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
