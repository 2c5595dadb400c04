/// The rules of step-size control against numbers worked out by hand.
#include "integrators/controller.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "core/numbers.hpp"
#include "integrators/control.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Controllers take the square of the error.
template <class Controller>
Verdict<double> judge(Controller& controller, double error, double h = 1) {
  return controller.judge(error * error, h);
}

template <class Controller>
struct EveryController : testing::Test {};
using Controllers = testing::Types<IntegralController<double>, PiController<double>,
                                   DeadbandController<double>, MatlabController<double>>;
TYPED_TEST_SUITE(EveryController, Controllers);

TYPED_TEST(EveryController, AcceptsAnErrorOfOneAndNoMore) {
  TypeParam controller(5);
  EXPECT_TRUE(judge(controller, 1).accept);
  EXPECT_FALSE(judge(controller, 1 + 1e-12).accept);
}

TYPED_TEST(EveryController, RejectsWhatIsNotANumberAndShrinks) {
  for (const double error : {not_a_number, infinity, 1e200}) {
    TypeParam controller(5);
    const Verdict<double> verdict = judge(controller, error, 0.5);
    EXPECT_FALSE(verdict.accept) << error;
    EXPECT_GT(verdict.h_next, 0) << error;
    EXPECT_LE(verdict.h_next, 0.25) << error;
  }
}

TYPED_TEST(EveryController, GrowsByAtMostFiveWhenNothingIsWrong) {
  TypeParam controller(5);
  const double factor = judge(controller, 0, 0.25).h_next / 0.25;
  EXPECT_GT(factor, 3);
  EXPECT_LE(factor, 5);
}

TYPED_TEST(EveryController, ShrinksAfterEveryRejection) {
  TypeParam controller(5);
  double h = 1;
  for (const double error : {1.0000001, 1.5, 3.0, 1e3, 1e30}) {
    const Verdict<double> verdict = judge(controller, error, h);
    EXPECT_FALSE(verdict.accept);
    EXPECT_LT(verdict.h_next, h);
    EXPECT_GE(verdict.h_next, 0.1 * h);
    h = verdict.h_next;
  }
}

TEST(IntegralController, FollowsTheElementaryFormula) {
  IntegralController<double> controller(5);
  EXPECT_DOUBLE_EQ(judge(controller, 1.0 / 32).h_next, 1.8);  // 0.9 (1/32)^(-1/5)
  EXPECT_DOUBLE_EQ(judge(controller, 1).h_next, 0.9);
  EXPECT_DOUBLE_EQ(judge(controller, 32).h_next, 0.45);
  EXPECT_DOUBLE_EQ(judge(controller, 1.0 / 32).h_next, 1) << "no growth right after a rejection";
  EXPECT_DOUBLE_EQ(judge(controller, 1.0 / 32).h_next, 1.8);
  EXPECT_DOUBLE_EQ(judge(controller, 1e9).h_next, 0.2);
}

TEST(PiController, WeighsTheErrorBefore) {
  PiController<double> controller(5);
  // 0.9 (1/32)^(-0.7/5) with an error before of 1, then with one of 1/32.
  EXPECT_NEAR(judge(controller, 1.0 / 32).h_next, 0.9 * std::exp2(0.7), 1e-14);
  EXPECT_NEAR(judge(controller, 1.0 / 32).h_next, 0.9 * std::exp2(0.7 - 0.4), 1e-14);
  EXPECT_NEAR(judge(controller, 32).h_next, 0.45, 1e-14) << "a rejection follows the elementary formula";
  EXPECT_DOUBLE_EQ(judge(controller, 1.0 / 32).h_next, 1);
}

TEST(DeadbandController, LeavesTheStepAloneWhileTheErrorIsInItsBand) {
  DeadbandController<double> controller(5);
  EXPECT_EQ(judge(controller, 0.799, 0.3).h_next, 0.3);
  EXPECT_EQ(judge(controller, 0.401, 0.3).h_next, 0.3);
  EXPECT_NEAR(judge(controller, 1, 0.3).h_next, 0.27, 1e-6) << "accepted, but on its way to a rejection";
  EXPECT_NEAR(judge(controller, 1.0 / 32, 0.3).h_next, 0.54, 1e-6);
  EXPECT_NEAR(judge(controller, 32, 0.3).h_next, 0.135, 1e-6);
}

TEST(MatlabController, HalvesAfterTheFirstFailureAndDoesNotGrowRightAfter) {
  MatlabController<double> controller(5);
  EXPECT_DOUBLE_EQ(judge(controller, 1.0 / 32).h_next, 1.6);  // 0.8 (1/32)^(-1/5)
  EXPECT_DOUBLE_EQ(judge(controller, 32).h_next, 0.4);        // the first failure: the formula
  EXPECT_DOUBLE_EQ(judge(controller, 32, 0.4).h_next, 0.2);   // further ones: half
  EXPECT_DOUBLE_EQ(judge(controller, 1e9, 0.2).h_next, 0.1);
  EXPECT_DOUBLE_EQ(judge(controller, 1.0 / 32, 0.1).h_next, 0.1);  // not larger after a failure
  EXPECT_DOUBLE_EQ(judge(controller, 1.0 / 32, 0.1).h_next, 0.16);
  EXPECT_DOUBLE_EQ(judge(controller, 1e9).h_next, 0.1) << "the first failure shrinks to a tenth at most";
}

using One = Eigen::Matrix<double, 1, 1>;
const auto decay = system_of<One>([](double, const One& y, One& dydt) { dydt[0] = -2 * y[0]; });

