/// Newmark, HHT-alpha and generalized-alpha: one stepper of four numbers.
#include "integrators/structural/generalized_alpha.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <string>

#include <Eigen/LU>
#include <Eigen/SparseCore>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "problems/any_system.hpp"
#include "problems/test_set/kepler.hpp"
#include "tests/integrators/motion.hpp"
#include "tests/integrators/rejected_attempts.hpp"

namespace hmax {
namespace {

using Plane = Eigen::Vector2d;
using Wide = long double;
using WideOscillator = BasicOscillator<Wide>;

template <class Sys>
using AlphaStepper = GeneralizedAlpha<typename Sys::State, typename Sys::Dofs, typename Sys::DofMatrix>;
using Step = AlphaStepper<Oscillator>;
using WideStep = AlphaStepper<WideOscillator>;

static_assert(Stepper<Step, Oscillator> &&
              Stepper<AlphaStepper<Chain<Eigen::VectorXd>>, Chain<Eigen::VectorXd>>);

struct Named {
  std::string name;
  AlphaParameters parameters;
};
const std::vector<Named> every_method{{"newmark", newmark_parameters(0.25L, 0.5L)},
                                      {"linear acceleration", newmark_parameters(1 / 6.0L, 0.5L)},
                                      {"Fox-Goodwin", newmark_parameters(1 / 12.0L, 0.5L)},
                                      {"explicit newmark", newmark_parameters(0, 0.5L)},
                                      {"damped newmark", newmark_parameters(0.3025L, 0.6L)},
                                      {"hht -0.05", hht_parameters(-0.05L)},
                                      {"hht -0.1", hht_parameters(-0.1L)},
                                      {"hht -1/3", hht_parameters(-1 / 3.0L)},
                                      {"rho 0", generalized_alpha_parameters(0)},
                                      {"rho 0.5", generalized_alpha_parameters(0.5L)},
                                      {"rho 0.8", generalized_alpha_parameters(0.8L)},
                                      {"rho 1", generalized_alpha_parameters(1)}};

/// m = 1, so that omega = sqrt(k1) and 2 zeta omega = c.
OscillatorParameters linear(double omega, double zeta) {
  return {.m = 1, .c = 2 * zeta * omega, .k1 = omega * omega, .k3 = 0, .P = 0, .w = 0};
}

/// The three equations of [chung1993time] for x = (q, h v, h^2 a), W = omega h, solved as they stand.
Eigen::Matrix3d amplification(const AlphaParameters& p, double W, double zeta) {
  const auto am = static_cast<double>(p.alpha_m), af = static_cast<double>(p.alpha_f),
             beta = static_cast<double>(p.beta), gamma = static_cast<double>(p.gamma);
  Eigen::Matrix3d after, before;
  after << 1, 0, -beta, 0, 1, -gamma, (1 - af) * W * W, (1 - af) * 2 * zeta * W, 1 - am;
  before << 1, 1, 0.5 - beta, 0, 1, 1 - gamma, -af * W * W, -af * 2 * zeta * W, -am;
  return after.inverse() * before;
}

TEST(GeneralizedAlpha, StepsAsItsAmplificationMatrixSays) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> frequency(0, 8), damping(0, 1.5), exponent(-3, 3), start(-1, 1);
  for (const auto& [name, parameters] : every_method)
    for (int repeat = 0; repeat < 100; ++repeat) {
      const double W = frequency(random), zeta = damping(random), h = std::pow(10, exponent(random));
      const Oscillator system(linear(W / h, zeta));
      Plane y(start(random), start(random) / h), y_new;
      Eigen::Vector3d x(y[0], h * y[1], -W * W * y[0] - 2 * zeta * W * h * y[1]);
      const Eigen::Matrix3d A = amplification(parameters, W, zeta);
      Step stepper(parameters);
      stepper.init(system, 0, y);
      for (int step = 0; step < 4; ++step) {
        ASSERT_EQ(stepper.attempt(system, step * h, y, h, y_new), StepStatus::ok);
        stepper.accept(y_new);
        y = y_new;
        const double size = std::max(1.0, x.norm());
        x = A * x;
        const Eigen::Vector3d seen(y[0], h * y[1], h * h * stepper.acceleration()[0]);
        EXPECT_LT((seen - x).norm(), 1e-13 * size * (1 + W * W)) << name << " " << W << " " << zeta;
        x = seen;
      }
    }
}

TEST(Newmark, HasTheTraceAndDeterminantOfTheLiterature) {
  // Of the step (q, h v), D = 1 + 2 gamma zeta W + beta W^2 [hughes2000finite, 9.1.2]:
  //   trace = 2 - (W^2 (gamma + 1/2) + 2 zeta W) / D,   determinant = 1 - (W^2 (gamma - 1/2) + 2 zeta W) / D
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> frequency(0, 6), damping(0, 1.5), shares(0, 1);
  for (int repeat = 0; repeat < 300; ++repeat) {
    const double W = frequency(random), zeta = damping(random), beta = shares(random), gamma = shares(random);
    const Oscillator system(linear(W, zeta));
    Eigen::Matrix2d A;
    for (int j = 0; j < 2; ++j) {
      Plane y = Plane::Unit(j), y_new;
      Step stepper(newmark_parameters(beta, gamma));
      stepper.init(system, 0, y);
      ASSERT_EQ(stepper.attempt(system, 0, y, 1, y_new), StepStatus::ok);
      A.col(j) = y_new;
    }
    const double D = 1 + 2 * gamma * zeta * W + beta * W * W, size = 1 + W * W * W * W;
    EXPECT_NEAR(A.trace(), 2 - (W * W * (gamma + 0.5) + 2 * zeta * W) / D, 1e-13 * size);
    EXPECT_NEAR(A.determinant(), 1 - (W * W * (gamma - 0.5) + 2 * zeta * W) / D, 1e-13 * size);
  }
}

TEST(Newmark, IsTheTrapezoidalRuleOnLinearProblems) {
  // (1 + h c/(2m) ...): y_new = (I - h/2 J)^-1 ((I + h/2 J) y + h/2 (g(t) + g(t + h))), g = (0, P cos(w t) /
  // m)
  const OscillatorParameters p{.m = 1.45, .c = 0.3, .k1 = 5.3, .k3 = 0, .P = 0.5, .w = 0.5};
  Eigen::Matrix2d J;
  J << 0, 1, -p.k1 / p.m, -p.c / p.m;
  for (const double h : {0.01, 0.3, 3.0}) {
    const Eigen::Matrix2d left = Eigen::Matrix2d::Identity() - h / 2 * J,
                          right = Eigen::Matrix2d::Identity() + h / 2 * J;
    Plane y(0.5, 1);
    for (int n = 0; n < 200; ++n) {
      const double force = (std::cos(p.w * n * h) + std::cos(p.w * (n + 1) * h)) * p.P / p.m;
      y = left.inverse() * (right * y + Plane(0, h / 2 * force));
    }
    const Plane seen =
        after_steps(Step(newmark_parameters(0.25L, 0.5L)), Oscillator(p), Plane(0.5, 1), h, 200);
    EXPECT_LT((seen - y).norm(), 1e-12) << h;
  }
}

TEST(Newmark, KeepsTheEnergyOfALinearOscillatorToRounding) {
  const Oscillator system({.m = 1.45, .c = 0, .k1 = 5.3, .k3 = 0, .P = 0, .w = 0});
  Plane y(0.5, 1);
  const double e0 = system.energy(y);
  double worst = 0;
  integrate(Step(newmark_parameters(0.25L, 0.5L)), system, Span<double>{0, 1e5}, y, FixedStep<double>(0.1),
            [&](auto& view) { worst = std::max(worst, std::abs(system.energy(view.y1()) / e0 - 1)); });
  EXPECT_LT(worst, 1e-9);
}

TEST(Newmark, WithoutBetaIsCentralDifferences) {
  const OscillatorParameters p{.m = 1.45, .c = 2, .k1 = 0.7, .k3 = 0.8, .P = 0.5, .w = 0.5};
  const Plane a = after_steps(Step(newmark_parameters(0, 0.5L)), Oscillator(p), Plane(0.5, 1), 0.1, 300);
  const Plane b = after_steps(CentralDifference<Plane>{}, Oscillator(p), Plane(0.5, 1), 0.1, 300);
  EXPECT_LT((a - b).norm(), 1e-12);
}

TEST(GeneralizedAlpha, MultipliesInfinitelyFastModesByWhatWasAsked) {
  // At W -> infinity the characteristic polynomial is (lambda + rho)^3 [chung1993time]; W^-2 is left of it
  // here.
  for (const double rho : {0.0, 0.5, 0.8, 1.0}) {
    const WideOscillator system(linear(1e5, 0));
    WideStep stepper(generalized_alpha_parameters(rho));
    Eigen::Matrix<Wide, 2, 1> y(1, 0), y_new;
    stepper.init(system, 0, y);
    std::vector<Wide> q{y[0]};
    for (int n = 0; n < 6; ++n) {
      ASSERT_EQ(stepper.attempt(system, n, y, 1, y_new), StepStatus::ok);
      stepper.accept(y_new);
      y = y_new;
      q.push_back(y[0]);
    }
    Wide largest = 0;
    for (const Wide value : q) largest = std::max(largest, std::abs(value));
    EXPECT_GT(std::abs(q[2]), 1e-3L) << "nothing is measured";
    for (std::size_t n = 0; n + 3 < q.size(); ++n)
      EXPECT_LT(std::abs(q[n + 3] + 3 * rho * q[n + 2] + 3 * rho * rho * q[n + 1] + rho * rho * rho * q[n]),
                1e-8L * largest)
          << rho << " " << n;
  }
}

TEST(GeneralizedAlpha, HasTheOrderOfItsParametersOnTheForcedDampedLiver) {
  using State = WideOscillator::State;
  const WideOscillator liver{OscillatorParameters{}};
  const State start(0.5L, 1);
  const State exact = after_steps(Rk<tableaux::Dop853, State>{}, liver, start, 4 / 512.0L, 512);
  for (const auto& [name, parameters] : every_method)
    EXPECT_NEAR(order_by_halving(WideStep(parameters), liver, start, exact, 4, 2000), order_of(parameters),
                0.05)
        << name;
}

TEST(GeneralizedAlpha, SolvesTheSameWithDenseSparseOrEitherMatrices) {
  using State = Eigen::VectorXd;
  using Sparse = Eigen::SparseMatrix<double>;
  const State start = State::LinSpaced(40, 0.4, -0.3);
  const auto run = [&]<class Sys>(const Sys& system) {
    return after_steps(AlphaStepper<Sys>(generalized_alpha_parameters(0.8L)), system, start, 0.3, 50);
  };
  const Chain<State, Eigen::MatrixXd> dense{.n = 20, .c = 0.4, .pull = 1};
  const Chain<State, Sparse> sparse{.n = 20, .c = 0.4, .pull = 1};
  const State expected = run(dense);
  EXPECT_LT((run(sparse) - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((run(AnySystem(dense)) - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((run(AnySystem(sparse)) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

/// What a run of 100 steps of size h did.
template <class Sys>
Stats work_of(const Sys& system, const AlphaParameters& parameters, const typename Sys::State& start,
              double h, JacobianUpdate update = {}) {
  Stats counts;
  const Counted<Sys> counted(system, counts);
  AlphaStepper<Sys> stepper(parameters);
  stepper.set_jacobian_update(update);
  typename Sys::State y = start;
  const auto end = integrate(stepper, counted, Span<double>{0, 100 * h}, y, FixedStep<double>(h));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  counts.factorisations = end.stats.factorisations;
  counts.newton = end.stats.newton;
  return counts;
}

TEST(GeneralizedAlpha, TakesOneFactorisationAndOneIterationAStepOnLinearProblems) {
  const Oscillator linear_liver({.m = 1.45, .c = 0.3, .k1 = 5.3, .k3 = 0, .P = 0.5, .w = 0.5});
  const Chain<Eigen::VectorXd> chain{.n = 5, .k3 = 0, .c = 0.3, .pull = 1};
  for (const auto& [name, parameters] : every_method) {
    const Stats one = work_of(linear_liver, parameters, Plane(0.5, 1), 0.1);
    const Stats many = work_of(chain, parameters, Eigen::VectorXd::LinSpaced(10, 0.4, -0.3).eval(), 0.1);
    for (const Stats& seen : {one, many}) {
      EXPECT_EQ(seen.factorisations, 1) << name;
      EXPECT_EQ(seen.jacobian, parameters.beta == 0 ? 0 : 1) << name;
      EXPECT_LE(seen.newton, 105) << name;
      EXPECT_EQ(seen.rhs, seen.newton + 1) << name << ": the one before is the initial acceleration";
    }
  }
}

TEST(GeneralizedAlpha, RenewsItsMatricesAsOftenAsItIsTold) {
  const Oscillator liver{OscillatorParameters{}};
  const AlphaParameters parameters = newmark_parameters(0.25L, 0.5L);
  const auto run = [&](int every) { return work_of(liver, parameters, Plane(0.5, 1), 0.05, {every}); };
  EXPECT_EQ(run(1).jacobian, 100);
  EXPECT_EQ(run(1).factorisations, 100);
  EXPECT_EQ(run(5).jacobian, 20);
  EXPECT_EQ(run(5).factorisations, 20);
  EXPECT_EQ(run(JacobianUpdate::frozen).jacobian, 1);
  EXPECT_LT(run(1).newton, run(5).newton);
  EXPECT_LT(run(5).newton, run(JacobianUpdate::frozen).newton);
  const Stats automatic = run(JacobianUpdate::automatic);
  EXPECT_LT(automatic.factorisations, 20);
  EXPECT_LT(automatic.newton, 500);
}

TEST(GeneralizedAlpha, WithAnyPolicySolvesTheSameEquations) {
  const Oscillator liver{OscillatorParameters{}};
  const auto run = [&](int every) {
    Step stepper(hht_parameters(-0.1L));
    stepper.set_jacobian_update({every});
    return after_steps(stepper, liver, Plane(0.5, 1), 0.05, 200);
  };
  const Plane exact = run(1);
  for (const int every : {JacobianUpdate::automatic, JacobianUpdate::frozen, 7})
    EXPECT_LT((run(every) - exact).norm(), 1e-12) << every;
}

TEST(GeneralizedAlpha, AnAttemptThatIsRepeatedLeavesNoTrace) {
  using State = Eigen::VectorXd;
  expect_no_trace_of_rejected_attempts(AlphaStepper<Chain<State>>(generalized_alpha_parameters(0.8L)),
                                       Chain<State>{.n = 3, .k3 = 20, .c = 0.3, .pull = 1},
                                       State(State::LinSpaced(6, 0.9, -0.8)), {0.7, 50}, 8);
}

TEST(GeneralizedAlpha, InterpolantMeetsBothEndsAndHasTheOrderOfTheStep) {
  using State = WideOscillator::State;
  const WideOscillator liver{OscillatorParameters{}};
  const State start(0.5L, 1);
  const auto error = [&](Wide h) {
    WideStep stepper(newmark_parameters(0.25L, 0.5L));
    State y_new, left, right, between;
    stepper.init(liver, 0, start);
    EXPECT_EQ(stepper.attempt(liver, 0, start, h, y_new), StepStatus::ok);
    stepper.interpolate(liver, 0, h, start, y_new, 0, left);
    stepper.interpolate(liver, 0, h, start, y_new, 1, right);
    EXPECT_EQ(left, start);
    EXPECT_EQ(right, y_new);
    stepper.interpolate(liver, 0, h, start, y_new, 0.4L, between);
    return (between - after_steps(Rk<tableaux::Dop853, State>{}, liver, start, 0.4L * h / 4, 4)).norm();
  };
  EXPECT_NEAR(static_cast<double>(std::log2(error(0.01L) / error(0.005L))), 3, 0.1);
}

/// A spring without an end: the force is not a number beyond q = 1.
struct Torn : Oscillator {
  using Oscillator::Oscillator;
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
    Oscillator::force(t, q, v, f);
    if (q[0] > 1) f[0] = std::numeric_limits<double>::quiet_NaN();
  }
};

TEST(GeneralizedAlpha, SaysWhenItsEquationsHaveNoSolution) {
  const Torn torn({.m = 1.45, .c = 0, .k1 = 0.7, .k3 = 0, .P = 0, .w = 0});
  Plane y(0.5, 1);
  const auto end = integrate(Step(AlphaParameters{}), torn, Span<double>{0, 10}, y, FixedStep<double>(0.01));
  EXPECT_EQ(end.outcome, Outcome::newton_failed);
  EXPECT_GT(y[0], 0.95);

  // M + h^2/4 K = 0 at h = 2.
  const Oscillator singular({.m = 1, .c = 0, .k1 = -1, .k3 = 0, .P = 0, .w = 0});
  for (const int every : {JacobianUpdate::automatic, JacobianUpdate::frozen}) {
    Step stepper(AlphaParameters{});
    stepper.set_jacobian_update({every});
    Plane start(0.5, 1);
    const auto stopped = integrate(stepper, singular, Span<double>{0, 10}, start, FixedStep<double>(2));
    EXPECT_EQ(stopped.outcome, Outcome::newton_failed);
    EXPECT_EQ(start, Plane(0.5, 1));
  }
}

TEST(GeneralizedAlpha, SolvesStiffHardeningSpringsAtStepsOfManyPeriods) {
  // The guess is far from the solution: simplified iteration fails, Newton's from a motionless guess does
  // not.
  const Oscillator stiff({.m = 1, .c = 0.1, .k1 = 1, .k3 = 1e6, .P = 1, .w = 0.5});
  for (const double h : {0.01, 0.1, 1.0}) {
    Plane y(0.5, 1);
    const auto end = integrate(Step(generalized_alpha_parameters(0.5L)), stiff, Span<double>{0, 200 * h}, y,
                               FixedStep<double>(h));
    EXPECT_EQ(end.outcome, Outcome::reached_end) << h;
    EXPECT_LT(std::abs(y[0]), 1) << h;
  }
}

TEST(GeneralizedAlpha, TakesTheSameStepsInEveryUnitOfLength) {
  // A power of two changes no digit: every number is that of the other unit to the last bit.
  const auto run = [](double unit) {
    const Oscillator system(
        {.m = 1.45, .c = 0.1, .k1 = 0.7, .k3 = 4 / (unit * unit), .P = 0.3 * unit, .w = 0.5});
    Plane y(0.5 * unit, unit);
    const auto end = integrate(Step(generalized_alpha_parameters(0.5L)), system, Span<double>{0, 50}, y,
                               FixedStep<double>(0.5));
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    return std::pair(Plane(y / unit), end.stats.newton);
  };
  const auto [y, iterations] = run(1);
  for (const double unit : {0x1p-40, 0x1p-20, 0x1p20, 0x1p40}) {
    EXPECT_EQ(run(unit).first, y) << unit;
    EXPECT_EQ(run(unit).second, iterations) << unit;
  }
}

TEST(GeneralizedAlpha, RestsWhereStiffSpringsRest) {
  // Positions of 1 carry rounding that is large beside velocities of 0.
  const Oscillator stiff({.m = 1, .c = 0.1, .k1 = 1e12, .k3 = 0, .P = 1e12, .w = 0});
  const Plane y = after_steps(Step(AlphaParameters{}), stiff, Plane(1, 0), 1e-3, 1000);
  EXPECT_NEAR(y[0], 1, 1e-9);
}

/// A mass on a spring that meets a stop: linear up to there.
struct Stop {
  using State = Plane;
  using Dofs = Eigen::Vector<double, 1>;
  using DofMatrix = Eigen::Matrix<double, 1, 1>;
  static constexpr double m = 0.1, c = 0.02, k = 40, gap = 0.012, wall = 2000;

  static constexpr Eigen::Index dim() { return 2; }
  static constexpr Eigen::Index dofs() { return 1; }
  static Dofs mass() { return Dofs(m); }
  static void force(double, const Dofs& q, const Dofs& v, Dofs& f) {
    f[0] = -c * v[0] - k * q[0] - wall * std::max(0.0, q[0] - gap);
  }
  static void rhs(double t, const State& y, State& dydt) {
    Dofs f;
    force(t, Dofs(y[0]), Dofs(y[1]), f);
    dydt = {y[1], f[0] / m};
  }
  static void stiffness(double, const Dofs& q, const Dofs&, DofMatrix& K) {
    K(0) = q[0] > gap ? k + wall : k;
  }
  static void damping(double, const Dofs&, const Dofs&, DofMatrix& C) { C(0) = c; }
};

TEST(Newmark, SolvesItsEquationAlsoWhereAMotionThatWasLinearMeetsAStop) {
  for (const double h : {0.02, 0.01, 0.005}) {
    AlphaStepper<Stop> stepper(newmark_parameters(0.25L, 0.5L));
    Plane y(-0.02, 0), y_new = y;
    stepper.init(Stop{}, 0, y);
    for (int i = 0; i < 200; ++i) {
      ASSERT_EQ(stepper.attempt(Stop{}, i * h, y, h, y_new), StepStatus::ok);
      stepper.accept(y_new);
      y = y_new;
      Stop::Dofs f;
      Stop::force(0, Stop::Dofs(y[0]), Stop::Dofs(y[1]), f);
      ASSERT_NEAR(Stop::m * stepper.acceleration()[0], f[0], 1e-9) << "h " << h << ", step " << i;
    }
  }
}

TEST(GeneralizedAlpha, KeepsAKeplerOrbit) {
  const Kepler<double> kepler({.e = 0.3});
  const double pi = 3.14159265358979323846;
  using S = AlphaStepper<Kepler<double>>;
  const auto error = [&](int steps) {
    return (after_steps(S(generalized_alpha_parameters(0.9L)), kepler, kepler.y0(), 2 * pi / steps, steps) -
            kepler.y0())
        .norm();
  };
  EXPECT_NEAR(std::log2(error(2000) / error(4000)), 2, 0.05);
}

}  // namespace
}  // namespace hmax
