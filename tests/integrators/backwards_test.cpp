/// Runs backwards in time: bit for bit the mirror image of runs forwards, at the order of their method.
#include <cmath>
#include <numbers>
#include <vector>

#include "integrators/explicit/stabilized_rk.hpp"
#include "integrators/implicit/imex.hpp"
#include "integrators/multistep/adams.hpp"
#include "integrators/multistep/adams_pece.hpp"
#include "integrators/observers.hpp"
#include "integrators/structural/generalized_alpha.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "tests/integrators/implicit/rosenbrock_systems.hpp"
#include "tests/integrators/implicit_methods.hpp"

namespace hmax {
namespace {

using Plane = Eigen::Vector2d;

/// x'' = cos 3t - sin x - x' / 10 with all that a method may ask for; the spring is declared stiff. With
/// `sign` = -1 the same with time turned round, s = -t: y' = -f(-s, y).
struct Swing {
  using State = Plane;
  using Dofs = Eigen::Matrix<double, 1, 1>;
  using DofMatrix = Dofs;
  double sign = 1;

  static Eigen::Index dim() { return 2; }
  void rhs(double t, const Plane& y, Plane& dydt) const {
    dydt << sign * y[1], sign * (std::cos(3 * t) - std::sin(y[0]) - y[1] / 10);
  }
  void jacobian(double, const Plane& y, Eigen::Matrix2d& J) const {
    J << 0, sign, -sign * std::cos(y[0]), -sign / 10;
  }
  void time_derivative(double t, const Plane&, Plane& dfdt) const { dfdt << 0, -3 * sign * std::sin(3 * t); }
  void rhs_stiff(double, const Plane& y, Plane& dydt) const { dydt << sign * y[1], -sign * std::sin(y[0]); }
  void rhs_nonstiff(double t, const Plane& y, Plane& dydt) const {
    dydt << 0, sign * (std::cos(3 * t) - y[1] / 10);
  }
  void jacobian_stiff(double, const Plane& y, Eigen::Matrix2d& J) const {
    J << 0, sign, -sign * std::cos(y[0]), 0;
  }
  static double spectral_radius(double, const Plane&) { return 1.2; }

  static Eigen::Index dofs() { return 1; }
  static Dofs mass() { return Dofs(1.0); }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
    f[0] = std::cos(3 * t) - std::sin(q[0]) - v[0] / 10;
  }
  void stiffness(double, const Dofs& q, const Dofs&, DofMatrix& K) const { K[0] = std::cos(q[0]); }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& C) const { C[0] = 0.1; }
};
/// The same turned round as a second-order system: its state is (q, -v).
struct MirroredMotion : Swing {
  void rhs(double s, const Plane& y, Plane& dydt) const {
    Swing::rhs(s, Plane(y[0], -y[1]), dydt);
    dydt[0] = y[1];
  }
  void force(double s, const Dofs& q, const Dofs& v, Dofs& f) const { Swing::force(s, q, -v, f); }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& C) const { C[0] = -0.1; }
};

/// The times and states of the steps of a run, and states between.
struct Path {
  std::vector<double> t;
  std::vector<Plane> y;
  Outcome outcome{};

  /// With the sign of time turned round, and that of the velocity if that is.
  [[nodiscard]] Path mirrored(double sign_of_v) const {
    Path path = *this;
    for (double& time : path.t) time = -time;
    for (Plane& state : path.y) state[1] *= sign_of_v;
    return path;
  }
  bool operator==(const Path&) const = default;
};

template <class StepperT, class Sys, class Control>
Path path_of(StepperT stepper, const Sys& system, Span<double> span, Plane y, Control control) {
  Path path;
  const auto end = integrate(stepper, system, span, y, control, [&](auto& step) {
    Plane between;
    for (const double share : {0.25, 1.0}) {
      path.t.push_back(share == 1 ? step.t1() : step.t0() + share * step.h());
      step.at(path.t.back(), between);
      path.y.push_back(between);
    }
  });
  path.outcome = end.outcome;
  path.t.push_back(end.t);
  path.y.push_back(y);
  return path;
}

const Plane start(0.7, -0.4);

template <class StepperT, class Control>
void expect_mirror_image(const StepperT& stepper, const Control& control) {
  const Path back = path_of(stepper, Swing{}, {0.5, -2.25}, start, control);
  EXPECT_EQ(back.outcome, Outcome::reached_end);
  EXPECT_EQ(back.t.back(), -2.25);
  EXPECT_TRUE(back == path_of(stepper, Swing{-1}, {-0.5, 2.25}, start, control).mirrored(1));
}

