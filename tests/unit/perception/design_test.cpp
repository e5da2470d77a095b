// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include <lodestone/perception.h>

using namespace lodestone;

namespace {

// The fit that the paper prints (section 5.3), and the end of its range as it enters equation 16.
DetailFit printed_fit() {
  DetailFit fit;
  fit.a = 0.5588;
  fit.b = -0.09722;
  fit.c = 0.1908;
  fit.d = -0.02061;
  return fit;
}
constexpr double end_m = 29750.0;

std::vector<DetailSample> samples_of(const DetailFit& fit, double noise) {
  std::vector<DetailSample> samples;
  for (int i = 0; i <= 200; ++i) {
    const double x = 5.0 * i;
    samples.push_back({68.48 + x, fit(x) + noise * std::sin(12.9898 * i) * 0.5, {}});
  }
  return samples;
}

// A picture whose object shrinks with distance, filled with fine stripes.
Result<ObjectPicture> shrinking(double distance_m) {
  ObjectPicture picture{Image{200, 100, 1, std::vector<std::uint8_t>(20000, 255)}, std::vector<std::uint8_t>(20000, 0)};
  const auto side = static_cast<std::uint32_t>(std::min(90.0, 4000.0 / distance_m));
  for (std::uint32_t y = 5; y < 5 + side; ++y) {
    for (std::uint32_t x = 5; x < 5 + side; ++x) {
      *picture.image.at(x, y) = x * 50U / (1 + side / 8) % 2 == 0 ? 90 : 110;
      picture.mask[y * 200 + x] = 1;
    }
  }
  return picture;
}

}  // namespace

TEST_CASE("the optimum of the paper's own equation lies at 24.6, 104.1 and 414.9 m, not at the printed distances") {
  const DetailFit fit = printed_fit();
  const auto plan = design_switches(fit, 4, end_m);
  REQUIRE(plan.ok());
  REQUIRE(plan->switch_m.size() == 4);
  CHECK(plan->switch_m[0] == 0.0);
  CHECK(plan->switch_m[1] == Approx(24.6).epsilon(0.01));
  CHECK(plan->switch_m[2] == Approx(104.1).epsilon(0.01));
  CHECK(plan->switch_m[3] == Approx(414.9).epsilon(0.01));
  CHECK(plan->redundancy == Approx(24.66).epsilon(0.001));
  CHECK(redundancy(fit, {0.0, 64.5, 251.8, 896.3}, end_m) == Approx(43.68).epsilon(0.001));
}

TEST_CASE("an exhaustive search over a grid agrees with the simplex method, for any number of levels") {
  const DetailFit fit = printed_fit();
  for (const std::uint32_t levels : {1U, 2U, 3U, 4U, 6U}) {
    const auto simplex = design_switches(fit, levels, end_m);
    const SwitchPlan grid = design_switches_by_grid(fit, levels, end_m, 800);
    REQUIRE(simplex.ok());
    CHECK(simplex->redundancy <= grid.redundancy * (1.0 + 1e-9));
    CHECK(simplex->redundancy == Approx(grid.redundancy).epsilon(0.005));
    for (std::size_t i = 1; i < levels; ++i) CHECK(simplex->switch_m[i] == Approx(grid.switch_m[i]).epsilon(0.05));
  }
  CHECK_FALSE(design_switches(fit, 0, end_m).ok());
  CHECK_FALSE(design_switches(fit, 17, end_m).ok());
  CHECK_FALSE(design_switches(fit, 3, 0.0).ok());
}

