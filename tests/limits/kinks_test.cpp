#include "limits/kinks.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/largest_stable_step.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

Problem decaying(const std::string& rate, double start) {
  return make_problem({.name = "decay", .equations = {{"x", rate}}, .y0 = {start}}, "decay.toml");
}

// At rest the formula takes the slow side; explicit Euler is stable on the fast one up to 2 / 5.
TEST(Kinks, HaveTheLimitOfTheirStiffestSideWhicheverTheCodeTakes) {
  for (const char* rate : {"-(x>0 ? 5*x : 3*x)", "-(x<0 ? 5*x : 3*x)", "-4*x - abs(x)"})
    for (const double start : {0.0, 0.5, -0.5}) {
      const Linearised near = linearised(decaying(rate, start));
      EXPECT_NEAR(predict(find_method("explicit_euler"), near).h_max.value(), 0.4, 1e-9) << rate << start;
      EXPECT_TRUE(near.point.at_kink) << rate << start;
      EXPECT_EQ(near.point.model.y[0], 0);
    }
}

TEST(Kinks, AreNotSeenInWhatBendsSmoothly) {
  for (const char* rate :
       {"-x - 1e18*x^3", "-tanh(1e4*x)", "-x*exp(x)", "1 - x - 1e3*x^2", "-x - 1e9*max(x, 0)^1.5"}) {
    const Linearised near = linearised(decaying(rate, 0));
    ASSERT_TRUE(near.point.at_equilibrium) << rate;
    EXPECT_FALSE(near.point.at_kink) << rate;
  }
}

// The reach in a displacement is that of the pressure beside it.
TEST(Kinks, AreNotSeenBesideLargeStatesOfAnotherUnit) {
  const Linearised near = linearised(make_problem(
      {.name = "gas",
       .equations = {{"x", "v"}, {"v", "-100*x - 4e8*x^3 - 2*v + 0.01*(p - 1e5)"}, {"p", "(1e5 - p)/0.1"}},
       .y0 = {1e-3, 0, 1e5}},
      "gas.toml"));
  ASSERT_TRUE(near.point.at_equilibrium);
  EXPECT_FALSE(near.point.at_kink);
}

// Central differences are none across a kink that is near, though the state has one slope.
TEST(Kinks, NearAStateAreSeenWithinReach) {
  const Problem stop = decaying("-x - (x > 1 + 2e-6 ? 100*(x - 1 - 2e-6) : 0)", 1);
  const Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
  EXPECT_EQ(kinks_at(stop, 0, y, 1, KinkPlace::within_reach).size(), 1U);
  EXPECT_TRUE(kinks_at(stop, 0, y, 1, KinkPlace::at_state).empty());
}

// Each of two stops is met on one side; both together are the stiffest.
TEST(Kinks, OfSeveralStopsTakeTheSideOfAll) {
  const Problem stops = make_problem({.name = "stops",
                                      .equations = {{"x", "v"},
                                                    {"v", "-100*x - (x<0 ? 1e4*x : 0) - 0.2*v"},
                                                    {"y", "w"},
                                                    {"w", "-100*y - (y>0 ? 3e4*y : 0) - 0.2*w"}},
                                      .y0 = {0, 0, 0, 0}},
                                     "stops.toml");
  const Linearised near = linearised(stops);
  const Eigen::MatrixXd K = dense(near.point.model.mechanical->K);
  EXPECT_EQ(K(0, 0), 10100);
  EXPECT_EQ(K(1, 1), 30100);
}

/// x' = -5 x, or -3 x below zero, without a Jacobian.
struct Bent {
  using State = Eigen::VectorXd;
  static constexpr bool autonomous = true;
  [[nodiscard]] Eigen::Index dim() const { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt[0] = (y[0] > 0 ? -5 : -3) * y[0]; }
};

// Central differences are the mean of both sides, the Jacobian of neither.
TEST(Kinks, AreSeenThroughDifferencesToo) {
  for (const double start : {0.0, 0.5}) {
    const StepAnswer answer = largest_stable_step(
        "explicit_euler", AnySystem(Bent{}), Eigen::VectorXd::Constant(1, start), {.find_equilibrium = true});
    EXPECT_NEAR(answer.h_max, 0.4, 1e-6);
    EXPECT_TRUE(says(answer.status, at_a_kink));
  }
}

}  // namespace
}  // namespace hmax
