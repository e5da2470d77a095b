// SPDX-License-Identifier: MIT
// Based on: Zhu et al. 2010, equation 15; Golub and Pereyra 1973 (variable projection: for given rates the factors are
// a linear problem, so only two numbers are searched for).
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>

#include "perception/minimise.h"

namespace lodestone {
namespace {

struct Data {
  std::vector<double> x, y;
};

double squared_residuals(const Data& data, const DetailFit& fit) {
  double sum = 0.0;
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const double residual = fit(data.x[i]) - data.y[i];
    sum += residual * residual;
  }
  return sum;
}

// Best factors, none negative, for rates b and d; returns the sum of squared residuals.
double solve_factors(const Data& data, DetailFit& fit) {
  double ee = 0.0;
  double ef = 0.0;
  double ff = 0.0;
  double ey = 0.0;
  double fy = 0.0;
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    const double e = std::exp(fit.b * data.x[i]);
    const double f = std::exp(fit.d * data.x[i]);
    ee += e * e;
    ef += e * f;
    ff += f * f;
    ey += e * data.y[i];
    fy += f * data.y[i];
  }
  const double determinant = ee * ff - ef * ef;
  if (determinant > 1e-12 * ee * ff) {
    fit.a = (ey * ff - fy * ef) / determinant;
    fit.c = (ee * fy - ef * ey) / determinant;
  } else {  // equal rates: one term does it
    fit.a = ee > 0.0 ? ey / ee : 0.0;
    fit.c = 0.0;
  }
  if (fit.a >= 0.0 && fit.c >= 0.0) return squared_residuals(data, fit);
  // A negative term would rise with distance: the better of both alone.
  DetailFit other = fit;
  fit.a = ee > 0.0 ? std::max(0.0, ey / ee) : 0.0;
  fit.c = 0.0;
  other.a = 0.0;
  other.c = ff > 0.0 ? std::max(0.0, fy / ff) : 0.0;
  if (squared_residuals(data, other) < squared_residuals(data, fit)) fit = other;
  return squared_residuals(data, fit);
}

}  // namespace

double DetailFit::operator()(double x_m) const noexcept { return a * std::exp(b * x_m) + c * std::exp(d * x_m); }

double DetailFit::integral(double x_m) const noexcept {
  const auto term = [x_m](double factor, double rate) {
    return rate == 0.0 ? factor * x_m : factor * std::expm1(rate * x_m) / rate;
  };
  return term(a, b) + term(c, d);
}

Result<DetailFit> fit_detail(const std::vector<DetailSample>& samples) {
  if (samples.size() < 4) return Error{ErrorCode::BadArgument, "a fit needs at least 4 samples", "perceptual metric"};
  Data data;
  for (const DetailSample& s : samples) {
    if (!std::isfinite(s.distance_m) || !std::isfinite(s.metric)) {
      return Error{ErrorCode::BadArgument, "a sample is not a finite number", "perceptual metric"};
    }
    data.x.push_back(s.distance_m - samples.front().distance_m);
    data.y.push_back(s.metric);
  }
  const double span_m = data.x.back();
  if (!(span_m > 0.0)) return Error{ErrorCode::BadArgument, "all samples lie at one distance", "perceptual metric"};

  const auto [least, most] = std::minmax_element(data.y.begin(), data.y.end());
  if (*least == *most) {
    return Error{ErrorCode::BadArgument, "the metric is the same at all distances, so there is nothing to fit",
                 "perceptual metric"};
  }

  // Rates as logarithms of 1 / length, lengths from a hundredth of the span to thirty spans.
  const std::vector<double> low(2, std::log(1.0 / (30.0 * span_m)));
  const std::vector<double> high(2, std::log(100.0 / span_m));
  const auto at = [&](const std::vector<double>& rates) {
    DetailFit fit;
    fit.b = -std::exp(rates[0]);
    fit.d = -std::exp(rates[1]);
    return fit;
  };
  const auto value = [&](const std::vector<double>& rates) {
    DetailFit fit = at(rates);
    return solve_factors(data, fit);
  };
  double best = std::numeric_limits<double>::infinity();
  DetailFit fit;
  constexpr int starts = 5;
  for (int i = 0; i < starts; ++i) {
    for (int j = 0; j < i; ++j) {
      const auto place = [&](int k) { return low[0] + (high[0] - low[0]) * (k + 0.5) / starts; };
      const auto rates = perception::minimise(value, {place(i), place(j)}, low, high);
      DetailFit candidate = at(rates);
      const double sum = solve_factors(data, candidate);
      if (sum < best) {
        best = sum;
        fit = candidate;
      }
    }
  }
  if (fit.b > fit.d) {  // the faster decay first, as the paper prints it
    std::swap(fit.a, fit.c);
    std::swap(fit.b, fit.d);
  }
  double mean = 0.0;
  for (const double y : data.y) mean += y / static_cast<double>(data.y.size());
  double total = 0.0;
  for (const double y : data.y) total += (y - mean) * (y - mean);
  const double degrees = std::max(1.0, static_cast<double>(data.y.size()) - 4.0);
  fit.rmse = std::sqrt(best / degrees);
  fit.r_square = total > 0.0 ? 1.0 - best / total : 1.0;
  Result<DetailFit> result{fit};
  if (fit.r_square < 0.95) {
    result.warnings().push_back({"the two exponentials fit the samples poorly (R^2 " + std::to_string(fit.r_square) +
                                     "); sample a longer range or more densely",
                                 "perceptual metric"});
  }
  return result;
}

}  // namespace lodestone
