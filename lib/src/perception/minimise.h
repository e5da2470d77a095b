// SPDX-License-Identifier: MIT
// Nelder-Mead (the simplex method of the paper) by NLopt; the only place that names it.
#pragma once

#include <functional>
#include <vector>

namespace lodestone::perception {

// A local minimum of `value` within [low, high] from `start`, each by component; deterministic.
[[nodiscard]] std::vector<double> minimise(const std::function<double(const std::vector<double>&)>& value,
                                           std::vector<double> start, const std::vector<double>& low,
                                           const std::vector<double>& high);

}  // namespace lodestone::perception