/// Fixed steps that divide the span, and that do not; and each control where the method estimates an error.
template <class StepperT>
void expect_mirror_images(const StepperT& stepper, int error_order) {
  expect_mirror_image(stepper, FixedStep<double>(0.0625));
  expect_mirror_image(stepper, FixedStep<double>(0.07));
  if constexpr (StepperT::may_estimate_error) {
    const auto expect = [&](auto controller, Tolerances<double> tolerances, bool matlab) {
      const AnyNorm<double> norm{tolerances.rtol, tolerances.atol, matlab};
      expect_mirror_image(stepper, Adaptive<double, AnyController, AnyNorm>(
                                       tolerances, error_order, AnyController<double>(controller), norm));
    };
    expect(DeadbandController<double>(error_order), {1e-5, 1e-7}, false);
    expect(IntegralController<double>(error_order), {1e-5, 1e-7}, false);
    expect(PiController<double>(error_order), {1e-5, 1e-7}, false);
    expect(MatlabController<double>(error_order), {1e-5, 1e-7}, true);
    expect(PiController<double>(error_order), {.rtol = 1e-3, .atol = 1e-3, .h_first = 0.01, .h_max = 0.1},
           false);
  }
}

template <class Method>
struct ExplicitBackwards : testing::Test {};
TYPED_TEST_SUITE(ExplicitBackwards, OneOfEachKind, MethodId);
TYPED_TEST(ExplicitBackwards, IsTheMirrorImageOfARunForwards) {
  expect_mirror_images(Rk<TypeParam, Plane>{}, TypeParam::error_order);
}

template <class Method>
struct ImplicitBackwards : testing::Test {};
TYPED_TEST_SUITE(ImplicitBackwards, EveryImplicitMethod, MethodId);
TYPED_TEST(ImplicitBackwards, IsTheMirrorImageOfARunForwards) {
  expect_mirror_images(typename TypeParam::template Stepper<Plane>{}, TypeParam::error_order);
}

template <class Method>
struct RosenbrockBackwards : testing::Test {};
using RosenbrockKinds =
    testing::Types<tableaux::LinearlyImplicitEuler, tableaux::Rosenbrock23, tableaux::Rodas4>;
TYPED_TEST_SUITE(RosenbrockBackwards, RosenbrockKinds, MethodId);
TYPED_TEST(RosenbrockBackwards, IsTheMirrorImageOfARunForwards) {
  Rosenbrock<TypeParam, Plane> stepper;
  expect_mirror_images(stepper, TypeParam::error_order);
  stepper.set_jacobian_update({JacobianUpdate::frozen});
  expect_mirror_image(stepper, FixedStep<double>(0.0625));
}

template <class Method>
struct ImexBackwards : testing::Test {};
using ImexKinds = testing::Types<tableaux::ImexEuler, tableaux::ImexArk324>;
TYPED_TEST_SUITE(ImexBackwards, ImexKinds, MethodId);
TYPED_TEST(ImexBackwards, IsTheMirrorImageOfARunForwards) {
  expect_mirror_images(ImexRk<TypeParam, Plane>{}, TypeParam::error_order);
}

TEST(StabilizedBackwards, IsTheMirrorImageOfARunForwards) {
  expect_mirror_images(StabilizedRk<Rkc2, Plane>{}, 3);
  expect_mirror_images(StabilizedRk<Rkl2, Plane>{}, 3);
}

TEST(AdamsBackwards, IsTheMirrorImageOfARunForwards) {
  for (const AdamsMode mode : {AdamsMode::bashforth, AdamsMode::pece, AdamsMode::pec})
    for (int k = 1; k <= 6; ++k) expect_mirror_images(Adams<Plane>(mode, k), 0);
  for (const double tolerance : {1e-3, 1e-6, 1e-11})
    expect_mirror_image(AdamsPece<Plane>{}, ShampineGordonControl<double>({tolerance, tolerance}));
  expect_mirror_image(AdamsPece<Plane>{},
                      ShampineGordonControl<double>({.rtol = 1e-3, .atol = 1e-3, .h_max = 0.1}));
}

template <class StepperT>
void expect_mirrored_motion(const StepperT& stepper) {
  for (const double h : {0.0625, 0.07}) {
    const FixedStep<double> control(h);
    const Path back = path_of(stepper, Swing{}, {0.5, -2.25}, start, control);
    const Plane turned(start[0], -start[1]);
    EXPECT_EQ(back.outcome, Outcome::reached_end);
    EXPECT_TRUE(back == path_of(stepper, MirroredMotion{}, {-0.5, 2.25}, turned, control).mirrored(-1));
  }
}