/// The first proposal of MATLAB's rules for ode45 on y' = -2 y.
Proposal<double> first_matlab_step(double length, double rtol, double atol, double y0) {
  Adaptive<double, MatlabController, MatlabNorm> control({rtol, atol}, 5);
  int no_stepper = 0;
  control.start(no_stepper, decay, Span<double>{1, 1 + length}, One(y0));
  return control.propose(1);
}

TEST(MatlabRules, ChooseTheFirstStepFromTheSlope) {
  // rate = |f| / max(|y|, atol / rtol) = 2, h = 0.8 rtol^(1/5) / 2.
  EXPECT_NEAR(first_matlab_step(100, 1e-5, 1e-6, 3).h, 0.04, 1e-15);
  // The threshold atol / rtol = 0.1 is above |y| = 0.05: the rate is 1, the step twice as large.
  EXPECT_NEAR(first_matlab_step(100, 1e-5, 1e-6, 0.05).h, 0.08, 1e-15);
}

TEST(MatlabRules, BoundTheStepByATenthOfTheSpan) {
  EXPECT_DOUBLE_EQ(first_matlab_step(0.2, 1e-5, 1e-6, 3).h, 0.02);
  EXPECT_DOUBLE_EQ(first_matlab_step(0.2, 1e-5, 1e-6, 0).h, 0.02) << "a slope of zero";
}

TEST(FirstStep, DoesNotDependOnWhereTimeBegins) {
  // From rest at 0, where a millionth of the span is the first guess: y' = 4 whatever t.
  const auto steady = system_of<One>([](double, const One&, One& dydt) { dydt[0] = 4; });
  const auto first = [&](double t0, double length) {
    Adaptive<double, IntegralController, RmsNorm> control({1e-5, 1e-6}, 5);
    int no_stepper = 0;
    control.start(no_stepper, steady, Span<double>{t0, t0 + length}, One(0.0));
    return control.propose(t0).h;
  };
  for (const double t0 : {-8.0, -4.0, 16.0}) {
    EXPECT_EQ(first(t0, 8), first(0, 8)) << t0;
    EXPECT_EQ(first(t0, -8), -first(0, 8)) << t0;
  }
}

TEST(MatlabRules, StretchTheLastStepByATenth) {
  Adaptive<double, MatlabController, MatlabNorm> control({1e-5, 1e-6}, 5);
  int no_stepper = 0;
  control.start(no_stepper, decay, Span<double>{0, 1}, One(3.0));  // h = 0.04
  EXPECT_FALSE(control.propose(1 - 0.0441).last);
  const Proposal<double> last = control.propose(1 - 0.0439);
  EXPECT_TRUE(last.last);
  EXPECT_EQ(last.t_next, 1);
  EXPECT_NEAR(last.h, 0.0439, 1e-15);
}

TEST(MatlabNorm, IsTheLargestErrorInUnitsOfTheTolerance) {
  const MatlabNorm<double> norm{1e-2, 1e-3};
  const Eigen::Vector3d y(1, -5, 0), y_new(2, -4, 0.01), error(0.01, 0.04, 0.0005);
  const auto component = [&](Eigen::Index i) { return error[i]; };
  // 0.01 / 0.02, 0.04 / 0.05, 0.0005 / 0.001: the second rules.
  EXPECT_DOUBLE_EQ(norm.squared(y, y_new, component), 0.64);
  const auto broken = [&](Eigen::Index i) { return i == 0 ? not_a_number : error[i]; };
  EXPECT_TRUE(std::isnan(norm.squared(y, y_new, broken)));
}

TEST(RmsNorm, IsTheRootMeanSquareInUnitsOfTheTolerance) {
  const RmsNorm<double> norm{1, 1};
  const Eigen::Vector2d y(1, -2), y_new(3, 0), error(2, 6);
  // weights 1 + 3 and 1 + 2: ((2 / 4)^2 + (6 / 3)^2) / 2
  EXPECT_DOUBLE_EQ(norm.squared(y, y_new, [&](Eigen::Index i) { return error[i]; }), 2.125);
}

/// The sum of squares of some numbers, and the norm's.
void expect_sum(Eigen::Index n, double (*sum_of)(const Eigen::VectorXd& squares)) {
  const Eigen::VectorXd y = Eigen::VectorXd::Zero(n),
                        error = Eigen::VectorXd::LinSpaced(n, 1, 1e3).cwiseInverse();
  EXPECT_EQ(RmsNorm<double>({0, 1}).squared(y, y, [&](Eigen::Index i) { return error[i]; }),
            sum_of(error.cwiseAbs2()) / static_cast<double>(n))
      << n;
}

TEST(RmsNorm, AddsUpPiecesOf256NumbersOneAfterTheOther) {
  const auto one_by_one = [](const Eigen::VectorXd& squares) {
    double sum = 0;
    for (const double each : squares) sum += each;
    return sum;
  };
  const auto by_pieces = [](const Eigen::VectorXd& squares) {
    double all = 0, piece = 0;
    for (Eigen::Index i = 0; i < squares.size(); ++i) {
      piece += squares[i];
      if (i % 256 == 255 || i + 1 == squares.size()) all += std::exchange(piece, 0.0);
    }
    return all;
  };
  for (const Eigen::Index n : {1, 2, 255, 256}) expect_sum(n, one_by_one);
  for (const Eigen::Index n : {257, 512, 1000, 2561}) expect_sum(n, by_pieces);
  const Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(1000, 1, 1e3).cwiseInverse().cwiseAbs2();
  EXPECT_NE(one_by_one(numbers), by_pieces(numbers)) << "the test sees no order";
}

}  // namespace
}  // namespace hmax