TEST_CASE("no switch lies beyond the last distance, however flat or steep the fit and short the range") {
  std::mt19937 random{11};
  const auto one = [&](double low, double high) {
    return low * std::pow(high / low, static_cast<double>(random() % 1000) / 999.0);
  };
  for (int i = 0; i < 30; ++i) {
    DetailFit fit;
    fit.a = one(1e-3, 1.0);
    fit.c = i % 3 == 0 ? 0.0 : one(1e-3, 1.0);
    fit.b = i % 5 == 0 ? 0.0 : -one(1e-7, 10.0);
    fit.d = i % 7 == 0 ? fit.b : -one(1e-7, 10.0);
    const double last_m = one(1e-3, 1e6);
    const auto levels = static_cast<std::uint32_t>(1 + i % 6);
    for (const SwitchPlan& plan :
         {*design_switches(fit, levels, last_m), design_switches_by_grid(fit, levels, last_m, 50),
          equal_intervals(fit, levels, one(1e-3, 1e6), last_m),
          exponential_intervals(fit, levels, 3.0, 50.0, last_m)}) {
      INFO(plan.name << ", fit " << fit.a << ' ' << fit.b << ' ' << fit.c << ' ' << fit.d << " to " << last_m);
      REQUIRE(plan.switch_m.size() == levels);
      CHECK(plan.switch_m.front() == 0.0);
      CHECK(plan.switch_m.back() <= last_m);
      CHECK(std::is_sorted(plan.switch_m.begin(), plan.switch_m.end()));
      CHECK(plan.redundancy >= -1e-9 * (1.0 + fit.integral(last_m)));
    }
  }
}

TEST_CASE("the optimum has less redundancy than every plan of Table 3") {
  const DetailFit fit = printed_fit();
  const double best = design_switches(fit, 4, end_m)->redundancy;
  for (const double interval_m : {100.0, 200.0, 300.0}) {
    CHECK(best < equal_intervals(fit, 4, interval_m, end_m).redundancy);
  }
  const SwitchPlan doubling = exponential_intervals(fit, 4, 2.0, 68.48, end_m);
  CHECK(doubling.switch_m[1] == Approx(136.92 - 68.48).epsilon(0.001));
  CHECK(doubling.switch_m[3] == Approx(547.84 - 68.48).epsilon(0.001));
  CHECK(best < doubling.redundancy);
  CHECK(best < exponential_intervals(fit, 4, 3.0, 68.48, end_m).redundancy);
}

TEST_CASE("more levels save less and less, and their number is chosen by that") {
  const DetailFit fit = printed_fit();
  double before = redundancy(fit, {0.0}, end_m);
  double gain_before = 1e300;
  for (std::uint32_t levels = 2; levels <= 6; ++levels) {
    const double now = design_switches(fit, levels, end_m)->redundancy;
    CHECK(now < before);
    CHECK(before - now <= gain_before * (1.0 + 1e-6));
    gain_before = before - now;
    before = now;
  }
  CHECK(choose_level_count(fit, end_m, 0.5) <= choose_level_count(fit, end_m, 0.3));
  CHECK(choose_level_count(fit, end_m, 2.0) == 1);
  CHECK(choose_level_count(fit, end_m) == 4);  // as many as the paper takes
}

TEST_CASE("the fit finds the paper's four numbers in their own samples, and says when it is poor") {
  const auto fit = fit_detail(samples_of(printed_fit(), 0.0));
  REQUIRE(fit.ok());
  CHECK(fit->a == Approx(0.5588).epsilon(1e-4));
  CHECK(fit->b == Approx(-0.09722).epsilon(1e-4));
  CHECK(fit->c == Approx(0.1908).epsilon(1e-4));
  CHECK(fit->d == Approx(-0.02061).epsilon(1e-4));
  CHECK(fit->r_square > 0.999999);
  CHECK(fit.warnings().empty());
  const auto noisy = fit_detail(samples_of(printed_fit(), 0.005));
  REQUIRE(noisy.ok());
  CHECK(noisy->r_square > 0.99);
  CHECK(noisy->rmse == Approx(0.005 * 0.5 / std::sqrt(2.0)).epsilon(0.2));
  const auto poor = fit_detail(samples_of(printed_fit(), 2.0));
  REQUIRE(poor.ok());
  CHECK(poor->r_square < 0.95);
  CHECK_FALSE(poor.warnings().empty());
  CHECK_FALSE(fit_detail({}).ok());
  auto broken = samples_of(printed_fit(), 0.0);
  broken[3].metric = std::nan("");
  CHECK_FALSE(fit_detail(broken).ok());
}

