
#include "limits/jacobian_changes.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "limits/linearised_problem.hpp"

namespace hmax {
namespace {

/// x'' = a(t, x, v), of which nothing is known but its values.
template <class Acceleration>
struct Called {
  using State = Eigen::Vector2d;
  static constexpr bool autonomous = false;
  Acceleration acceleration;

  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double t, const State& y, State& dydt) const { dydt << y[1], acceleration(t, y[0], y[1]); }
};

template <class Acceleration>
Problem called(Acceleration acceleration, Eigen::Vector2d y0) {
  return {.id = "called", .y0 = y0, .t_end = 1, .system = AnySystem(Called<Acceleration>{acceleration})};
}

double least_of(const Problem& problem, double t_end) {
  const auto along = limit_along(find_method("rk4"), problem, t_end);
  return along ? along->least : 0;
}

// sqrt(8) / omega but for the damping, by |R(h lambda)| = 1 with R = 1 + z + z^2/2 + z^3/6 + z^4/24.
constexpr double of_contact = 0.002838770974763,  // omega = 1000 rad/s, c = 10 1/s
    of_late_spring = 0.028286395105,              // 100 rad/s, c = 0.02 1/s
    of_modulation = 0.064944145723;               // 1900^0.5 rad/s, c = 0.1 1/s

TEST(LinearityOf, IsThatOfTheStructure) {
  const auto of = [](const char* id, Parameters parameters = {}) {
    return linearity_of(make_problem(id, {.parameters = std::move(parameters)}));
  };
  EXPECT_EQ(of("liver_cubic"), Linearity::nonlinear);
  EXPECT_EQ(of("liver_cubic", {{"k3", 0}}), Linearity::linear);
  EXPECT_EQ(of("liver_linear"), Linearity::linear);
  EXPECT_EQ(of("prothero_robinson"), Linearity::linear);
  EXPECT_EQ(of("van_der_pol"), Linearity::nonlinear);
  EXPECT_EQ(of("spring_chain"), Linearity::linear);
  EXPECT_EQ(of("spring_chain", {{"k3", 1}}), Linearity::nonlinear);
  EXPECT_EQ(of("fem_cauchy@cube:n=1"), Linearity::linear);
  EXPECT_EQ(of("fem_cauchy/tool@cube:n=1"), Linearity::nonlinear);
  EXPECT_EQ(of("fem_cauchy@cube:n=1", {{"skin", 1000}}), Linearity::nonlinear);
  EXPECT_EQ(of("fem_green@cube:n=1"), Linearity::nonlinear);
  EXPECT_EQ(linearity_of(called([](double, double x, double) { return -x; }, {1, 0})), Linearity::unknown);
}

TEST(DependsOnState, SeesStiffnessOnOneSideEvennessAndSmallTermsOfLargeStates) {
  const auto depends = [](const Problem& problem) {
    const OperatingPoint point = operating_point(problem, 0, problem.y0);
    return depends_on_state(point.model, point.model_at);
  };
  EXPECT_FALSE(depends(called([](double, double x, double v) { return 3 - 4 * x - 0.1 * v; }, {1, 0})));
  EXPECT_FALSE(depends(called([](double, double x, double) { return -1e24 * x; }, {1e-12, 0})));
  EXPECT_TRUE(
      depends(called([](double, double x, double) { return -9.81 - (x < 0 ? 1e6 * x : 0); }, {1, 0})));
  // y0 = -1/2 and y0 + 1 have one Jacobian.
  EXPECT_TRUE(depends(called([](double, double x, double) { return -9.81 * std::sin(x); }, {-0.5, 0})));
  EXPECT_TRUE(depends(called([](double, double x, double) { return -x - x * x * x / 1e12; }, {1e8, 0})));
}

TEST(LimitAlongAMotion, OfACalledModelMissesNoShortEvent) {
  const auto contact = [](double, double x, double v) { return -9.81 + (x < 0 ? -1e6 * x - 10 * v : 0); };
  EXPECT_NEAR(least_of(called(contact, {1, 0}), 2) / of_contact, 1, 1e-6) << "less than 1 % of the motion";
  const auto late = [](double t, double x, double v) { return -(t < 1 ? 1 : 1e4) * x - 0.02 * v; };
  EXPECT_NEAR(least_of(called(late, {1, 0}), 2) / of_late_spring, 1, 1e-6);
  const auto modulated = [](double t, double x, double v) {
    return -1000 * (1 + 0.9 * std::sin(t)) * x - 0.1 * v;
  };
  EXPECT_NEAR(least_of(called(modulated, {1, 0}), 20) / of_modulation, 1, 3e-4);
  const auto large = [](double, double x, double) { return -x - x * x * x / 1e12; };
  EXPECT_NEAR(least_of(called(large, {1e8, 0}), 10), std::sqrt(8 / (1 + 3e4)), 2e-6);
}

/// x'' = -k x - c v |v|, with its Jacobian or without.
template <bool differentiable>
struct Drag {
  using State = Eigen::Vector2d;
  using Jacobian = Eigen::Matrix2d;
  static constexpr bool autonomous = true;
  double k, c;

  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt << y[1], -k * y[0] - c * y[1] * std::abs(y[1]); }
  void jacobian(double, const State& y, Jacobian& J) const requires differentiable {
    J << 0, 1, -k, -2 * c * std::abs(y[1]);
  }
};

