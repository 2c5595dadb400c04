/// Explicit methods of structural dynamics: what one step is, how far a step may go, and what is conserved.
#include "integrators/structural/structural.hpp"

#include <algorithm>
#include <complex>
#include <random>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "problems/test_set/kepler.hpp"
#include "tests/integrators/methods.hpp"
#include "tests/integrators/motion.hpp"
#include "tests/integrators/rejected_attempts.hpp"

namespace hmax {
namespace {

using Plane = Eigen::Vector2d;
using Wide = long double;
using WidePlane = Eigen::Matrix<Wide, 2, 1>;
using WideOscillator = BasicOscillator<Wide>;
using Wider = Eigen::Matrix<Wide, Eigen::Dynamic, 1>;

/// m = 1, so that omega = sqrt(k1) and 2 zeta omega = c.
Oscillator linear_oscillator(double omega, double zeta) {
  return Oscillator({.m = 1, .c = 2 * zeta * omega, .k1 = omega * omega, .k3 = 0, .P = 0, .w = 0});
}
const OscillatorParameters cubic{.m = 1.45, .c = 0, .k1 = 0.7, .k3 = 0.8, .P = 0, .w = 0};
const OscillatorParameters linear_undamped{.m = 1.45, .c = 0, .k1 = 5.3, .k3 = 0, .P = 0, .w = 0};

struct SymplecticEulerMethod {
  template <class State>
  using Stepper = SymplecticEuler<State>;
  static constexpr int order = 1, undamped_order = 1;
  static constexpr int evaluations_before = 0;
  /// Of (q, h v): h v_new = -W^2 q + (1 - 2 zeta W) h v, q_new = q + h v_new.
  static Eigen::MatrixXd amplification(double W, double zeta) {
    Eigen::MatrixXd A(2, 2);
    A << 1 - W * W, 1 - 2 * zeta * W, -W * W, 1 - 2 * zeta * W;
    return A;
  }
};
struct VelocityVerletMethod {
  template <class State>
  using Stepper = VelocityVerlet<State>;
  static constexpr int order = 1, undamped_order = 2;
  static constexpr int evaluations_before = 1;
  /// Of (q, h v, h^2 a): h^2 a_new = -W^2 q_new - 2 zeta W (h v + h^2 a / 2).
  static Eigen::MatrixXd amplification(double W, double zeta) {
    const double W2 = W * W, D = zeta * W;
    Eigen::MatrixXd A(3, 3);
    A << 1, 1, 0.5, -W2 / 2, 1 - W2 / 2 - D, 0.5 - W2 / 4 - D / 2, -W2, -W2 - 2 * D, -W2 / 2 - D;
    return A;
  }
};
struct StormerVerletMethod {
  template <class State>
  using Stepper = StormerVerlet<State>;
  static constexpr int order = 2, undamped_order = 2;
  static constexpr int evaluations_before = 1;
  /// Of (q, h v, h^2 a): h^2 a_new = -W^2 q_new - 2 zeta W (h v + h^2 a).
  static Eigen::MatrixXd amplification(double W, double zeta) {
    const double W2 = W * W, D = zeta * W;
    Eigen::MatrixXd A(3, 3);
    A << 1, 1, 0.5, -W2 / 2, 1 - W2 / 2 - D, 0.5 - W2 / 4 - D, -W2, -W2 - 2 * D, -W2 / 2 - 2 * D;
    return A;
  }
};
struct CentralDifferenceMethod {
  template <class State>
  using Stepper = CentralDifference<State>;
  static constexpr int order = 2, undamped_order = 2;
  static constexpr int evaluations_before = 1;
  /// Of (q, h v), where h v_n = (q_(n+1) - q_(n-1)) / 2.
  static Eigen::MatrixXd amplification(double W, double zeta) {
    const double W2 = W * W, D = zeta * W;
    Eigen::MatrixXd A(2, 2);
    A << (1 - W2 / 2), 1 - D, -W2 * (1 - W2 / 4) / (1 + D), (1 - D) * (1 - W2 / 2) / (1 + D);
    return A;
  }
};

using EveryExplicitMethod =
    testing::Types<SymplecticEulerMethod, VelocityVerletMethod, StormerVerletMethod, CentralDifferenceMethod>;
struct Name {
  template <class Method>
  static std::string GetName(int) {
    if (std::is_same_v<Method, SymplecticEulerMethod>) return "symplectic_euler";
    if (std::is_same_v<Method, VelocityVerletMethod>) return "velocity_verlet";
    return std::is_same_v<Method, StormerVerletMethod> ? "stormer_verlet" : "central_difference";
  }
};
template <class Method>
struct Structural : testing::Test {};
TYPED_TEST_SUITE(Structural, EveryExplicitMethod, Name);

static_assert(Stepper<SymplecticEuler<Plane>, Oscillator> && Stepper<VelocityVerlet<Plane>, Oscillator> &&
              Stepper<StormerVerlet<Plane>, Oscillator> && Stepper<CentralDifference<Plane>, Oscillator> &&
              Stepper<StormerVerlet<Eigen::VectorXd>, Chain<Eigen::VectorXd>>);

TYPED_TEST(Structural, StepsAsItsAmplificationMatrixSays) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> frequency(0, 2.5), damping(0, 1.5), exponent(-3, 3), start(-1, 1);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const double W = frequency(random), zeta = damping(random), h = std::pow(10, exponent(random));
    const Oscillator system = linear_oscillator(W / h, zeta);
    const Eigen::MatrixXd A = TypeParam::amplification(W, zeta);
    Plane y(start(random), start(random) / h);
    Eigen::VectorXd x(A.rows());
    x.head(2) << y[0], h * y[1];
    if (x.size() == 3) x[2] = -W * W * x[0] - 2 * zeta * W * x[1];
    for (int step = 1; step <= 4; ++step) {
      x = A * x;
      const Plane seen = after_steps(typename TypeParam::template Stepper<Plane>{}, system, y, h, step);
      EXPECT_LT(std::hypot(seen[0] - x[0], h * seen[1] - x[1]), 1e-13 * std::max(1.0, x.norm()) * 30)
          << W << " " << zeta << " " << step;
    }
  }
}