TEST_CASE("the error of a fit is over its degrees of freedom: the samples less four numbers") {
  std::vector<DetailSample> samples;
  for (const auto& sample : samples_of(printed_fit(), 0.05)) {
    if (samples.size() < 8 && std::fmod(sample.distance_m - 68.48, 20.0) < 1.0) samples.push_back(sample);
  }
  REQUIRE(samples.size() == 8);
  const auto fit = fit_detail(samples);
  REQUIRE(fit.ok());
  double sum = 0.0;
  for (const DetailSample& sample : samples) {
    sum += std::pow((*fit)(sample.distance_m - samples.front().distance_m) - sample.metric, 2.0);
  }
  REQUIRE(sum > 1e-6);
  CHECK(fit->rmse == Approx(std::sqrt(sum / 4.0)));
}

TEST_CASE("a fit falls even where the samples rise first, and says that it is poor") {
  std::vector<DetailSample> samples;
  for (int i = 0; i <= 60; ++i) {
    const double x = 5.0 * i;
    samples.push_back({50.0 + x, 0.6 * std::exp(-0.02 * x) - 0.5 * std::exp(-0.08 * x), {}});
  }
  const auto fit = fit_detail(samples);
  REQUIRE(fit.ok());
  CHECK(fit->a >= 0.0);
  CHECK(fit->c >= 0.0);
  for (double x = 0.0; x < 300.0; x += 10.0) CHECK((*fit)(x) >= (*fit)(x + 10.0));
  CHECK_FALSE(fit.warnings().empty());
  const auto plan = design_switches(*fit, 3, 5000.0);
  REQUIRE(plan.ok());
  CHECK(plan->redundancy >= 0.0);
}

TEST_CASE("sampling covers the range in order, evenly or where the metric changes, and falls with distance") {
  const VisionModel vision{Display{}};
  for (const Sampling sampling : {Sampling::EqualSteps, Sampling::Adaptive}) {
    const auto samples = sample_perceptual_metric({50.0, 1000.0, 40, sampling}, vision, shrinking);
    REQUIRE(samples.ok());
    REQUIRE(samples->size() == 40);
    CHECK(samples->front().distance_m == 50.0);
    CHECK(samples->back().distance_m == Approx(1000.0));
    CHECK(samples->front().metric <= 1.0);
    CHECK(samples->back().metric < 0.1 * samples->front().metric + 0.05);
    for (std::size_t i = 1; i < 40; ++i) CHECK((*samples)[i].distance_m > (*samples)[i - 1].distance_m);
  }
  CHECK_FALSE(sample_perceptual_metric({50.0, 40.0, 40, {}}, vision, shrinking).ok());
  const auto nothing = [](double) -> Result<ObjectPicture> {
    return ObjectPicture{Image{4, 4, 1, std::vector<std::uint8_t>(16, 255)}, std::vector<std::uint8_t>(16, 0)};
  };
  const auto unseen = sample_perceptual_metric({50.0, 100.0, 8, {}}, vision, nothing);
  REQUIRE_FALSE(unseen.ok());
  CHECK(unseen.error().message.find("from 50.000000 m: no pixel") == 0);
  CHECK(unseen.error().message.find("field of view too wide") != std::string::npos);
  std::atomic<bool> stop{true};
  Context context;
  context.cancel = &stop;
  const auto cancelled = sample_perceptual_metric({50.0, 100.0, 8, {}}, vision, shrinking, context);
  REQUIRE_FALSE(cancelled.ok());
  CHECK(cancelled.error().code == ErrorCode::Cancelled);
}