template <class Sys>
Problem drag(Sys system, double x0) {
  return {.id = "drag", .y0 = Eigen::Vector2d(x0, 0), .system = AnySystem(system)};
}

TEST(LimitAlongAMotion, OfDampingIsSeenInAllUnitsOfValueAndTime) {
  // The smallest limit of rk4 on the motion of x'' = -1.6131690487576535 x - 3.5584626017171828 v |v| from x
  // = 1, v = 0, by SciPy's DOP853 at rtol 1e-12 in 20,000 steps.
  constexpr double k = 1.6131690487576535, c = 3.5584626017171828, right = 0.7792507585;
  // Units in which the entry of damping is less than 1e-12 of that of stiffness, or more than 1e12 times it.
  for (const double time : {1e-13, 1e-6, 1.0, 1e6, 1e13})
    for (const double value : {1e-6, 1.0, 1e9}) {
      const double k_scaled = k / (time * time), c_scaled = c / value, t_end = 8 * time;
      const auto exact = drag(Drag<true>{k_scaled, c_scaled}, value);
      EXPECT_NEAR(least_of(exact, t_end) / time / right, 1, 1e-4) << value << ' ' << time;
    }
  for (const double time : {0.1, 1.0, 10.0})
    EXPECT_NEAR(least_of(drag(Drag<false>{k / (time * time), c}, 1), 8 * time) / time / right, 1, 1e-4)
        << time;
}

TEST(JacobianDiffers, KnowsDifferencesToTheirRounding) {
  const auto model = [](auto force, double x) {
    const Problem problem = called(force, {x, 0});
    return operating_point(problem, 0, problem.y0).model;
  };
  const auto linear = [](double, double x, double v) { return 3 - 4e6 * x - 0.1 * v; };
  for (const double x : {1e-9, 1e-3, 0.7, 1e5})
    EXPECT_FALSE(jacobian_differs(model(linear, x), model(linear, 0.9 * x))) << x;
  const auto damped = [](double, double x, double v) { return 3 - 4 * x - 0.1 * (1 + x * x) * v; };
  EXPECT_TRUE(jacobian_differs(model(damped, 1), model(damped, 0.9)));
}

TEST(LimitAlongAMotion, SaysWhetherTheJacobianWasSeenToChange) {
  const auto seen = [](const Problem& problem) {
    return limit_along(find_method("rk4"), problem, 1)->constant;
  };
  EXPECT_TRUE(seen(called([](double, double x, double) { return 1 - 40 * x; }, {1, 0})));
  EXPECT_FALSE(seen(called([](double, double x, double) { return -40 * x - x * x; }, {1, 0})));
}

/// y' = 1 up to 2, where a spring on one side stops it: a run that is too long leaps far below.
struct Stopped {
  using State = Eigen::Matrix<double, 1, 1>;
  static constexpr bool autonomous = true;
  static constexpr Eigen::Index dim() { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt[0] = 1 - (y[0] > 2 ? 1e4 * (y[0] - 2) : 0); }
};

TEST(LimitFromAStart, IsJudgedByTheTrueMotionUpToATenthOfTheRun) {
  Problem problem{
      .id = "stopped", .y0 = Eigen::VectorXd::Zero(1), .t_end = 3, .system = AnySystem(Stopped{})};
  const MotionSize motion = size_of_motion(problem, 3);
  EXPECT_NEAR(motion.positions, 2.0001, 1e-6);
  const auto limit = limit_from_start(find_method("rk4"), problem, 3, 2.785e-4, motion);
  ASSERT_TRUE(limit);
  // By hand rk4 falls to -3.3 at h = 0.04, six sizes apart are at 0.05.
  EXPECT_GT(limit->h, 0.03);
  EXPECT_LT(limit->h, 0.0505);
  const Runner runner = find_method("rk4").bind(problem);
  double lowest = 0;
  runner.run({.t_end = 3, .h = 0.05},
             [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) { lowest = std::min(lowest, y[0]); });
  EXPECT_NEAR(lowest, -6.2833, 1e-3);
}

}  // namespace
}  // namespace hmax