/// The full liver model in long double, and where it is at t = 4 according to an engine of order 8.
struct ForcedLiver {
  WideOscillator system{OscillatorParameters{}};
  WidePlane start{0.5L, 1};
  WidePlane exact = after_steps(Rk<tableaux::Dop853, WidePlane>{}, system, start, 4 / 512.0L, 512);
};

TYPED_TEST(Structural, HasItsOrderOnTheForcedDampedLiver) {
  const ForcedLiver liver;
  const double observed = order_by_halving(typename TypeParam::template Stepper<WidePlane>{}, liver.system,
                                           liver.start, liver.exact, 4, 4000);
  EXPECT_NEAR(observed, TypeParam::order, 0.02);
}

TYPED_TEST(Structural, HasItsOrderWithoutDampingAndWhereItIsNotDiagonal) {
  const Wider start = Wider::LinSpaced(8, 0.4L, -0.3L);
  for (const auto& [c, order] :
       {std::pair(0.0L, TypeParam::undamped_order), std::pair(0.7L, TypeParam::order)}) {
    const Chain<Wider> chain{.n = 4, .c = c, .pull = 1};
    const Wider exact = after_steps(Rk<tableaux::Dop853, Wider>{}, chain, start, 2 / 256.0L, 256);
    const double observed =
        order_by_halving(typename TypeParam::template Stepper<Wider>{}, chain, start, exact, 2, 1000);
    EXPECT_NEAR(observed, order, 0.03) << static_cast<double>(c);
  }
}

TEST(VelocityVerlet, HasThePositionsOfSymplecticEulerFromTheFirstHalfStepOn) {
  const Oscillator system{OscillatorParameters{}};
  const Plane start(0.5, 1);
  const double h = 0.1;
  Plane slope;
  system.rhs(0, start, slope);
  const double v_half = start[1] + h / 2 * slope[1];
  // Of symplectic Euler time stands at the end of the first step.
  Plane y(start[0] + h * v_half, v_half), y_new;
  SymplecticEuler<Plane> euler;
  euler.init(system, h, y);
  for (int n = 1; n < 50; ++n) {
    euler.attempt(system, n * h, y, h, y_new);
    euler.accept(y_new);
    y = y_new;
  }
  EXPECT_NEAR(after_steps(VelocityVerlet<Plane>{}, system, start, h, 50)[0], y[0], 1e-13);
}

TEST(Verlet, IsOneMethodWithoutDamping) {
  for (const auto& parameters : {cubic, linear_undamped}) {
    const Oscillator system(parameters);
    const Plane y(0.5, 1);
    const Plane end = after_steps(StormerVerlet<Plane>{}, system, y, 0.1, 1000);
    EXPECT_EQ(after_steps(CentralDifference<Plane>{}, system, y, 0.1, 1000), end);
    EXPECT_EQ(after_steps(VelocityVerlet<Plane>{}, system, y, 0.1, 1000), end);
  }
}

