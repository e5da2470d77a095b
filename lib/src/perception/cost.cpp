// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, section 5.4 (equations 17 and 18).
// Differs: the levels of a real model come in steps, which the fit does not know: a switch moves where they save more.
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

Level level_at(const SwitchPlan& plan, double beyond_m, const ProgressiveModel& model, double first_m,
               double focal_px) {
  return model.level_of_error(2.0 * plan.allowed_px * imperceptible_error_m(first_m + beyond_m, focal_px));
}

double end_of(const SwitchPlan& plan, std::size_t i, double last_m) {
  return i + 1 < plan.switch_m.size() ? plan.switch_m[i + 1] : last_m;
}

// Where one more switch saves most; negative if nowhere.
double best_further_switch(const SwitchPlan& plan, const ProgressiveModel& model, double first_m, double last_m,
                           double focal_px) {
  constexpr int steps = 400;
  double most = 0.0;
  double best_m = -1.0;
  for (int k = 1; k < steps; ++k) {
    const double beyond_m = first_m * std::expm1(std::log1p(last_m / first_m) * k / steps);
    const auto after = std::upper_bound(plan.switch_m.begin(), plan.switch_m.end(), beyond_m);
    const auto i = static_cast<std::size_t>(after - plan.switch_m.begin()) - 1;
    const double triangles = model.info(level_at(plan, beyond_m, model, first_m, focal_px)).triangles;
    const double saved = (end_of(plan, i, last_m) - beyond_m) * (plan.triangles[i] - triangles);
    if (saved > most) {
      most = saved;
      best_m = beyond_m;
    }
  }
  return best_m;
}

// Makes the levels one by one, the farthest first, as fine as what is left of the cost allows.
void refine_within(SwitchPlan& plan, double cost, const ProgressiveModel& model, double last_m) {
  for (std::size_t i = plan.levels.size(); i-- > 0;) {
    const double range_m = end_of(plan, i, last_m) - plan.switch_m[i];
    if (!(range_m > 0.0) || !(plan.cost < cost)) continue;
    const double affordable = plan.triangles[i] + (cost - plan.cost) / range_m;
    const Level finest = i > 0 ? plan.levels[i - 1] : model.record_count();
    const auto count = static_cast<std::uint32_t>(std::min<double>(affordable, model.triangle_count()));
    const Level level = std::min(finest, std::max(plan.levels[i], model.level_of_triangles(count)));
    plan.cost += range_m * (model.info(level).triangles - static_cast<double>(plan.triangles[i]));
    plan.levels[i] = level;
    plan.triangles[i] = model.info(level).triangles;
  }
}

}  // namespace

void add_cost(SwitchPlan& plan, const ProgressiveModel& model, double first_m, double last_m, double focal_px) {
  plan.levels.clear();
  plan.triangles.clear();
  plan.cost = first_m * model.triangle_count();  // level 0: the whole model, up to d1
  for (std::size_t i = 0; i < plan.switch_m.size(); ++i) {
    plan.levels.push_back(level_at(plan, plan.switch_m[i], model, first_m, focal_px));
    plan.triangles.push_back(model.info(plan.levels.back()).triangles);
    plan.cost += (end_of(plan, i, last_m) - plan.switch_m[i]) * plan.triangles.back();
  }
}

void settle_switches(SwitchPlan& plan, const DetailFit& fit, const ProgressiveModel& model, double first_m,
                     double last_m, double focal_px) {
  constexpr double least_saving = 0.01;
  const std::vector<double> designed_m = plan.switch_m;
  const std::size_t most_turns = 2 * plan.switch_m.size();
  for (std::size_t turn = 0; turn < most_turns; ++turn) {
    SwitchPlan best = plan;
    for (std::size_t i = 1; i < plan.switch_m.size(); ++i) {
      SwitchPlan moved = plan;
      moved.switch_m.erase(moved.switch_m.begin() + static_cast<std::ptrdiff_t>(i));
      add_cost(moved, model, first_m, last_m, focal_px);
      const double beyond_m = best_further_switch(moved, model, first_m, last_m, focal_px);
      if (beyond_m < 0.0) continue;  // the model has nothing coarser anywhere
      moved.switch_m.insert(std::upper_bound(moved.switch_m.begin(), moved.switch_m.end(), beyond_m), beyond_m);
      add_cost(moved, model, first_m, last_m, focal_px);
      if (moved.cost < best.cost) best = std::move(moved);
    }
    if (best.cost >= (1.0 - least_saving) * plan.cost) break;
    plan = std::move(best);
  }
  if (plan.switch_m != designed_m) plan.name = "settled on the model's levels";
  plan.redundancy = redundancy(fit, plan.switch_m, last_m);
}

void match_cost(SwitchPlan& plan, double cost, const ProgressiveModel& model, double first_m, double last_m,
                double focal_px) {
  constexpr double finest_px = 1e-3;
  constexpr double coarsest_px = 64.0;
  double low = std::log(finest_px);
  double high = std::log(coarsest_px);
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    plan.allowed_px = std::exp(middle);
    add_cost(plan, model, first_m, last_m, focal_px);
    (plan.cost > cost ? low : high) = middle;
  }
  plan.allowed_px = std::exp(high);
  add_cost(plan, model, first_m, last_m, focal_px);
  // Many records share one error, so the steps of allowed_px are coarse. A level is at most as fine as the one before
  // it, so that a nearer one that got finer makes room for those beyond it in the next turn.
  for (std::size_t turn = 0; turn < plan.levels.size(); ++turn) refine_within(plan, cost, model, last_m);
}

}  // namespace lodestone
