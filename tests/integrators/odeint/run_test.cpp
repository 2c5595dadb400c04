#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include "integrators/observers.hpp"
#include "integrators/odeint/explicit_peers.hpp"
#include "integrators/odeint/implicit_peers.hpp"
#include "integrators/odeint/integrate.hpp"
#include "tests/integrators/peers.hpp"

namespace hmax::odeint {
namespace {

using namespace peers;

template <class Sys>
using Rk4 = FixedPeer<Sys, native::runge_kutta4<values_of<typename Sys::State>>>;
template <class Sys>
using Adams = FixedPeer<Sys, native::adams_bashforth_moulton<4, values_of<typename Sys::State>>>;
template <class Sys>
using Fehlberg78 = ControlledPeer<Sys, native::runge_kutta_fehlberg78<values_of<typename Sys::State>>>;

constexpr std::int64_t many = 100'000;

template <template <class> class Peer, System Sys, class Observer = ObserveNothing>
RunEnd<double> fixed(const Sys& system, double t_end, double h, typename Sys::State& y,
                     Observer&& observer = {}, std::int64_t max_steps = many) {
  return integrate_fixed<Peer<Sys>>(system, Span<double>{0, t_end}, y, h, observer, max_steps);
}
template <template <class> class Peer, System Sys, class Observer = ObserveNothing>
RunEnd<double> steered(const Sys& system, double t_end, double tol, typename Sys::State& y,
                       Observer&& observer = {}, std::int64_t max_steps = many) {
  return integrate_adaptive<Peer<Sys>>(system, Span<double>{0, t_end}, y, tol, tol, 5, observer, max_steps);
}

/// Calls check(run) with a steered run of each stepper that steers.
template <class Check>
void with_each(const Check& check) {
  check([]<class... T>(T&&... arguments) { return steered<Dopri5Peer>(std::forward<T>(arguments)...); });
  check([]<class... T>(T&&... arguments) { return steered<Fehlberg78>(std::forward<T>(arguments)...); });
  check(
      []<class... T>(T&&... arguments) { return steered<BulirschStoerPeer>(std::forward<T>(arguments)...); });
  check([]<class... T>(T&&... arguments) {
    return steered<BulirschStoerDensePeer>(std::forward<T>(arguments)...);
  });
  check([]<class... T>(T&&... arguments) { return steered<Rosenbrock4Peer>(std::forward<T>(arguments)...); });
}

TEST(Odeint, SteeredRunsReachTheEndWithinTheirTolerance) {
  with_each([](auto run) {
    Eigen::Vector2d y(1, 0);
    const auto end = run(Circle{}, 10.0, 1e-9, y);
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_EQ(end.t, 10);
    EXPECT_LT((y - Circle::exact(10)).norm(), 2e-7);
  });
}

/// y' = 5 t^4, whatever y: a step of order 5 is exact.
struct FifthPower {
  using State = Eigen::VectorXd;
  static Eigen::Index dim() { return 1; }
  void rhs(double t, const State&, State& dydt) const { dydt[0] = 5 * std::pow(t, 4); }
};

TEST(OdeintDopri5, TheFirstStepBeginsWithTheSlopeAtTheStart) {
  const FifthPower system;
  Dopri5Peer<FifthPower> peer(system, 1, 1);
  // The slope is 0 at t = 0, the state is not.
  Eigen::VectorXd y = Eigen::VectorXd::Constant(1, 3);
  values_of<Eigen::VectorXd> start, next;
  to_values(y, start);
  next = start;
  double h = 1;
  ASSERT_TRUE(peer.try_step(start, 0, next, h));
  to_state(next, y);
  EXPECT_NEAR(y[0], 4, 1e-13);
}

/// y' = -y / T.
struct SlowFall {
  using State = Eigen::VectorXd;
  double T;
  static Eigen::Index dim() { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt = -y / T; }
};

TEST(OdeintDopri5, RunsOfSlowModelsBeginAtLateTimes) {
  const double T = 1e12;
  Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
  const auto end = integrate_adaptive<Dopri5Peer<SlowFall>>(SlowFall{T}, Span<double>{T, 2 * T}, y, 1e-9,
                                                            1e-9, 5, ObserveNothing{}, many);
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_NEAR(y[0], std::exp(-1.0), 1e-7);
}

TEST(Odeint, PointsInsideStepsAreAsGoodAsTheirEnds) {
  with_each([](auto run) {
    EXPECT_LT(worst_inside_steps([&](auto& y, auto& sample) { run(Circle{}, 10.0, 1e-8, y, sample); }), 2e-5);
  });
}

TEST(Odeint, WatchingARunChangesNothing) {
  with_each([](auto run) {
    Eigen::Vector2d alone(1, 0), watched(1, 0), inside;
    run(Circle{}, 10.0, 1e-6, alone);
    run(Circle{}, 10.0, 1e-6, watched, [&](auto& view) { view.at(view.t0() + view.h() / 3, inside); });
    EXPECT_EQ(alone, watched);
  });
}

TEST(Odeint, ADerivativeThatIsNoNumberEndsTheRun) {
  with_each([](auto run) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
    const auto end = run(Cliff{}, 2.0, 1e-6, y);
    EXPECT_TRUE(end.outcome == Outcome::diverged || end.outcome == Outcome::step_too_small)
        << to_string(end.outcome);
    EXPECT_NEAR(end.t, 1, 1e-3);
    EXPECT_NEAR(y[0], end.t, 2e-5) << "the last good state";
  });
  Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
  EXPECT_EQ(fixed<Rk4>(Cliff{}, 2, 0.1, y).outcome, Outcome::diverged);
}

TEST(Odeint, ASolutionWithoutBoundEndsTheRun) {
  with_each([](auto run) {
    Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
    const auto end = run(Pole{}, 2.0, 1e-6, y);
    EXPECT_NE(end.outcome, Outcome::reached_end);
    EXPECT_NEAR(end.t, 1, 1e-2);
    EXPECT_TRUE(std::isfinite(y[0]));
  });
}

TEST(Odeint, AttemptsAreLimited) {
  with_each([](auto run) {
    Eigen::Vector2d y(1, 0);
    EXPECT_EQ(run(Circle{}, 1000.0, 1e-8, y, ObserveNothing{}, std::int64_t{7}).outcome,
              Outcome::too_many_steps);
  });
  Eigen::Vector2d y(1, 0);
  EXPECT_EQ(fixed<Rk4>(Circle{}, 10, 0.1, y, ObserveNothing{}, 7).outcome, Outcome::too_many_steps);
}

TEST(Odeint, AnExceptionOfTheSystemIsNotTakenForAFailureOfTheMethod) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(1);
  EXPECT_THROW(steered<Dopri5Peer>(Throwing{}, 2, 1e-6, y), std::domain_error);
  EXPECT_THROW(fixed<ImplicitEulerPeer>(Throwing{}, 2, 0.1, y), std::domain_error);
}

