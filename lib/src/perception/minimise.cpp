// SPDX-License-Identifier: MIT
#include "perception/minimise.h"

#include <nlopt.h>

#include <algorithm>
#include <memory>

namespace lodestone::perception {
namespace {

struct Problem {
  const std::function<double(const std::vector<double>&)>& value;
  std::vector<double> at;
};

double call(unsigned count, const double* x, double* /*gradient*/, void* data) {
  auto& problem = *static_cast<Problem*>(data);
  problem.at.assign(x, x + count);
  return problem.value(problem.at);
}

}  // namespace

std::vector<double> minimise(const std::function<double(const std::vector<double>&)>& value, std::vector<double> start,
                             const std::vector<double>& low, const std::vector<double>& high) {
  for (std::size_t i = 0; i < start.size(); ++i) start[i] = std::clamp(start[i], low[i], high[i]);
  const auto count = static_cast<unsigned>(start.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser{nlopt_create(NLOPT_LN_NELDERMEAD, count),
                                                                         nlopt_destroy};
  Problem problem{value, {}};
  nlopt_set_min_objective(optimiser.get(), call, &problem);
  nlopt_set_lower_bounds(optimiser.get(), low.data());
  nlopt_set_upper_bounds(optimiser.get(), high.data());
  nlopt_set_xtol_rel(optimiser.get(), 1e-10);
  nlopt_set_maxeval(optimiser.get(), static_cast<int>(4000 * count));
  std::vector<double> x = start;
  double best = 0.0;
  // Round-off near the minimum ends in an error code with x as good as it gets; a worse x than the start is not taken.
  nlopt_optimize(optimiser.get(), x.data(), &best);
  return value(x) <= value(start) ? x : start;
}

}  // namespace lodestone::perception
