#include "studies/liver_claims.hpp"

#include <algorithm>
#include <cmath>

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
  EXPECT_EQ(judgement("mass_prolongs"), Judgement::holds);
  EXPECT_EQ(judgement("damping_stops"), Judgement::holds);
  EXPECT_EQ(judgement("stiffness_lowers"), Judgement::holds);
  // Not with c <= 0, and not without swinging.
  EXPECT_EQ(judgement("always_settles"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("never_rests"), Judgement::holds_in_part);
  // c^2 <= 4 k1 m or not.
  EXPECT_EQ(judgement("clockwise"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("negative_damping"), Judgement::holds);
  EXPECT_EQ(judgement("no_damping"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("damping_of_10"), Judgement::does_not_hold);
  EXPECT_EQ(judgement("forced_periodically"), Judgement::holds);
  EXPECT_EQ(judgement("forced_critically"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("benchmark_is_overdamped"), Judgement::does_not_hold);
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
  const Claims first = claims_on_solvers(rows_of(as_printed)), second = claims_on_solvers(rows_of(otherwise));
  ASSERT_EQ(first.size(), second.size());
  constexpr const char* slower = "euler_is_slower";
  EXPECT_EQ(judgement_of(first, slower), Judgement::holds);
  EXPECT_EQ(judgement_of(second, slower), Judgement::does_not_hold);
  EXPECT_NE(first[slower]["ratio"], second[slower]["ratio"]);
  EXPECT_EQ(judgement_of(first, "ode45_is_fastest"), Judgement::holds);
  EXPECT_EQ(judgement_of(second, "ode45_is_fastest"), Judgement::holds_in_part);
  EXPECT_EQ(judgement_of(first, "steps_and_iterations"), Judgement::does_not_hold);
  // These follow from the methods, not from the rows.
  EXPECT_EQ(judgement_of(first, "euler_is_most_stable"), Judgement::does_not_hold);
  EXPECT_EQ(judgement_of(first, "implicit_is_more_stable"), Judgement::holds);
}

TEST(LiverClaims, HoldWithoutRows) { EXPECT_NO_THROW(claims_on_solvers({})); }

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
}

}  // namespace
}  // namespace hmax