TEST(Odeint, AdamsStartsAnewForAShorterLastStep) {
  Eigen::Vector2d y(1, 0);
  const auto end = fixed<Adams>(Circle{}, 1.005, 0.01, y);
  EXPECT_EQ(end.stats.steps, 101);
  EXPECT_LT((y - Circle::exact(1.005)).norm(), 1e-8);
}

/// y' = a y with a = 1: I - h J is singular at h = 1, where Odeint would end the process with success.
struct Growth {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  static Eigen::Index dim() { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt = y; }
  void jacobian(double, const State&, Jacobian& J) const { J.setIdentity(1, 1); }
};

TEST(OdeintImplicitEuler, ASingularMatrixIsAnOutcomeAndNotTheEndOfTheProcess) {
  Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
  const auto end = fixed<ImplicitEulerPeer>(Growth{}, 10, 1, y);
  EXPECT_EQ(end.outcome, Outcome::newton_failed);
  EXPECT_EQ(end.t, 0);
  EXPECT_FALSE(end.note.empty());
}

/// y' = y^3: from y = 10 the simplified iteration of a step of 1 s leaves the numbers.
struct Cube {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  static Eigen::Index dim() { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt = y.array().cube(); }
  void jacobian(double, const State& y, Jacobian& J) const {
    J = Eigen::MatrixXd::Constant(1, 1, 3 * y[0] * y[0]);
  }
};

TEST(OdeintImplicitEuler, AnIterationThatLeavesTheNumbersIsNoDivergence) {
  Eigen::VectorXd y = Eigen::VectorXd::Constant(1, 10);
  const auto end = fixed<ImplicitEulerPeer>(Cube{}, 10, 1, y);
  EXPECT_EQ(end.outcome, Outcome::newton_failed);
  EXPECT_EQ(y[0], 10);
}

TEST(OdeintImplicitEuler, AnIterationThatDoesNotConvergeIsEnded) {
  Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
  EXPECT_EQ(fixed<ImplicitEulerPeer>(Pole{}, 10, 0.5, y).outcome, Outcome::newton_failed);
}

TEST(OdeintImplicitEuler, IsImplicitEuler) {
  Eigen::Vector2d y(1, 0);
  fixed<ImplicitEulerPeer>(Circle{}, 1, 0.1, y);
  std::complex<double> exact = 1;
  for (int n = 0; n < 10; ++n) exact /= std::complex<double>(1, 0.1);
  EXPECT_NEAR(y[0], exact.real(), 1e-13);
  EXPECT_NEAR(y[1], exact.imag(), 1e-13);
}

TEST(Odeint, RefusesToRunBackwards) {
  Eigen::Vector2d y(1, 0);
  EXPECT_THROW(fixed<Rk4>(Circle{}, -1, 0.1, y), std::invalid_argument);
  EXPECT_THROW(steered<Dopri5Peer>(Circle{}, -1, 1e-6, y), std::invalid_argument);
}

TEST(Odeint, RefusesAnAbsoluteToleranceForEachComponent) {
  Eigen::Vector2d y(1, 0);
  EXPECT_THROW(integrate_adaptive<Dopri5Peer<Circle>>(Circle{}, Span<double>{0, 1}, y, 1e-6,
                                                      Eigen::Vector2d(1e-6, 1e-9), 5, ObserveNothing{}, many),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmax::odeint
