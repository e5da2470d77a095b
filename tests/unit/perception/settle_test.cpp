// SPDX-License-Identifier: MIT
// Plans on a model whose levels come in steps.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include <lodestone/edge_collapse.h>
#include <lodestone/perception.h>

#include "shapes.h"

using namespace lodestone;

namespace {

constexpr double first_m = 4.0;
constexpr double last_m = 2000.0;
constexpr double focal_px = 1700.0;

const ProgressiveModel& model() {
  static const auto built = build_by_edge_collapse(test::sphere(48, 96));
  REQUIRE(built.ok());
  return *built->model;
}

DetailFit steep() {
  DetailFit fit;
  fit.a = 0.7;
  fit.b = -0.5;
  fit.c = 0.2;
  fit.d = -0.1;
  return fit;
}

SwitchPlan costed(std::vector<double> switch_m) {
  SwitchPlan plan;
  plan.name = "as designed";
  plan.switch_m = std::move(switch_m);
  add_cost(plan, model(), first_m, last_m, focal_px);
  return plan;
}

}  // namespace

TEST_CASE("the cost of a plan is equation 18: triangles times the distances at which they are drawn") {
  const SwitchPlan plan = costed({0.0, 30.0, 500.0});
  const auto triangles = [](double beyond_m, double allowed_px) {
    return model().info(model().level_of_error(allowed_px * (first_m + beyond_m) / focal_px)).triangles;
  };
  const double by_hand = first_m * model().triangle_count() + 30.0 * triangles(0.0, 0.5) +
                         470.0 * triangles(30.0, 0.5) + 1500.0 * triangles(500.0, 0.5);
  CHECK(plan.cost == Approx(by_hand));
  REQUIRE(triangles(30.0, 0.5) != triangles(30.0, 2.0));
  SwitchPlan coarser = plan;
  coarser.allowed_px = 2.0;
  add_cost(coarser, model(), first_m, last_m, focal_px);
  CHECK(coarser.triangles[1] == triangles(30.0, 2.0));
}

TEST_CASE("switches that stand badly settle where the model's levels save most, as an exhaustive search finds") {
  const double designed_m = 0.5;  // far too near: hardly anything is coarser there
  SwitchPlan plan = costed({0.0, designed_m});
  const double before = plan.cost;
  settle_switches(plan, steep(), model(), first_m, last_m, focal_px);
  double least = before;
  double least_of_400 = before;  // as many places as settling tries
  for (int k = 1; k < 4000; ++k) {
    const double cost = costed({0.0, first_m * std::expm1(std::log1p(last_m / first_m) * k / 4000)}).cost;
    least = std::min(least, cost);
    if (k % 10 == 0) least_of_400 = std::min(least_of_400, cost);
  }
  REQUIRE(least < 0.7 * before);
  CHECK(plan.cost <= 1.01 * least);
  CHECK(plan.cost == Approx(costed(plan.switch_m).cost));
  CHECK(plan.redundancy == Approx(redundancy(steep(), plan.switch_m, last_m)));
  CHECK(plan.name != "as designed");
  CHECK(plan.switch_m[0] == 0.0);

  // A move must save a hundredth: one that saves 1.2 % is made, one that saves 0.8 % is not.
  const auto dearer = [&](double share) {
    for (int k = 1; k < 40'000; ++k) {
      const SwitchPlan found = costed({0.0, designed_m + 0.05 * k});
      const double saved = 1.0 - least_of_400 / found.cost;
      if (saved >= share && saved < share + 0.002) return found;
    }
    FAIL("no such plan");
    return plan;
  };
  for (const auto& [share, moves] : {std::pair{0.0105, true}, std::pair{0.0075, false}}) {
    SwitchPlan near_best = dearer(share);
    const SwitchPlan as_it_was = near_best;
    settle_switches(near_best, steep(), model(), first_m, last_m, focal_px);
    CHECK((near_best.switch_m != as_it_was.switch_m) == moves);
  }

  // A plan that stands well already is left as it is.
  SwitchPlan again = plan;
  settle_switches(again, steep(), model(), first_m, last_m, focal_px);
  CHECK(again.switch_m == plan.switch_m);

  // Several: no further move of one switch may save a hundredth.
  SwitchPlan many = costed({0.0, 0.2, 0.4, 0.8});
  settle_switches(many, steep(), model(), first_m, last_m, focal_px);
  CHECK(std::is_sorted(many.switch_m.begin(), many.switch_m.end()));
  REQUIRE(many.switch_m.size() == 4);
  for (std::size_t i = 1; i < 4; ++i) {
    for (int k = 1; k < 400; ++k) {
      auto moved = many.switch_m;
      moved[i] = first_m * std::expm1(std::log1p(last_m / first_m) * k / 400);
      std::sort(moved.begin(), moved.end());
      CHECK(costed(moved).cost > 0.985 * many.cost);
    }
  }
}
