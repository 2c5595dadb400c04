#include "studies/liver_claims.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "problems/oscillator/liver_problems.hpp"

namespace hmax {
namespace {

std::string judgement_of(const Claims& claims, const char* name) { return claims.at(name).at("judgement"); }

/// Every number of a claim, in arrays too.
void expect_numbers(const Claims& value, const std::string& name) {
  if (value.is_number()) {
    EXPECT_FALSE(std::isnan(value.get<double>())) << name;
  }
  if (value.is_structured())
    for (const auto& [field, inner] : value.items()) expect_numbers(inner, name + " " + field);
}

TEST(LiverClaims, OnMotionAreJudgedByRuns) {
  const Claims claims = claims_on_motion();
  const auto judgement = [&](const char* name) { return judgement_of(claims, name); };
  // exp(-c t / (2 m)): heavier and less damped ones settle later, at every stiffness alike.
  EXPECT_EQ(judgement("mass_prolongs"), Judged::holds);
  EXPECT_EQ(judgement("damping_stops"), Judged::holds);
  EXPECT_EQ(judgement("stiffness_lowers"), Judged::holds);
  // Not with c <= 0, and not without swinging.
  EXPECT_EQ(judgement("always_settles"), Judged::holds_in_part);
  EXPECT_EQ(judgement("never_rests"), Judged::holds_in_part);
  // c^2 <= 4 k1 m or not.
  EXPECT_EQ(judgement("clockwise"), Judged::holds_in_part);
  EXPECT_EQ(judgement("negative_damping"), Judged::holds);
  EXPECT_EQ(judgement("no_damping"), Judged::holds_in_part);
  EXPECT_EQ(judgement("damping_of_10"), Judged::does_not_hold);
  EXPECT_EQ(judgement("forced_periodically"), Judged::holds);
  EXPECT_EQ(judgement("forced_critically"), Judged::holds_in_part);
  EXPECT_EQ(judgement("benchmark_is_overdamped"), Judged::does_not_hold);
  expect_numbers(claims, "");
}

/// Rows of the five solvers; `slow` is what each costs for a step [s].
std::vector<Row> rows_of(const std::vector<std::pair<std::string, double>>& slow) {
  std::vector<Row> rows;
  for (const double h : liver_step_sizes)
    for (const auto& [method, cost] : slow)
      for (const char* mode : {"fixed", "sampled"}) {
        const bool fixed = mode == std::string_view("fixed");
        if (fixed ? method == "adams_pece" : method == "explicit_euler") continue;
        Row row;
        row.key.method = method;
        row.key.mode = mode;
        row.key.h = h;
        row.outcome = "reached_end";
        row.steps = std::lround(fixed ? 100 / h : 50);
        row.cpu_s = {cost * (fixed ? 100 / h : 100)};
        row.error_global = fixed ? 1e-3 * h : 1e-6;
        rows.push_back(row);
      }
  return rows;
}

TEST(LiverClaims, OnSolversFollowTheRows) {
  const std::vector<std::pair<std::string, double>> as_printed{{"explicit_euler", 1e-5},
                                                               {"dormand_prince_54", 1e-6},
                                                               {"rosenbrock_23", 2e-6},
                                                               {"adams_pece", 3e-6},
                                                               {"trapezoidal", 5e-3}};
  std::vector<std::pair<std::string, double>> otherwise = as_printed;
  otherwise[0].second = 1e-9;
  const Claims first = claims_on_solvers(rows_of(as_printed), {}),
               second = claims_on_solvers(rows_of(otherwise), {});
  ASSERT_EQ(first.size(), second.size());
  constexpr const char* slower = "euler_is_slower";
  EXPECT_EQ(judgement_of(first, slower), Judged::holds);
  EXPECT_EQ(judgement_of(second, slower), Judged::does_not_hold);
  EXPECT_NE(first[slower]["ratio"], second[slower]["ratio"]);
  EXPECT_EQ(judgement_of(first, "ode45_is_fastest"), Judged::holds);
  EXPECT_EQ(judgement_of(second, "ode45_is_fastest"), Judged::holds_in_part);
  EXPECT_EQ(judgement_of(first, "steps_and_iterations"), Judged::does_not_hold);
  // These follow from the methods, not from the rows.
  EXPECT_EQ(judgement_of(first, "euler_is_most_stable"), Judged::does_not_hold);
  EXPECT_EQ(judgement_of(first, "implicit_is_more_stable"), Judged::holds);
}

/// Work of the three solvers that sentences on accuracy compare, with these errors at both tolerances.
std::vector<SolverWork> work_of(double default_113, double tight_113) {
  std::vector<SolverWork> work;
  for (const auto& [method, by_default, tight] : {std::tuple{"dormand_prince_54", 5e-4, 1e-6},
                                                  {"rosenbrock_23", 2e-3, 4e-5},
                                                  {"adams_pece", default_113, tight_113}}) {
    work.push_back({.method = method, .rtol = 1e-3, .atol = 1e-6, .error = by_default});
    work.push_back({.method = method, .rtol = 1e-6, .atol = 1e-6, .error = tight});
  }
  return work;
}

TEST(LiverClaims, OnAccuracyAreJudgedAtTheTolerancesThatWereInForce) {
  const auto judgement = [](double by_default, double tight) {
    return judgement_of(claims_on_solvers({}, work_of(by_default, tight)), "ode113_is_accurate");
  };
  EXPECT_EQ(judgement(1e-4, 1e-5), Judged::holds);  // whatever tighter tolerances say
  EXPECT_EQ(judgement(1e-3, 1e-9), Judged::does_not_hold);
}

TEST(LiverClaims, OnRealTimeCompareTheTimeOfARunWithTheMotion) {
  const std::vector<std::pair<std::string, double>> costs{{"explicit_euler", 1e-6},
                                                          {"dormand_prince_54", 1e-6},
                                                          {"rosenbrock_23", 2e-6},
                                                          {"adams_pece", 3e-6},
                                                          {"trapezoidal", 5}};
  const Claims claims = claims_on_solvers(rows_of(costs), {});
  // 10,000 steps of 1 us in 100 s; outputs that take 3 us, and 5 s.
  EXPECT_NEAR(claims["euler_is_no_real_time"]["at_frame"].get<double>(), 1e4, 1);
  EXPECT_EQ(judgement_of(claims, "euler_is_no_real_time"), Judged::does_not_hold);
  EXPECT_EQ(judgement_of(claims, "ode113_is_no_real_time"), Judged::does_not_hold);
  EXPECT_EQ(judgement_of(claims, "ode23t_is_no_real_time"), Judged::holds);
  EXPECT_NEAR(claims["ode113_is_less_efficient"]["slower"].get<double>(), 3, 1e-9);
  EXPECT_NEAR(claims["ode23s_is_not_best"]["slower"].get<double>(), 2, 1e-9);
  // Twice the cost of a step and the same error: no gain.
  EXPECT_EQ(judgement_of(claims, "ode23s_beats_euler"), Judged::does_not_hold);
}

TEST(LiverClaims, HoldWithoutRows) { EXPECT_NO_THROW(claims_on_solvers({}, {})); }

TEST(WorkAtDefaults, IsLessAndWorseThanThatOfTheReport) {
  const std::vector<SolverWork> all = work_at_defaults();
  ASSERT_EQ(all.size(), 8U);
  for (std::size_t i = 0; i < all.size(); i += 2) {
    EXPECT_EQ(all[i].method, all[i + 1].method);
    EXPECT_EQ(all[i].rtol, 1e-3);
    EXPECT_LT(all[i].stats.steps, all[i + 1].stats.steps) << all[i].method;
    EXPECT_GT(all[i].error, 10 * all[i + 1].error) << all[i].method;
    EXPECT_LT(all[i].error, 0.1) << all[i].method;
  }
  // What the report says of ode113 at MATLAB's defaults.
  const auto error_of = [&](const char* method) {
    return std::ranges::find(all, method, &SolverWork::method)->error;
  };
  EXPECT_LT(error_of("adams_pece"), error_of("dormand_prince_54"));
  EXPECT_LT(error_of("dormand_prince_54"), error_of("rosenbrock_23"));
}

}  // namespace
}  // namespace hmax