TEST(CentralDifference, IsTheTextbookRecurrenceOfPositions) {
  // (m/h^2 + c/(2h)) q_new = P cos(w t) - k q - k3 q^3 + 2 m/h^2 q - (m/h^2 - c/(2h)) q_old
  // [hughes2000finite]
  const OscillatorParameters p{};
  const double h = 0.05;
  const auto force = [&](double t, double q) {
    return p.P * std::cos(p.w * t) - p.k1 * q - p.k3 * q * q * q;
  };
  const Plane start(0.5, 1);
  const double a = (force(0, start[0]) - p.c * start[1]) / p.m;
  double old = start[0] - h * start[1] + h * h / 2 * a, q = start[0];
  for (int n = 0; n < 200; ++n) {
    const double next = (force(n * h, q) + 2 * p.m / (h * h) * q - (p.m / (h * h) - p.c / (2 * h)) * old) /
                        (p.m / (h * h) + p.c / (2 * h));
    old = q;
    q = next;
  }
  EXPECT_NEAR(after_steps(CentralDifference<Plane>{}, Oscillator(p), start, h, 200)[0], q, 1e-12);
}

/// The largest |E / E_0 - 1| over the first tenth and over the last tenth of a run.
/// @param watch  called with each state
template <class StepperT, class Sys, class Watch>
std::pair<double, double> energy_errors(const Sys& system, typename Sys::State y, double h, int steps,
                                        const Watch& watch) {
  const double e0 = system.energy(y);
  double first = 0, last = 0;
  int n = 0;
  const auto end =
      integrate(StepperT{}, system, Span<double>{0, steps * h}, y, FixedStep<double>(h), [&](auto& view) {
        const double error = std::abs(system.energy(view.y1()) / e0 - 1);
        if (++n <= steps / 10) first = std::max(first, error);
        if (n > steps - steps / 10) last = std::max(last, error);
        watch(view.y1());
      });
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  return {first, last};
}
const auto watch_nothing = [](const auto&) {};

TYPED_TEST(Structural, KeepsTheEnergyBoundedOverAMillionSteps) {
  using S = typename TypeParam::template Stepper<Plane>;
  for (const auto& parameters : {linear_undamped, cubic}) {
    const Oscillator system(parameters);
    // About 60 steps a period. The error is of order h^p and does not drift.
    const double h = 0.1 * std::sqrt(parameters.m / (parameters.k1 + parameters.k3));
    const auto [first, last] = energy_errors<S>(system, Plane(0.5, 1), h, 1'000'000, watch_nothing);
    EXPECT_LT(first, TypeParam::undamped_order == 1 ? 0.15 : 0.01);
    EXPECT_GT(first, TypeParam::undamped_order == 1 ? 0.01 : 1e-4) << "nothing is measured";
    EXPECT_NEAR(last, first, 0.01 * first);
  }
}

TYPED_TEST(Structural, KeepsTheEnergyAndTheAngularMomentumOfAKeplerOrbitOverAMillionSteps) {
  using State = Kepler<double>::State;
  const Kepler<double> kepler({.e = 0.3});
  const State start = kepler.y0();
  double turned = 0;
  const auto [first, last] = energy_errors<typename TypeParam::template Stepper<State>>(
      kepler, start, 0.02, 1'000'000, [&](const State& y) {
        turned = std::max(
            turned,
            std::abs(Kepler<double>::angular_momentum(y) / Kepler<double>::angular_momentum(start) - 1));
      });
  EXPECT_LT(first, TypeParam::undamped_order == 1 ? 0.05 : 1e-3);
  EXPECT_GT(first, TypeParam::undamped_order == 1 ? 1e-3 : 1e-5) << "nothing is measured";
  EXPECT_NEAR(last, first, 0.02 * first);
  EXPECT_LT(turned, 1e-10);
}

TEST(SymplecticEuler, BeatsExplicitEulerWhichGainsEnergy) {
  // The gate above sees a drift: explicit Euler multiplies the energy of the linear oscillator every step.
  const auto [first, last] = energy_errors<Rk<tableaux::ExplicitEuler, Plane>>(
      Oscillator(linear_undamped), Plane(0.5, 1), 1e-3, 10000, watch_nothing);
  EXPECT_GT(last, 5 * first);
}

/// J = d y_new / d y of one step by complex differentiation, exact to rounding.
template <template <class> class StepperT>
Eigen::MatrixXd step_jacobian(Eigen::Index n, double h) {
  using State = Eigen::VectorXcd;
  const Chain<State> chain{.n = n};
  constexpr double tiny = 1e-100;
  Eigen::MatrixXd J(2 * n, 2 * n);
  for (Eigen::Index j = 0; j < 2 * n; ++j) {
    State y = Eigen::VectorXd::LinSpaced(2 * n, 0.6, -0.5).cast<std::complex<double>>(), y_new = y;
    y[j] += std::complex<double>(0, tiny);
    StepperT<State> stepper;
    stepper.init(chain, 0, y);
    stepper.attempt(chain, 0, y, h, y_new);
    J.col(j) = y_new.imag() / tiny;
  }
  return J;
}

