// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, sections 4 and 5.3 (equations 10 to 12 and 16).
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>

#include "perception/minimise.h"

namespace lodestone {
namespace {

constexpr std::uint32_t max_levels = 16;

// Switch distances from logarithms of the steps between them, so that any vector is in order. Where the range ends
// before the last step, what is left has no room for a level.
std::vector<double> from_steps(const std::vector<double>& log_steps, double last_m) {
  std::vector<double> switch_m{0.0};
  for (const double s : log_steps) switch_m.push_back(std::min(last_m, switch_m.back() + std::exp(s)));
  return switch_m;
}

SwitchPlan make_plan(std::string name, const DetailFit& fit, std::vector<double> switch_m, double last_m) {
  SwitchPlan plan;
  plan.name = std::move(name);
  plan.switch_m = std::move(switch_m);
  plan.redundancy = redundancy(fit, plan.switch_m, last_m);
  return plan;
}

// Distances that are dense where the detail falls fast: even in the logarithm.
std::vector<double> log_grid(double last_m, std::uint32_t count) {
  std::vector<double> grid(count + 1);
  for (std::uint32_t i = 0; i <= count; ++i) grid[i] = std::expm1(std::log1p(last_m) * i / count);
  grid.back() = last_m;
  return grid;
}

}  // namespace

double redundancy(const DetailFit& fit, const std::vector<double>& switch_m, double last_m) {
  double drawn = 0.0;
  for (std::size_t i = 0; i < switch_m.size(); ++i) {
    const double begin = std::min(switch_m[i], last_m);
    const double end = i + 1 < switch_m.size() ? std::min(switch_m[i + 1], last_m) : last_m;
    drawn += fit(begin) * (end - begin);
  }
  return drawn - fit.integral(last_m);
}

Result<SwitchPlan> design_switches(const DetailFit& fit, std::uint32_t levels, double last_m) {
  if (levels < 1 || levels > max_levels || !(last_m > 0.0)) {
    return Error{ErrorCode::BadArgument, "a plan has 1 to 16 levels and ends beyond the first distance",
                 "switch distances"};
  }
  if (levels == 1) return make_plan("minimum redundancy", fit, {0.0}, last_m);
  const std::size_t n = levels - 1;
  const std::vector<double> low(n, std::log(1e-6 * last_m));
  const std::vector<double> high(n, std::log(last_m));
  const auto value = [&](const std::vector<double>& steps) {
    return redundancy(fit, from_steps(steps, last_m), last_m);
  };
  std::vector<double> best;
  // Restarts: geometric plans of different reach.
  for (const double reach : {0.003, 0.01, 0.03, 0.1, 0.3}) {
    std::vector<double> start(n);
    for (std::size_t i = 0; i < n; ++i) {
      start[i] = std::log(reach * last_m) - 1.2 * static_cast<double>(n - 1 - i);
    }
    for (int again = 0; again < 3; ++again) start = perception::minimise(value, start, low, high);
    if (best.empty() || value(start) < value(best)) best = start;
  }
  return make_plan("minimum redundancy", fit, from_steps(best, last_m), last_m);
}

SwitchPlan design_switches_by_grid(const DetailFit& fit, std::uint32_t levels, double last_m, std::uint32_t grid_size) {
  const std::vector<double> grid = log_grid(last_m, grid_size);
  const std::size_t points = grid.size();
  std::vector<double> metric(points);
  std::transform(grid.begin(), grid.end(), metric.begin(), [&](double x) { return fit(x); });
  // least[i]: detail drawn from grid[i] to the end with `k` levels, the first of which begins there.
  std::vector<double> least(points);
  for (std::size_t i = 0; i < points; ++i) least[i] = metric[i] * (last_m - grid[i]);
  std::vector<std::vector<std::uint32_t>> next;
  for (std::uint32_t k = 1; k < levels; ++k) {
    std::vector<double> better(points, 0.0);
    std::vector<std::uint32_t> choice(points, static_cast<std::uint32_t>(points - 1));
    for (std::size_t i = 0; i < points; ++i) {
      double best = metric[i] * (last_m - grid[i]);
      for (std::size_t j = i + 1; j < points; ++j) {
        const double drawn = metric[i] * (grid[j] - grid[i]) + least[j];
        if (drawn < best) {
          best = drawn;
          choice[i] = static_cast<std::uint32_t>(j);
        }
      }
      better[i] = best;
    }
    least = std::move(better);
    next.push_back(std::move(choice));
  }
  std::vector<double> switch_m{0.0};
  std::size_t at = 0;
  for (std::size_t k = next.size(); k-- > 0;) {
    at = next[k][at];
    switch_m.push_back(grid[at]);
  }
  return make_plan("minimum redundancy (grid)", fit, std::move(switch_m), last_m);
}

std::uint32_t choose_level_count(const DetailFit& fit, double last_m, double least_gain) {
  double before = redundancy(fit, {0.0}, last_m);
  for (std::uint32_t levels = 2; levels <= max_levels; ++levels) {
    const auto plan = design_switches(fit, levels, last_m);
    if (!plan || before - plan->redundancy < least_gain * before) return levels - 1;
    before = plan->redundancy;
  }
  return max_levels;
}

SwitchPlan equal_intervals(const DetailFit& fit, std::uint32_t levels, double interval_m, double last_m) {
  std::vector<double> switch_m;
  for (std::uint32_t i = 0; i < levels; ++i) switch_m.push_back(std::min(interval_m * i, last_m));
  return make_plan("equal " + std::to_string(std::lround(interval_m)) + " m", fit, std::move(switch_m), last_m);
}

SwitchPlan exponential_intervals(const DetailFit& fit, std::uint32_t levels, double factor, double first_m,
                                 double last_m) {
  std::vector<double> switch_m;
  for (std::uint32_t i = 0; i < levels; ++i) {
    switch_m.push_back(std::min(first_m * (std::pow(factor, i) - 1.0), last_m));
  }
  return make_plan("exponential " + std::to_string(std::lround(factor)), fit, std::move(switch_m), last_m);
}

}  // namespace lodestone
