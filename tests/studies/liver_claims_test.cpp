#include "studies/liver_claims.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "problems/oscillator/liver_problems.hpp"

namespace hmax {
namespace {

const Claim& find(const std::vector<Claim>& claims, std::string_view words) {
  const auto claim = std::ranges::find_if(
      claims, [&](const Claim& each) { return each.printed.find(words) != std::string::npos; });
  EXPECT_NE(claim, claims.end()) << words;
  return claim == claims.end() ? claims.front() : *claim;
}

TEST(LiverClaims, OnMotionAreJudgedByRuns) {
  const std::vector<Claim> claims = claims_on_motion();
  const auto judgement = [&](std::string_view words) { return find(claims, words).judgement; };
  // exp(-c t / (2 m)): heavier and less damped ones settle later, at every stiffness alike.
  EXPECT_EQ(judgement("When the mass of the body is large"), Judgement::holds);
  EXPECT_EQ(judgement("the larger the damping coefficient"), Judgement::holds);
  EXPECT_EQ(judgement("as the stiffness increases, the amplitude"), Judgement::holds);
  // Not with c <= 0, and not without swinging.
  EXPECT_EQ(judgement("will always oscillate to a stabilized"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("never reach a resting point"), Judgement::holds_in_part);
  // c^2 <= 4 k1 m or not.
  EXPECT_EQ(judgement("clockwise direction"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("[with c=-0.2]"), Judgement::holds);
  EXPECT_EQ(judgement("unconditionally stable"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("where c=10"), Judgement::does_not_hold);
  EXPECT_EQ(judgement("oscillate periodically after"), Judgement::holds);
  EXPECT_EQ(judgement("critical damping within 0-5"), Judgement::holds_in_part);
  EXPECT_EQ(judgement("more overdamped than the forced"), Judgement::does_not_hold);
  for (const Claim& claim : claims) {
    EXPECT_EQ(claim.found.find("nan"), std::string::npos) << claim.found;
    EXPECT_FALSE(claim.section.empty());
  }
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
  const std::vector<Claim> first = claims_on_solvers(rows_of(as_printed)),
                           second = claims_on_solvers(rows_of(otherwise));
  ASSERT_EQ(first.size(), second.size());
  constexpr std::string_view slower = "computational time is higher";
  EXPECT_EQ(find(first, slower).judgement, Judgement::holds);
  EXPECT_EQ(find(second, slower).judgement, Judgement::does_not_hold);
  EXPECT_NE(find(first, slower).found, find(second, slower).found);
  EXPECT_EQ(find(first, "MATLAB ode45 is the fastest").judgement, Judgement::holds);
  EXPECT_EQ(find(second, "MATLAB ode45 is the fastest").judgement, Judgement::holds_in_part);
  EXPECT_EQ(find(first, "proportional to the number of iterations").judgement, Judgement::does_not_hold);
  // These follow from the methods, not from the rows.
  EXPECT_EQ(find(first, "most constant and stable").judgement, Judgement::does_not_hold);
  EXPECT_EQ(find(first, "increases the stability").judgement, Judgement::holds);
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