TEST(StructuralBackwards, IsTheMirrorImageOfARunForwards) {
  expect_mirrored_motion(SymplecticEuler<Plane>{});
  expect_mirrored_motion(VelocityVerlet<Plane>{});
  expect_mirrored_motion(StormerVerlet<Plane>{});
  expect_mirrored_motion(CentralDifference<Plane>{});
  using Alpha = GeneralizedAlpha<Plane, Swing::Dofs, Swing::DofMatrix>;
  for (const auto& parameters : {newmark_parameters(0.25L, 0.5L), newmark_parameters(0, 0.5L),
                                 hht_parameters(-0.1L), generalized_alpha_parameters(0.5L)})
    expect_mirrored_motion(Alpha(parameters));
}

TEST(Backwards, VerletReturnsToItsStart) {
  struct Spring : Swing {
    void rhs(double, const Plane& y, Plane& dydt) const { dydt << y[1], -y[0]; }
  };
  Plane y = start;
  integrate(StormerVerlet<Plane>{}, Spring{}, Span<double>{0, 100}, y, FixedStep<double>(0.1));
  EXPECT_GT((y - start).norm(), 0.1);
  integrate(StormerVerlet<Plane>{}, Spring{}, Span<double>{100, 0}, y, FixedStep<double>(0.1));
  EXPECT_NEAR((y - start).norm(), 0, 1e-12);
}

/// The forced liver, in long double so that no order is lost in rounding.
using Liver = BasicOscillator<long double>;
const OscillatorParameters liver{.m = 1.45, .c = 0.2, .k1 = 0.7, .k3 = 0.8, .P = 0.5, .w = 0.5};

/// log2 of what halving h does to the error of a run from the exact state at t = 4 back to 0, and to that of
/// a run from 0 to 4 and back.
template <class StepperT>
std::pair<double, double> orders_back(int n) {
  const OscillatorReference reference(liver, Plane(0.5, 1), 4);
  const auto error = [&](bool there_first, int steps) {
    const FixedStep<long double> control(4.0L / steps);
    Liver::State y = reference.extended_at(there_first ? 0 : 4);
    if (there_first) integrate(StepperT{}, Liver(liver), Span<long double>{0, 4}, y, control);
    integrate(StepperT{}, Liver(liver), Span<long double>{4, 0}, y, control);
    return (y - reference.extended_at(0)).norm();
  };
  const auto order = [&](bool there_first) {
    return static_cast<double>(std::log2(error(there_first, n) / error(there_first, 2 * n)));
  };
  return {order(false), order(true)};
}

TEST(Backwards, RoundTripsHaveTheOrderOfTheMethod) {
  using State = Liver::State;
  const auto expect_orders = [](std::pair<double, double> orders, int expected) {
    EXPECT_NEAR(orders.first, expected, 0.2);
    // The leading errors of both ways may cancel, as those of odd orders do.
    EXPECT_GT(orders.second, expected - 0.2);
  };
  expect_orders(orders_back<Rk<tableaux::Rk4, State>>(128), 4);
  expect_orders(orders_back<Rk<tableaux::DormandPrince54, State>>(64), 5);
  expect_orders(orders_back<Rk<tableaux::Dop853, State>>(24), 8);
  expect_orders(orders_back<Dirk<tableaux::Sdirk4, State>>(128), 4);
  expect_orders(orders_back<RadauIIA5<State>>(32), 5);
  expect_orders(orders_back<Rosenbrock<tableaux::Rodas4, State>>(128), 4);
  expect_orders(orders_back<ImexRk<tableaux::ImexArk436, State>>(128), 4);
  expect_orders(orders_back<StormerVerlet<State>>(256), 2);
}

TEST(Backwards, AdaptiveRoundTripsKeepToTheTolerance) {
  const Oscillator system(liver);
  const auto error = [&](auto stepper, auto control) {
    Plane y(0.5, 1);
    integrate(stepper, system, Span<double>{0, 10}, y, control);
    const auto end = integrate(stepper, system, Span<double>{10, 0}, y, control, [](auto& step) {
      EXPECT_LT(step.h(), 0);
      EXPECT_GE(step.t1(), 0);
    });
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_EQ(end.t, 0);
    return (y - Plane(0.5, 1)).norm();
  };
  for (const double tolerance : {1e-4, 1e-8}) {
    using Steered = Adaptive<double, PiController>;
    const Tolerances<double> both{tolerance, tolerance};
    // c = 0.2 over 10 s: backwards what is past grows by e^0.7.
    EXPECT_LT(error(Rk<tableaux::DormandPrince54, Plane>{}, Steered(both, 5)), 20 * tolerance);
    EXPECT_LT(error(Rosenbrock<tableaux::Rodas5P, Plane>{}, Steered(both, 5)), 20 * tolerance);
    EXPECT_LT(error(RadauIIA5<Plane>{}, Steered(both, 4)), 20 * tolerance);
    EXPECT_LT(error(AdamsPece<Plane>{}, ShampineGordonControl<double>(both)), 50 * tolerance);
  }
}

