#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/observers.hpp"
#include "integrators/sundials/integrate.hpp"
#include "tests/integrators/peers.hpp"
#include "tests/says.hpp"

namespace hmax::sundials {
namespace {

using namespace peers;

constexpr std::int64_t many = 1'000'000;
constexpr Method adams{.package = Package::cvode_adams}, bdf{.package = Package::cvode_bdf};
constexpr Method erk{.package = Package::erk, .explicit_table = ARKODE_HEUN_EULER_2_1_2};
constexpr Method dirk{.package = Package::dirk, .implicit_table = ARKODE_SDIRK_5_3_4};

template <System Sys, class Observer = ObserveNothing>
RunEnd<double> run(const Method& method, const Settings& settings, const Sys& system, double t_end,
                   typename Sys::State& y, Observer&& observer = {}, std::int64_t max_steps = many) {
  return integrate(method, settings, system, Span<double>{0, t_end}, y, observer, max_steps);
}

Settings tolerance(double tol) { return {.rtol = tol, .atol = tol}; }

TEST(Sundials, AdaptiveRunsReachTheEndWithinTheirTolerance) {
  for (const Method& method : {adams, bdf, erk, dirk}) {
    const Circle circle;
    Stats counts;
    const Counted<Circle> counted(circle, counts);
    Eigen::Vector2d y(1, 0);
    const auto end = run(method, tolerance(1e-8), counted, 10, y);
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_EQ(end.t, 10);
    EXPECT_LT((y - Circle::exact(10)).norm(), 2e-6);
    EXPECT_GT(end.stats.steps, 10);
    EXPECT_GE(counts.rhs, end.stats.steps);
    EXPECT_EQ(counts.jacobian > 0, solves_equations(method.package));
    EXPECT_EQ(end.stats.factorisations > 0, solves_equations(method.package));
    EXPECT_TRUE(end.note.empty());
  }
}

/// x'' = -x, all of it stiff.
struct StiffCircle : Circle {
  void rhs_stiff(double t, const State& y, State& dydt) const { rhs(t, y, dydt); }
  void rhs_nonstiff(double, const State&, State& dydt) const { dydt.setZero(); }
  void jacobian_stiff(double t, const State& y, Jacobian& J) const { jacobian(t, y, J); }
};

TEST(Sundials, StagesAreSolvedToTheToleranceWhereTheStepChanges) {
  const auto error = [](const Method& method) {
    Eigen::Vector2d y(1, 0);
    EXPECT_EQ(run(method, {.rtol = 1e-6, .atol = 1e-9}, StiffCircle{}, 10, y).outcome, Outcome::reached_end);
    return (y - Circle::exact(10)).norm();
  };
  for (const int table : {ARKODE_SDIRK_5_3_4, ARKODE_KVAERNO_5_3_4, ARKODE_ARK436L2SA_DIRK_6_3_4,
                          ARKODE_KVAERNO_7_4_5, ARKODE_ARK548L2SA_DIRK_8_4_5})
    EXPECT_LT(error({.package = Package::dirk, .implicit_table = table}), 5e-5) << table;
  const auto pair = [&](int explicit_table, int implicit_table) {
    return error(
        {.package = Package::imex, .explicit_table = explicit_table, .implicit_table = implicit_table});
  };
  EXPECT_LT(pair(ARKODE_ARK436L2SA_ERK_6_3_4, ARKODE_ARK436L2SA_DIRK_6_3_4), 5e-5);
  EXPECT_LT(pair(ARKODE_ARK548L2SA_ERK_8_4_5, ARKODE_ARK548L2SA_DIRK_8_4_5), 5e-5);
}

TEST(Sundials, AFixedStepIsTakenAsOftenAsItFitsIn) {
  for (const double t_end : {100.0, 99.995}) {
    Eigen::Vector2d y(1, 0);
    const auto end = run(erk, {.adaptive = false, .h = 0.01}, Circle{}, t_end, y);
    EXPECT_EQ(end.stats.steps, 10000) << t_end;
    EXPECT_EQ(end.t, t_end);
    EXPECT_LT((y - Circle::exact(t_end)).norm(), 1e-2);
  }
}

TEST(Sundials, WatchingARunChangesNothing) {
  for (const Method& method : {adams, bdf, erk, dirk}) {
    Eigen::Vector2d alone(1, 0), watched(1, 0), inside;
    run(method, tolerance(1e-6), Circle{}, 10, alone);
    run(method, tolerance(1e-6), Circle{}, 10, watched,
        [&](auto& view) { view.at(view.t0() + view.h() / 3, inside); });
    EXPECT_EQ(alone, watched);
  }
}

TEST(Sundials, DenseOutputIsAsGoodAsTheSteps) {
  for (const Method& method : {adams, bdf, erk, dirk})
    EXPECT_LT(worst_inside_steps(
                  [&](auto& y, auto& sample) { run(method, tolerance(1e-7), Circle{}, 10, y, sample); }),
              method.package == Package::dirk ? 1e-4 : 1e-5);
}

TEST(Sundials, AnObserverMayStopTheRunInsideAStep) {
  Eigen::Vector2d y(1, 0);
  std::vector<Event<Eigen::Vector2d>> found;
  const auto end =
      run(adams, tolerance(1e-9), Circle{}, 10, y,
          EventFinder<Eigen::Vector2d, double (*)(double, const Eigen::Vector2d&)>(
              [](double, const Eigen::Vector2d& at) { return at[0]; }, Crossing::any, true, found));
  EXPECT_EQ(end.outcome, Outcome::stopped);
  EXPECT_NEAR(end.t, M_PI / 2, 1e-7);
  EXPECT_NEAR(y[1], -1, 1e-7);
}

TEST(Sundials, StepsAreLimitedAndNothingIsPrinted) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  for (const Method& method : {adams, bdf, erk, dirk}) {
    Eigen::Vector2d y(1, 0);
    const auto end = run(method, tolerance(1e-8), Circle{}, 1000, y, ObserveNothing{}, 7);
    EXPECT_EQ(end.outcome, Outcome::too_many_steps);
    EXPECT_EQ(end.stats.steps, 7);
    EXPECT_GT(end.t, 0);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(Sundials, ADerivativeThatIsNoNumberEndsTheRunInWordsAndInSilence) {
  testing::internal::CaptureStderr();
  for (const Method& method : {adams, bdf, erk, dirk}) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
    const auto end = run(method, tolerance(1e-6), Cliff{}, 2, y);
    EXPECT_NE(end.outcome, Outcome::reached_end);
    EXPECT_NEAR(end.t, 1, 0.01);
    EXPECT_NEAR(y[0], end.t, 1e-9) << "the last good state";
    EXPECT_TRUE(says(end.note, "SUNDIALS"));
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Sundials, ASolutionWithoutBoundEndsAtItsPole) {
  for (const Method& method : {adams, bdf, erk, dirk}) {
    Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
    const auto end = run(method, tolerance(1e-6), Pole{}, 2, y);
    EXPECT_TRUE(end.outcome == Outcome::diverged || end.outcome == Outcome::step_too_small ||
                end.outcome == Outcome::newton_failed)
        << to_string(end.outcome);
    EXPECT_NEAR(end.t, 1, 1e-2);
    EXPECT_TRUE(std::isfinite(y[0]));
  }
}

TEST(Sundials, AWrongJacobianMakesTheIterationFail) {
  for (const Method& method : {bdf, dirk}) {
    Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
    const auto end = run(method, tolerance(1e-6), Stiff{true}, 10, y, ObserveNothing{}, 2000);
    EXPECT_NE(end.outcome, Outcome::reached_end);
    Eigen::VectorXd right = Eigen::VectorXd::Ones(1);
    EXPECT_EQ(run(method, tolerance(1e-6), Stiff{false}, 10, right).outcome, Outcome::reached_end);
    EXPECT_NEAR(right[0], std::cos(10), 1e-4);
  }
}

TEST(Sundials, AnExceptionOfTheSystemComesThroughTheLibrary) {
  for (const Method& method : {adams, bdf, erk, dirk}) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
    EXPECT_THROW(run(method, tolerance(1e-6), Throwing{}, 2, y), std::domain_error);
  }
}

TEST(Sundials, SparseEquationsAreSolvedAlikeByKluByUsAndDensely) {
  for (Method method : {bdf, dirk}) {
    const Rod rod, dense{.sparse = false};
    Eigen::VectorXd with_klu = rod.mode(), with_ours = rod.mode(), with_dense = rod.mode();
    EXPECT_EQ(run(method, tolerance(1e-8), rod, 0.1, with_klu).outcome, Outcome::reached_end);
    method.klu = false;
    EXPECT_EQ(run(method, tolerance(1e-8), rod, 0.1, with_ours).outcome, Outcome::reached_end);
    EXPECT_EQ(run(method, tolerance(1e-8), dense, 0.1, with_dense).outcome, Outcome::reached_end);
    EXPECT_LT((with_klu - std::exp(-0.1 * rod.rate()) * rod.mode()).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((with_klu - with_ours).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((with_klu - with_dense).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Sundials, TheJacobianIsTakenAsOftenAsItIsAskedFor) {
  const auto jacobians = [](const Method& method, JacobianUpdate update) {
    Stats counts;
    const Stiff stiff;
    const Counted<Stiff> counted(stiff, counts);
    Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
    Settings settings = tolerance(1e-6);
    settings.jacobian = update;
    const auto end = run(method, settings, counted, 10, y);
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_NEAR(y[0], std::cos(10), 1e-4);
    return std::pair(counts.jacobian, end.stats.steps);
  };
  for (const Method& method : {bdf, dirk}) {
    EXPECT_EQ(jacobians(method, {JacobianUpdate::frozen}).first, 1);
    const auto [exact, steps] = jacobians(method, {1});
    EXPECT_GE(exact, steps);
    EXPECT_LT(jacobians(method, {}).first, exact / 2);
  }
}

TEST(Sundials, AVectorIsTheStateItself) {
  const Vector v = make_vector<Eigen::VectorXd>(3, this_context());
  state_of<Eigen::VectorXd>(v.get()) << 1, 2, 3;
  EXPECT_EQ(N_VGetArrayPointer(v.get()), state_of<Eigen::VectorXd>(v.get()).data());
  EXPECT_EQ(N_VMaxNorm(v.get()), 3);
  const Vector copy(N_VClone(v.get()));
  N_VScale(2, v.get(), copy.get());
  EXPECT_EQ(state_of<Eigen::VectorXd>(copy.get()), Eigen::Vector3d(2, 4, 6));
  EXPECT_EQ(state_of<Eigen::VectorXd>(v.get()), Eigen::Vector3d(1, 2, 3));
}

TEST(Sundials, RefusesToRunBackwards) {
  Eigen::Vector2d y(1, 0);
  EXPECT_THROW(run(adams, tolerance(1e-6), Circle{}, -1, y), std::invalid_argument);
  EXPECT_EQ(y, Eigen::Vector2d(1, 0));
}

TEST(Sundials, TakesAnAbsoluteToleranceForEachComponent) {
  for (const Method& method : {adams, bdf, erk, dirk}) {
    const auto steps = [&](const Settings& settings, Eigen::Vector2d& y) {
      y << 1, 0;
      return run(method, settings, Circle{}, 10, y).stats.steps;
    };
    Eigen::Vector2d scalar, equal, loose;
    const std::int64_t of_scalar = steps({.rtol = 1e-9, .atol = 1e-6}, scalar);
    EXPECT_EQ(steps({.rtol = 1e-9, .atols = Eigen::Vector2d(1e-6, 1e-6)}, equal), of_scalar);
    EXPECT_EQ(equal, scalar);
    EXPECT_LT(steps({.rtol = 1e-9, .atols = Eigen::Vector2d(1e-2, 1e-2)}, loose), of_scalar);
    EXPECT_THROW(steps({.rtol = 1e-9, .atols = Eigen::Vector3d(1, 1, 1)}, loose), std::invalid_argument);
    EXPECT_THROW(steps({.rtol = 1e-9, .atols = Eigen::Vector2d(1, -1)}, loose), std::invalid_argument);
  }
}

}  // namespace
}  // namespace hmax::sundials
