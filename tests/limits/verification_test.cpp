#include "limits/verification.hpp"

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

/// The states that a run from rest shows after a displacement of the liver model without its cubic spring.
std::vector<Eigen::VectorXd> shown(const char* method, double force, double h, std::int64_t steps) {
  const Problem problem = make_problem("liver_forced", {.parameters = {{"k3", 0}, {"P", force}}});
  std::vector<Eigen::VectorXd> states;
  const auto outcome = std::make_shared<Outcome>();
  const ShowSteps run =
      steps_of(find_method(method), problem, Eigen::Vector2d(0, 0), Eigen::Vector2d(1, -0.5), outcome);
  EXPECT_TRUE(run(h, steps, [&](const auto& y) { states.emplace_back(y); }));
  return states;
}

/// The force adds the same motion to every start: what is left of a linear model is its free motion, to the
/// last step.
TEST(StepsOf, OfADrivenModelShowItsFreeMotionToTheEnd) {
  for (const char* method : {"rk4", "newmark"}) {
    const auto driven = shown(method, 3, 0.01, 40), free = shown(method, 0, 0.01, 40);
    ASSERT_EQ(driven.size(), 41U);
    ASSERT_EQ(free.size(), 41U);
    for (std::size_t i = 0; i < free.size(); ++i)
      EXPECT_LT((driven[i] - free[i]).norm(), 1e-9 * free[0].norm()) << method << " " << i;
  }
}

/// Runs of one method beside the limit of another: both sides must be as predicted.
TEST(Verify, DisagreesWhereOneSideOfALimitAloneIsAsPredicted) {
  const Problem problem = make_problem("liver_linear", {.parameters = {{"c", 1.5}}});
  const Linearised near = linearised(problem);
  const auto agrees = [&](const char* code, const char* claim) {
    Method method = find_method(code);
    method.amplification = find_method(claim).amplification;
    Prediction row = predict(method, near);
    verify(row, method, problem, near);
    return row.observed.value().agrees;
  };
  EXPECT_TRUE(agrees("rk4", "rk4"));
  EXPECT_FALSE(agrees("rk4", "explicit_euler")) << "nothing grows above";
  EXPECT_FALSE(agrees("explicit_euler", "rk4")) << "the motion grows below already";
}

Prediction verified_row(const Problem& problem, const char* method) {
  const Linearised near = linearised(problem);
  Prediction row = predict(find_method(method), near);
  verify(row, find_method(method), problem, near);
  return row;
}

TEST(Verify, KeepsWhatWasSaidOfARow) {
  const Linearised near = linearised(make_problem("liver_linear"));
  const Method method = find_method("implicit_euler");
  const auto note_of = [&](double growth) {
    Prediction row = predict(method, near);
    row.note = "first";
    ModeStart start;
    start.distance = [](const auto& y) { return y.norm(); };
    const ShowSteps run = [&](double, std::int64_t steps, const auto& show) {
      Eigen::VectorXd y = Eigen::Vector2d(1, 1);
      for (std::int64_t i = 0; i <= steps; ++i, y *= growth) show(y);
      return true;
    };
    verify_from(start, run, row, method, near, {.h = {1}, .most = 40, .note = "second"});
    return row.note;
  };
  EXPECT_EQ(note_of(1), "first; second");
  EXPECT_EQ(note_of(2).rfind("first; second; no step is unstable by the analysis, but", 0), 0U) << note_of(2);
}

/// x'' = -f(x), at rest at 0.
Prediction verified_spring(const std::string& f) {
  const Scratch scratch;
  write_text(scratch / "spring.toml",
             "[equations]\nx = \"v\"\nv = \"-(" + f + ")\"\n[initial]\nx = 0\nv = 0\n");
  return verified_row(make_problem(scratch / "spring.toml"), "rk4");
}

TEST(Verify, MovesByLittleEnoughForTheModelToBeLinear) {
  for (const char* f : {"x + x^3", "x + 1e18*x^3", "x + 1e24*x^3"}) {
    const Prediction row = verified_spring(f);
    ASSERT_TRUE(row.observed) << f;
    EXPECT_TRUE(row.observed->confirms()) << f << ": " << row.note;
  }
}

TEST(Verify, OfAKinkAtRestIsNoContradiction) {
  const Prediction row = verified_spring("x + max(0, x)");
  ASSERT_TRUE(row.observed);
  EXPECT_FALSE(row.observed->agrees);
  EXPECT_FALSE(row.observed->contradicts()) << row.note;
  EXPECT_NE(row.note.find("not verified: the model is not linear"), std::string::npos) << row.note;
}

/// A + B + C is conserved: one eigenvalue is zero, but for rounding.
TEST(Verify, TakesAnEigenvalueOfRoundingForNoTimeScale) {
  const Scratch scratch;
  write_text(scratch / "reaction.toml",
             "[equations]\nA = \"-0.31*A + 0.13*B\"\nB = \"0.31*A - 0.13*B - 170.7*B + 3.3*C\"\n"
             "C = \"170.7*B - 3.3*C\"\n[initial]\nA = 1\nB = 0.5\nC = 0.2\n");
  const Problem reaction = make_problem(scratch / "reaction.toml");
  for (const char* method : {"implicit_euler", "trapezoidal", "implicit_midpoint", "rosenbrock_23"}) {
    const Prediction row = verified_row(reaction, method);
    EXPECT_EQ(row.bound, Bound::accuracy) << method;
    ASSERT_TRUE(row.observed) << method;
    EXPECT_TRUE(row.observed->confirms()) << method << ": " << row.note;
  }
}

}  // namespace
}  // namespace hmax