TEST(Backwards, FixedTimesAreMultiplesOfTheStepToTheLastBit) {
  for (const double given : {0.6, 0.15, 1.0 / 3, 0.005, -0.1}) {
    const double t0 = 100.25, t_end = 0.25, h = -std::abs(given);
    std::vector<double> times, steps;
    Plane y(0, 1);
    const auto end = integrate(Rk<tableaux::Rk4, Plane>{}, rotation<Plane>, Span<double>{t0, t_end}, y,
                               FixedStep<double>(given), [&](auto& step) {
                                 times.push_back(step.t1());
                                 steps.push_back(step.h());
                               });
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_EQ(end.stats.steps, static_cast<std::int64_t>(std::ceil(-100 / h - 1e-9)));
    for (std::size_t n = 0; n + 1 < times.size(); ++n) {
      ASSERT_EQ(times[n], t0 + static_cast<double>(n + 1) * h);
      ASSERT_EQ(steps[n], h);
    }
    EXPECT_EQ(times.back(), t_end);
    EXPECT_LT(steps.back(), 1e-3 * h) << "a sliver";
    EXPECT_GE(steps.back(), h * (1 + 1e-12));
  }
}

TEST(Backwards, StepsThatAreNoneEndAtOnce) {
  const auto outcome = [](double h, double t0) {
    Plane y(0, 1);
    return integrate(Rk<tableaux::Rk4, Plane>{}, rotation<Plane>, Span<double>{t0, t0 - 1}, y,
                     FixedStep<double>(h), ObserveNothing{}, 100)
        .outcome;
  };
  for (const double h : {0.0, 1e-300, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(outcome(h, 2), Outcome::step_too_small) << h;
  EXPECT_EQ(outcome(0.5, 2), Outcome::reached_end);
}

TEST(Backwards, DivergesWithTheTimeOfTheStateThatIsKept) {
  const auto pole = system_of<Plane>([](double t, const Plane& y, Plane& dydt) {
    dydt = t > 0.5 ? y : Plane::Constant(std::numeric_limits<double>::infinity());
  });
  Plane y(0, 1);
  const auto end =
      integrate(Rk<tableaux::ExplicitEuler, Plane>{}, pole, Span<double>{2, 0}, y, FixedStep<double>(0.25));
  EXPECT_EQ(end.outcome, Outcome::diverged);
  EXPECT_EQ(end.t, 0.25);
  EXPECT_EQ(end.t_state, 0.5);
}

TEST(Backwards, DenseOutputAndSamplesAreThoseOfTheSolution) {
  const double t0 = 10, t_end = 0.5;
  std::vector<double> times;
  Plane y(std::sin(t0), std::cos(t0));
  SampleEvery sample(Span<double>{t0, t_end}, 0.3, y, [&](double t, const Plane& at) {
    times.push_back(t);
    EXPECT_NEAR((at - Plane(std::sin(t), std::cos(t))).norm(), 0, 1e-8) << t;
  });
  integrate(Rk<tableaux::Dop853, Plane>{}, rotation<Plane>, Span<double>{t0, t_end}, y,
            FixedStep<double>(0.25), sample);
  ASSERT_EQ(times.size(), 33U);
  for (std::size_t j = 0; j + 1 < times.size(); ++j) EXPECT_EQ(times[j], t0 - static_cast<double>(j) * 0.3);
  EXPECT_EQ(times.back(), t_end);
}

TEST(Backwards, EventsAreLocatedInTheOrderOfTheRun) {
  constexpr double pi = std::numbers::pi;
  std::vector<Event<Plane>> turns, zero;
  const double t0 = 10;
  Plane y(std::sin(t0), std::cos(t0));
  // v = cos t falls at pi / 2 and 5 pi / 2 as time goes on, and rises there backwards.
  EventFinder turn([](double, const Plane& at) { return at[1]; }, Crossing::rising, false, turns);
  EventFinder through([](double, const Plane& at) { return at[0] - 0.5; }, Crossing::falling, true, zero);
  const auto end = integrate(Rk<tableaux::Dop853, Plane>{}, rotation<Plane>, Span<double>{t0, 0}, y,
                             FixedStep<double>(0.05), observe(through, turn));
  EXPECT_EQ(end.outcome, Outcome::stopped);
  // sin t = 0.5 falls, backwards, at 13 pi / 6 first.
  ASSERT_EQ(zero.size(), 1U);
  EXPECT_NEAR(zero[0].t, 13 * pi / 6, 1e-12);
  EXPECT_EQ(end.t, zero[0].t);
  EXPECT_EQ(y, zero[0].y);
  ASSERT_EQ(turns.size(), 1U);
  EXPECT_NEAR(turns[0].t, 2.5 * pi, 1e-12);
}

}  // namespace
}  // namespace hmax
