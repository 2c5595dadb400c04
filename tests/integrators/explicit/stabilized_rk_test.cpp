/// The stabilised methods: how far s stages reach, order two with any number of them, and how s is chosen.
#include "integrators/explicit/stabilized_rk.hpp"

#include <complex>
#include <limits>
#include <numbers>

#include "integrators/integrate.hpp"
#include "tests/integrators/methods.hpp"
#include "tests/integrators/rejected_attempts.hpp"

namespace hmax {
namespace {

using One = Eigen::Matrix<double, 1, 1>;
using Plane = Eigen::Vector2d;

template <class Polynomials>
struct Stabilised : testing::Test {};
using Families = testing::Types<Rkc2, Rkl2>;
TYPED_TEST_SUITE(Stabilised, Families, MethodId);

/// A system that claims a spectral radius, and so decides how many stages there are.
template <class Base>
struct Claiming : Base {
  double radius;
  [[nodiscard]] real_of<typename Base::State> spectral_radius(real_of<typename Base::State>,
                                                              const typename Base::State&) const {
    return static_cast<real_of<typename Base::State>>(radius);
  }
};
template <class Base>
Claiming<Base> claiming(Base system, double radius) {
  return {system, radius};
}

/// The numbers of stages a method uses, up to `most`.
template <class Polynomials>
std::vector<int> stage_numbers(int most) {
  std::vector<int> numbers;
  for (int s = 2; s <= most; ++s)
    if (Polynomials::template stages<double>(0.999 * Polynomials::template reach<double>(s)) == s)
      numbers.push_back(s);
  EXPECT_GT(numbers.size(), static_cast<std::size_t>(most / 3));
  return numbers;
}

/// R(z) by the recurrence itself.
template <class Real, class Number>
Number by_recurrence(const std::vector<StabilizedStage<Real>>& stages, Number z) {
  Number older = 1, newer = Real(1) + z * stages[0].mu_f;
  for (std::size_t j = 1; j < stages.size(); ++j) {
    const auto& c = stages[j];
    older = std::exchange(newer, c.mu * newer + c.nu * older + c.rest + z * (c.mu_f * newer + c.gamma_f));
  }
  return newer;
}

TYPED_TEST(Stabilised, ReachesAsFarAsPublishedAndNoFarther) {
  using Real = long double;
  for (const int s : stage_numbers<TypeParam>(60)) {
    std::vector<StabilizedStage<Real>> stages;
    make_stages<TypeParam>(s, stages);
    const auto grows = [&](Real z) { return std::abs(by_recurrence(stages, z)) > 1; };
    const Real reach = TypeParam::template reach<Real>(s), step = reach / (100 * s);
    Real exit = step;
    while (!grows(-exit)) exit += step;
    EXPECT_GE(exit, reach) << s;
    // Beyond it both polynomials oscillate no longer: an even s leaves at once, an odd one has to pass -1.
    EXPECT_LE(exit, 1.002L * reach + 1) << s;
  }
}

TYPED_TEST(Stabilised, GrowsALittleOnTheImaginaryAxisHoweverManyStagesItHas) {
  // |R(iy)| = 1 + (1/8 - c3 + c4) y^4 + ... where c3, c4 are the next coefficients of R.
  using Real = long double;
  const Real y = 0.05L;
  for (const int s : stage_numbers<TypeParam>(60)) {
    std::vector<StabilizedStage<Real>> stages;
    make_stages<TypeParam>(s, stages);
    const Real growth = std::abs(by_recurrence(stages, std::complex<Real>(0, y))) - 1;
    EXPECT_GT(growth, 0) << s;
    EXPECT_LT(growth, 0.13L * y * y * y * y) << s;
  }
}

TEST(Rkc2, HasThePublishedBounds) {
  EXPECT_NEAR(Rkc2::reach<double>(2), 2 * (1 - 4.0 / 195), 1e-15);
  EXPECT_NEAR(Rkc2::reach<double>(10), 66 * (1 - 4.0 / 195), 1e-13);
  EXPECT_EQ(Rkl2::reach<double>(5), 14);
}

/// R(z) from closed forms: Chebyshev polynomials and their derivatives as hyperbolic cosines.
std::complex<double> stability_polynomial(Rkc2, int s, std::complex<double> z) {
  const double n = s, w0 = 1 + 2 / (13 * n * n), u = std::acosh(w0), root = std::sinh(u);
  const double d = n * std::sinh(n * u) / root;
  const double d2 = (n * n * std::cosh(n * u) - w0 * d) / (root * root);
  const double b = d2 / (d * d);
  return 1 - b * std::cosh(n * u) + b * std::cos(n * std::acos(w0 + (d / d2) * z));
}
/// Legendre polynomials of the standard library, which knows them on [-1, 1].
std::complex<double> stability_polynomial(Rkl2, int s, std::complex<double> z) {
  const double n = s, w1 = 4 / (n * n + n - 2), b = (n * n + n - 2) / (2 * n * (n + 1));
  return 1 - b + b * std::legendre(static_cast<unsigned>(s), 1 + w1 * z.real());
}

template <class Polynomials, class State>
double worst_defect(bool complex) {
  double worst = 0;
  for (const int s : stage_numbers<Polynomials>(25))
    for (const double part : {0.01, 0.1, 0.3, 0.5, 0.77, 0.99}) {
      std::complex<double> z = -part * Polynomials::template reach<double>(s);
      if (complex) z += std::complex<double>(0, 0.4);
      const double h = 0.7, radius = 0.999 * Polynomials::template reach<double>(s) / h;
      Decay<State> decay{State::Constant(2, typename State::Scalar())};
      if constexpr (Eigen::NumTraits<typename State::Scalar>::IsComplex)
        decay.lambda.fill(z / h);
      else
        decay.lambda.fill(z.real() / h);
      const auto system = claiming(decay, radius);
      StabilizedRk<Polynomials, State> stepper;
      State y = State::Ones(2), y_new = y;
      stepper.init(system, 0, y);
      stepper.attempt(system, 0, y, h, y_new);
      EXPECT_EQ(stepper.stages(), s);
      const std::complex<double> R = stability_polynomial(Polynomials{}, s, z);
      for (const auto& component : y_new)
        worst = std::max(worst, std::abs(component - R) / std::max(1.0, std::abs(R)));
    }
  return worst;
}

TYPED_TEST(Stabilised, StepMultipliesByTheStabilityFunction) {
  EXPECT_LT((worst_defect<TypeParam, Plane>(false)), 1e-12);
  EXPECT_LT((worst_defect<TypeParam, Eigen::VectorXd>(false)), 1e-12);
}
TEST(Rkc2, StepMultipliesByTheStabilityFunctionOfComplexNumbers) {
  EXPECT_LT((worst_defect<Rkc2, Eigen::VectorXcd>(true)), 1e-12);
}

/// y' = y cos t - (y^3 - exp(3 sin t)) / 10, y = exp(sin t): nonlinear in y and dependent on t.
template <class Real>
auto driven() {
  using State = Eigen::Matrix<Real, 1, 1>;
  return system_of<State>([](Real t, const State& y, State& dydt) {
    dydt[0] = y[0] * std::cos(t) - (y[0] * y[0] * y[0] - std::exp(3 * std::sin(t))) / 10;
  });
}

/// log2 of what halving h does to the error at t = 2, with `stages` stages.
template <class Polynomials>
double observed_order(int stages) {
  using Real = long double;
  using State = Eigen::Matrix<Real, 1, 1>;
  const auto error = [&](int steps) {
    const Real h = Real(2) / steps;
    State y(Real(1));
    const double radius = static_cast<double>(0.999L * Polynomials::template reach<Real>(stages) / h);
    const auto end = integrate(StabilizedRk<Polynomials, State>{}, claiming(driven<Real>(), radius),
                               Span<Real>{0, 2}, y, FixedStep<Real>(h));
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    return std::abs(y[0] - std::exp(std::sin(Real(2))));
  };
  return static_cast<double>(std::log2(error(512) / error(1024)));
}

TYPED_TEST(Stabilised, HasOrderTwoWithAnyNumberOfStages) {
  for (const int s : {TypeParam::template stages<double>(0), 5, 9, 31})
    EXPECT_NEAR(observed_order<TypeParam>(s), 2, 0.03) << s;
}

TYPED_TEST(Stabilised, IsExactOnQuadratics) {
  // y' = 3 t - 1 with more stages than it needs.
  const auto system =
      claiming(system_of<One>([](double t, const One&, One& dydt) { dydt[0] = 3 * t - 1; }), 90);
  const auto step = first_step<StabilizedRk<TypeParam, One>>(system, 0.5, One(0.25), 0.8);
  EXPECT_GT(step.stepper.stages(), 5);
  EXPECT_NEAR(step.y_new[0], 0.25 + 1.5 * (1.69 - 0.25) - 0.8, 1e-14);
  EXPECT_NEAR(step.error(Component{0}), 0, 1e-14);
}

TYPED_TEST(Stabilised, ErrorEstimateFallsWithTheThirdPower) {
  const auto estimate = [](long double h) {
    using State = Eigen::Matrix<long double, 1, 1>;
    const auto system = claiming(driven<long double>(), static_cast<double>(40 / h));
    const State y(std::exp(std::sin(0.3L)));
    return first_step<StabilizedRk<TypeParam, State>>(system, 0.3L, y, h).error(Component{0});
  };
  EXPECT_NEAR(static_cast<double>(std::log2(estimate(2e-3L) / estimate(1e-3L))), 3, 0.03);
}

TYPED_TEST(Stabilised, RejectedAttemptLeavesNoTrace) {
  expect_no_trace_of_rejected_attempts(StabilizedRk<TypeParam, Plane>{}, Pendulum<Plane>(), Plane(0.3, 0.5),
                                       {37});
}

TYPED_TEST(Stabilised, InterpolantMeetsBothEndsAndHasOrderThree) {
  const auto between = [](long double h, long double theta) {
    using State = Eigen::Matrix<long double, 1, 1>;
    const auto system = driven<long double>();
    const State y(std::exp(std::sin(0.3L)));
    auto step = first_step<StabilizedRk<TypeParam, State>>(system, 0.3L, y, h);
    const long double found = step.at(theta)[0];
    if (theta == 0) return std::abs(found - y[0]);
    if (theta == 1) return std::abs(found - step.y_new[0]);
    return std::abs(found - std::exp(std::sin(0.3L + theta * h)));
  };
  EXPECT_LT(between(0.1L, 0), 1e-18L);
  EXPECT_LT(between(0.1L, 1), 1e-18L);
  // The error of the step itself, O(h^3), is the larger part.
  EXPECT_NEAR(static_cast<double>(std::log2(between(2e-3L, 0.6L) / between(1e-3L, 0.6L))), 3, 0.05);
}

/// u_i' = (u_{i-1} - 2 u_i + u_{i+1}) (n + 1)^2, the heat equation on n points between cold ends.
struct Heat {
  using State = Eigen::VectorXd;
  Eigen::Index n;
  [[nodiscard]] Eigen::Index dim() const { return n; }
  void rhs(double, const State& u, State& dudt) const {
    const double scale = static_cast<double>((n + 1) * (n + 1));
    for (Eigen::Index i = 0; i < n; ++i)
      dudt[i] = scale * ((i > 0 ? u[i - 1] : 0) - 2 * u[i] + (i + 1 < n ? u[i + 1] : 0));
  }
  /// The slowest mode and its rate, - 4 (n + 1)^2 sin^2(pi / (2 (n + 1))).
  [[nodiscard]] State mode() const {
    return State::LinSpaced(n, 1, static_cast<double>(n)).unaryExpr([this](double i) {
      return std::sin(std::numbers::pi * i / static_cast<double>(n + 1));
    });
  }
  [[nodiscard]] double rate() const {
    const double s = std::sin(std::numbers::pi / (2 * static_cast<double>(n + 1)));
    return -4 * static_cast<double>((n + 1) * (n + 1)) * s * s;
  }
};

TYPED_TEST(Stabilised, TakesStepsAThousandTimesBeyondExplicitEuler) {
  const Heat heat{200};
  const double explicit_limit = 2 / (4.0 * 201 * 201), h = 0.0125;
  EXPECT_GT(h, 500 * explicit_limit);
  Stats stats;
  const Heat::State mode = heat.mode();
  Heat::State u = mode;
  u[37] += 0.5;  // every other mode
  const double part = u.dot(mode) / mode.squaredNorm();
  const auto end = integrate(StabilizedRk<TypeParam, Heat::State>{}, Counted(heat, stats), Span<double>{0, 1},
                             u, FixedStep<double>(h));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  const double exact = part * std::exp(heat.rate());
  EXPECT_NEAR(u.dot(mode) / mode.squaredNorm(), exact, 0.02 * exact);
  EXPECT_LT(u.cwiseAbs().maxCoeff(), 2e-3) << "the fast modes are damped, if slowly";
  // 80 steps of about sqrt(1.2 h rho / 0.65) stages, where explicit Euler would take 80 h rho / 2
  // evaluations.
  EXPECT_LT(stats.rhs, 80 * 70);
}

TYPED_TEST(Stabilised, FollowsATolerance) {
  const Heat heat{50};
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    Heat::State u = heat.mode();
    const auto end = integrate(StabilizedRk<TypeParam, Heat::State>{}, heat, Span<double>{0, 0.5}, u,
                               Adaptive<double, PiController>({tolerance, tolerance}, 3));
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_LT((u - std::exp(0.5 * heat.rate()) * heat.mode()).cwiseAbs().maxCoeff(), 20 * tolerance);
  }
}

TYPED_TEST(Stabilised, EvaluatesAsOftenAsItHasStages) {
  Stats stats;
  const auto system = claiming(Decay<One>{One(-3.0)}, 30.0);
  const Counted counted(system, stats);
  StabilizedRk<TypeParam, One> stepper;
  One y(1.0), y_new, between;
  stepper.init(counted, 0, y);
  stepper.attempt(counted, 0, y, 1, y_new);
  const int s = stepper.stages();
  EXPECT_EQ(stats.rhs, s + 1) << "the first slope of all";
  stepper.attempt(counted, 0, y, 1, y_new);
  EXPECT_EQ(stats.rhs, 2 * s + 1);
  stepper.interpolate(counted, 0, 1, y, y_new, 0.5, between);
  stepper.accept(y_new);
  stepper.attempt(counted, 1, y_new, 1, y);
  EXPECT_EQ(stats.rhs, 3 * s + 1) << "the last slope of the step before is the first of this one";
}

/// y' = -rate y with a rate that the test may change.
struct Changing {
  using State = One;
  const double* rate;
  static Eigen::Index dim() { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt[0] = -*rate * y[0]; }
};

TYPED_TEST(Stabilised, LooksAtTheSpectrumEvery25StepsAndAfterARejection) {
  double rate = 1;
  Stats stats;
  const Changing changing{&rate};
  const Counted system(changing, stats);
  StabilizedRk<TypeParam, One> stepper;
  One y(1.0), y_new;
  stepper.init(system, 0, y);
  std::vector<int> at;
  for (int step = 0; step < 60; ++step) {
    const std::int64_t before = stats.rhs;
    stepper.attempt(system, 0, y, 0.01, y_new);
    if (stats.rhs - before > stepper.stages() + (step == 0 ? 1 : 0)) at.push_back(step);
    stepper.accept(y_new);
    y = y_new;
  }
  EXPECT_EQ(at, (std::vector<int>{0, 25, 50}));
  rate = 1000;
  stepper.attempt(system, 0, y, 1, y_new);
  const int few = stepper.stages();
  stepper.reject();
  stepper.attempt(system, 0, y, 1, y_new);
  EXPECT_GE(stepper.stages(), TypeParam::template stages<double>(1000));
  EXPECT_LT(few, 4);
  const std::int64_t before = stats.rhs;
  stepper.reject();
  stepper.attempt(system, 0, y, 1, y_new);
  EXPECT_EQ(stats.rhs - before, stepper.stages()) << "once at the same point";
}

TYPED_TEST(Stabilised, SurvivesASpectrumThatGrowsSuddenly) {
  const auto system =
      system_of<One>([](double t, const One& y, One& dydt) { dydt[0] = -(t < 1 ? 1.0 : 1e5) * (y[0] - 1); });
  One y(2.0);
  const auto end = integrate(StabilizedRk<TypeParam, One>{}, system, Span<double>{0, 3}, y,
                             Adaptive<double, DeadbandController>({1e-5, 1e-5}, 3));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_NEAR(y[0], 1, 1e-4);
}

TYPED_TEST(Stabilised, NeverTakesMoreStagesThanRoundingPermits) {
  using Stepper = StabilizedRk<TypeParam, One>;
  const auto system = claiming(Decay<One>{One(-1e12)}, 1e12);
  Stepper stepper;
  One y(1.0), y_new;
  stepper.init(system, 0, y);
  stepper.attempt(system, 0, y, 1, y_new);
  EXPECT_NEAR(stepper.stages(), Stepper::max_stages(), 1);
  EXPECT_LT(10.0 * stepper.stages() * stepper.stages() * std::numeric_limits<double>::epsilon(), 2e-8);
  EXPECT_NEAR(stepper.longest_step() * 1e12, TypeParam::template reach<double>(Stepper::max_stages()), 1);
  // Steered by the error the step stays below that from then on.
  const auto end = integrate(Stepper{}, system, Span<double>{0, 1e-4}, y,
                             Adaptive<double, DeadbandController>({1e-2, 1e-2}, 3));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_NEAR(y[0], 0, 1e-2);
}

}  // namespace
}  // namespace hmax