/// J^T S J - S with the symplectic matrix S of positions and momenta, p = m v.
double symplectic_defect(const Eigen::MatrixXd& J) {
  const Eigen::Index n = J.rows() / 2;
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  S.topRightCorner(n, n) = Chain<Eigen::VectorXd>{.n = n}.mass().asDiagonal();
  S.bottomLeftCorner(n, n) = -S.topRightCorner(n, n);
  return (J.transpose() * S * J - S).cwiseAbs().maxCoeff();
}

TEST(Symplectic, AreTheStepsOfSymplecticEulerAndVerlet) {
  EXPECT_LT(symplectic_defect(step_jacobian<SymplecticEuler>(3, 0.2)), 1e-14);
  EXPECT_LT(symplectic_defect(step_jacobian<VelocityVerlet>(3, 0.2)), 1e-14);
  EXPECT_LT(symplectic_defect(step_jacobian<StormerVerlet>(3, 0.2)), 1e-14);
  EXPECT_LT(symplectic_defect(step_jacobian<CentralDifference>(3, 0.2)), 1e-14);
}

TEST(Reversible, IsVerletWithoutDamping) {
  using State = Eigen::VectorXd;
  const Chain<State> chain{.n = 3};
  const State start = State::LinSpaced(6, 0.6, -0.5);
  State y = after_steps(StormerVerlet<State>{}, chain, start, 0.1, 500);
  EXPECT_GT((y - start).norm(), 0.1);
  y.tail(3) *= -1;
  y = after_steps(StormerVerlet<State>{}, chain, y, 0.1, 500);
  y.tail(3) *= -1;
  EXPECT_LT((y - start).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Reversible, AreCentralDifferencesEvenWithADamper) {
  // Backwards in time a damper feeds in what it took.
  OscillatorParameters damped{.m = 1.45, .c = 0.4, .k1 = 0.7, .k3 = 0.8, .P = 0, .w = 0};
  const Plane start(0.5, 1);
  Plane y = after_steps(CentralDifference<Plane>{}, Oscillator(damped), start, 0.1, 100);
  y[1] *= -1;
  damped.c *= -1;
  y = after_steps(CentralDifference<Plane>{}, Oscillator(damped), y, 0.1, 100);
  y[1] *= -1;
  EXPECT_LT((y - start).norm(), 1e-12);
}

TYPED_TEST(Structural, AnAttemptThatIsRepeatedLeavesNoTrace) {
  using State = Eigen::VectorXd;
  expect_no_trace_of_rejected_attempts(typename TypeParam::template Stepper<State>{},
                                       Chain<State>{.n = 3, .c = 0.3, .pull = 1},
                                       State(State::LinSpaced(6, 0.6, -0.5)), {0.7});
}

TYPED_TEST(Structural, EvaluatesOnceAStep) {
  Stats stats;
  const Oscillator oscillator{OscillatorParameters{}};
  const Counted system(oscillator, stats);
  after_steps(typename TypeParam::template Stepper<Plane>{}, system, Plane(0.5, 1), 0.1, 50);
  EXPECT_EQ(stats.rhs, 50 + TypeParam::evaluations_before);
  EXPECT_EQ(stats.jacobian, 0);
}

TYPED_TEST(Structural, InterpolantMeetsBothEndsAndHasTheOrderOfTheStep) {
  const ForcedLiver liver;
  using S = typename TypeParam::template Stepper<WidePlane>;
  const auto error = [&](Wide h) {
    auto step = first_step<S>(liver.system, 0, liver.start, h);
    EXPECT_EQ(step.at(0), liver.start);
    EXPECT_EQ(step.at(1), step.y_new);
    return (step.at(0.4L) -
            after_steps(Rk<tableaux::Dop853, WidePlane>{}, liver.system, liver.start, 0.4L * h / 4, 4))
        .norm();
  };
  EXPECT_NEAR(static_cast<double>(std::log2(error(0.01L) / error(0.005L))), TypeParam::order + 1, 0.1);
}

TYPED_TEST(Structural, AForceThatIsNotFiniteEndsTheRun) {
  const Oscillator explosive({.m = 1.45, .c = -2, .k1 = 0.7, .k3 = 0.8, .P = 0.5, .w = 0.5});
  Plane y(1e3, 0);
  const auto end = integrate(typename TypeParam::template Stepper<Plane>{}, explosive, Span<double>{0, 100},
                             y, FixedStep<double>(1));
  EXPECT_EQ(end.outcome, Outcome::diverged);
  EXPECT_TRUE(y.allFinite());
}

}  // namespace
}  // namespace hmax
