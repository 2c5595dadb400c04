/// Implicit-explicit methods: coupling conditions, both halves, stability in what is declared stiff, and what
/// the solution of the stage equations costs.
#include "integrators/implicit/imex.hpp"

#include <complex>
#include <functional>
#include <limits>
#include <random>

#include "integrators/integrate.hpp"
#include "problems/any_system.hpp"
#include "problems/oscillator/oscillator_exact.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "tests/integrators/methods.hpp"
#include "tests/integrators/rejected_attempts.hpp"
#include "tests/integrators/stability_function.hpp"

namespace hmax {
namespace {

using Plane = Eigen::Vector2d;

template <class Method>
struct Imex : testing::Test {};
using EveryImexPair = TestTypesOf<tableaux::AllImex>::type;
TYPED_TEST_SUITE(Imex, EveryImexPair, MethodId);

/// stiff(t, y) + nonstiff(t, y), with the Jacobian of the first. One type for all functions of a kind of
/// state: a method is compiled once for them.
template <class StateT>
struct Split {
  using State = StateT;
  using Real = real_of<State>;
  using Jacobian = jacobian_of<State>;
  using Function = std::function<void(Real t, const State& y, State& dydt)>;
  Function stiff, nonstiff;
  std::function<void(Real t, const State& y, Jacobian& J)> stiff_jacobian;

  [[nodiscard]] static Eigen::Index dim() { return State::RowsAtCompileTime; }
  void rhs(Real t, const State& y, State& dydt) const {
    State other = y;
    stiff(t, y, dydt);
    nonstiff(t, y, other);
    dydt += other;
  }
  void rhs_stiff(Real t, const State& y, State& dydt) const { stiff(t, y, dydt); }
  void rhs_nonstiff(Real t, const State& y, State& dydt) const { nonstiff(t, y, dydt); }
  void jacobian_stiff(Real t, const State& y, Jacobian& J) const { stiff_jacobian(t, y, J); }
};
const auto no_jacobian = [](auto, const auto& y, auto& J) { J.setZero(y.size(), y.size()); };
const auto nothing = [](auto, const auto& y, auto& dydt) { dydt.setZero(y.size()); };

/// y' = y cos t - (y^3 - exp(3 sin t)) / 10 with y = exp(sin t); the cubic part is declared stiff, and a part
/// of the linear one, so that both halves and their coupling decide about the order.
template <class Real>
auto coupled() {
  using State = Eigen::Matrix<Real, 1, 1>;
  return Split<State>{[](Real t, const State& y, State& dydt) {
                        dydt[0] = -(y[0] * y[0] * y[0] - std::exp(3 * std::sin(t))) / 10 + t * y[0];
                      },
                      [](Real t, const State& y, State& dydt) { dydt[0] = y[0] * std::cos(t) - t * y[0]; },
                      [](Real t, const State& y, auto& J) { J(0, 0) = -3 * y[0] * y[0] / 10 + t; }};
}

template <class Method, class Sys>
using ImexStepper = ImexRk<Method, typename Sys::State, jacobian_type<Sys>>;

/// log2 of what halving h does to the error at t_end.
template <class Method, class Sys>
double observed_order(const Sys& system, const typename Sys::State& y0, const typename Sys::State& exact,
                      real_of<typename Sys::State> t_end, int steps) {
  using Real = real_of<typename Sys::State>;
  const auto error = [&](int n) {
    typename Sys::State y = y0;
    integrate(ImexStepper<Method, Sys>{}, system, Span<Real>{0, t_end}, y, FixedStep<Real>(t_end / n));
    return (y - exact).norm();
  };
  return static_cast<double>(std::log2(error(steps) / error(2 * steps)));
}

TYPED_TEST(Imex, HasItsOrderWhenBothPartsAreNonlinearAndDependOnTime) {
  using State = Eigen::Matrix<long double, 1, 1>;
  const State exact(std::exp(std::sin(2.0L)));
  EXPECT_NEAR(observed_order<TypeParam>(coupled<long double>(), State(1.0L), exact, 2, 256), TypeParam::order,
              0.05);
}

TYPED_TEST(Imex, HasItsOrderOnTheLiverOscillators) {
  using System = BasicOscillator<long double>;
  const Plane y0(0.5, 1);
  const OscillatorParameters linear{.m = 1.3, .c = 0.4, .k1 = 5.3, .k3 = 0, .P = 0, .w = 0};
  const OscillatorParameters cubic{.m = 1.45, .c = 0, .k1 = 0.7, .k3 = 8, .P = 0, .w = 0};
  const OscillatorParameters forced{.m = 1.45, .c = 0.5, .k1 = 0.7, .k3 = 8, .P = 2, .w = 3};
  const auto expect_order = [&](const OscillatorParameters& p, const System::State& exact) {
    EXPECT_NEAR(observed_order<TypeParam>(System(p), y0.cast<long double>(), exact, 2, 1024),
                TypeParam::order, 0.1);
  };
  expect_order(linear, exact_solution(linear, y0)->extended(2));
  expect_order(cubic, exact_solution(cubic, y0)->extended(2));
  expect_order(forced, OscillatorReference(forced, y0, 2).extended_at(2));
}

TEST(ImexTrees, AreAsManyAsTheBicolouredTrees) {
  // Rooted trees whose other nodes have one of two colours: 1, 2, 7, 26, 107 (OEIS A000151).
  const std::vector<long double> a(1, 1);
  std::vector<int> count(6, 0);
  visit_trees(std::array<std::span<const long double>, 2>{a, a}, 1, 5,
              [&](int nodes, long double, std::span<const long double>) {
                ++count[static_cast<std::size_t>(nodes)];
                return true;
              });
  EXPECT_EQ(count, (std::vector<int>{0, 1, 2, 7, 26, 107}));
}

using Complex = std::complex<double>;
using OneComplex = Eigen::Matrix<Complex, 1, 1>;

/// y' = nonstiff y + stiff y.
auto two_rates(Complex nonstiff, Complex stiff) {
  return Split<OneComplex>{[=](double, const OneComplex& y, OneComplex& dydt) { dydt[0] = stiff * y[0]; },
                           [=](double, const OneComplex& y, OneComplex& dydt) { dydt[0] = nonstiff * y[0]; },
                           [=](double, const OneComplex&, auto& J) { J(0, 0) = stiff; }};
}

/// R(zE, zI) = 1 + (zE bE + zI bI) . (1 - zE AE - zI AI)^-1 1.
template <class Method>
std::complex<long double> additive_stability_function(std::complex<long double> zE,
                                                      std::complex<long double> zI) {
  const auto& [nonstiff, stiff] = Method::tableau;
  return stability_function(
      Method::tableau.stages,
      [&, &E = nonstiff.a, &I = stiff.a](std::size_t i, std::size_t j) {
        return zE * E[i][j] + zI * I[i][j];
      },
      [&, &E = nonstiff.b, &I = stiff.b](std::size_t i) { return zE * E[i] + zI * I[i]; });
}

template <class Method>
Complex one_step(Complex zE, Complex zI, double h) {
  const auto system = two_rates(zE / h, zI / h);
  ImexStepper<Method, decltype(system)> stepper;
  OneComplex y(1.0), y_new;
  stepper.init(system, 0, y);
  EXPECT_EQ(stepper.attempt(system, 0, y, h, y_new), StepStatus::ok);
  return y_new[0];
}

TYPED_TEST(Imex, StepMultipliesByTheStabilityFunctionOfBothParts) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, 6.283), size(0, 3), left(1.6, 4.6), far(-2, 4);
  for (int repeat = 0; repeat < 500; ++repeat) {
    const Complex zE = std::polar(size(random), angle(random));
    const Complex zI = std::polar(std::pow(10, far(random)), left(random));
    const Complex R(additive_stability_function<TypeParam>(zE, zI));
    // Far out R is the small difference of large numbers.
    const double scale = std::max({1.0, std::abs(R), 10 * std::abs(zI)});
    EXPECT_LT(std::abs(one_step<TypeParam>(zE, zI, 0.3) - R), 1e-13 * scale) << zE << zI;
  }
}

TYPED_TEST(Imex, DampsInfinitelyStiffPartsAtOnce) {
  for (const Complex direction : {Complex(-1, 0), Complex(0, 1), Complex(-1, 1)})
    EXPECT_LT(std::abs(one_step<TypeParam>(0.0, 1e7 * direction, 0.1)), 1e-5);
  for (double y = 0.01; y < 1e5; y *= 1.1)
    EXPECT_LE(std::abs(additive_stability_function<TypeParam>(0, {0, y})), 1 + 1e-15L)
        << "A-stable on the imaginary axis";
}

TYPED_TEST(Imex, WithoutAStiffPartIsItsExplicitHalf) {
  const Pendulum<Plane> pendulum;
  const auto system = Split<Plane>{
      nothing, [&](double t, const Plane& y, Plane& dydt) { pendulum.rhs(t, y, dydt); }, no_jacobian};
  constexpr auto& half = TypeParam::tableau.nonstiff;
  const auto a = detail::flattened(half.a);
  ExplicitRk<RuntimeTableau, Plane> explicit_half(RuntimeTableau{.name = "half",
                                                                 .a = {a.begin(), a.end()},
                                                                 .b = {half.b.begin(), half.b.end()},
                                                                 .b_err = {},
                                                                 .c = {half.c.begin(), half.c.end()},
                                                                 .computed_order = TypeParam::order,
                                                                 .embedded_order = 0});
  Plane one(0.3, 0.5), other = one;
  integrate(ImexStepper<TypeParam, decltype(system)>{}, system, Span<double>{0, 5}, one,
            FixedStep<double>(0.1));
  integrate(explicit_half, pendulum, Span<double>{0, 5}, other, FixedStep<double>(0.1));
  EXPECT_LT((one - other).norm(), 1e-14);
}

TYPED_TEST(Imex, WithoutANonstiffPartSolvesTheEquationsOfItsImplicitHalf) {
  const Pendulum<Plane> pendulum;
  const auto jacobian = [](double, const Plane& y, auto& J) { J << 0, 1, -std::cos(y[0]), -0.1; };
  const auto system = Split<Plane>{[&](double t, const Plane& y, Plane& dydt) { pendulum.rhs(t, y, dydt); },
                                   nothing, jacobian};
  constexpr auto& half = TypeParam::tableau.stiff;
  const double t = 0.2, h = 0.3;
  const Plane y(0.3, 0.5);
  Plane y_new, expected = y;
  ImexStepper<TypeParam, decltype(system)> stepper;
  stepper.init(system, t, y);
  stepper.attempt(system, t, y, h, y_new);
  // The stages by plain fixed-point iteration, which contracts at this step.
  std::vector<Plane> k;
  for (std::size_t i = 0; i < half.stages; ++i) {
    Plane base = y, slope = Plane::Zero();
    for (std::size_t j = 0; j < i; ++j) base += h * static_cast<double>(half.a[i][j]) * k[j];
    for (int iteration = 0; iteration < 100; ++iteration) {
      const Plane Y = base + h * static_cast<double>(half.a[i][i]) * slope;
      pendulum.rhs(t + static_cast<double>(half.c[i]) * h, Y, slope);
    }
    k.push_back(slope);
    expected += h * static_cast<double>(half.b[i]) * slope;
  }
  EXPECT_LT((y_new - expected).norm(), 1e-14);
}

TYPED_TEST(Imex, HoldsAStiffSpringAtStepsFarBeyondTheExplicitLimit) {
  // omega = 830 1/s: the explicit limit is about 0.003 s.
  const OscillatorParameters p{.m = 1.45, .c = 2, .k1 = 1e6, .k3 = 0.8, .P = 0.5, .w = 0.5};
  Stats unread;
  const Counted system(Oscillator(p), unread);
  Plane y(0.5, 1), left = y;
  const auto end = integrate(ImexStepper<TypeParam, Oscillator>{}, system, Span<double>{0, 100}, y,
                             FixedStep<double>(0.1));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  // What is left is the slow motion, the force over the stiffness.
  EXPECT_NEAR(y[0], p.P * std::cos(p.w * 100) / p.k1, 2e-8);
  EXPECT_EQ(integrate(Rk<tableaux::Rk4, Plane>{}, system, Span<double>{0, 100}, left, FixedStep<double>(0.1))
                .outcome,
            Outcome::diverged);
}

TYPED_TEST(Imex, RejectedAttemptLeavesNoTrace) {
  expect_no_trace_of_rejected_attempts(ImexStepper<TypeParam, Oscillator>{}, Oscillator(), Plane(0.3, 0.5),
                                       {3.7});
}

TYPED_TEST(Imex, InterpolantMeetsBothEndsAndKeepsTheOrderOfTheMethod) {
  using State = Eigen::Matrix<long double, 1, 1>;
  const auto system = coupled<long double>();
  const auto between = [&](long double h, long double theta) {
    using StepperT = ImexStepper<TypeParam, std::remove_const_t<decltype(system)>>;
    auto step = first_step<StepperT>(system, 0.3L, State(std::exp(std::sin(0.3L))), h);
    const long double found = step.at(theta)[0];
    if (theta == 0) return std::abs(found - step.y[0]);
    if (theta == 1) return std::abs(found - step.y_new[0]);
    return std::abs(found - std::exp(std::sin(0.3L + theta * h)));
  };
  EXPECT_LT(between(0.1L, 0), 1e-18L);
  EXPECT_LT(between(0.1L, 1), 1e-18L);
  const double order = std::min(TypeParam::order, 3) + 1;
  EXPECT_NEAR(static_cast<double>(std::log2(between(2e-3L, 0.6L) / between(1e-3L, 0.6L))), order, 0.1);
}

TYPED_TEST(Imex, ErrorEstimateHasTheOrderItClaims) {
  if constexpr (TypeParam::error_order > 0) {
    const auto estimate = [](long double h) {
      using State = Eigen::Matrix<long double, 1, 1>;
      const auto system = coupled<long double>();
      using StepperT = ImexStepper<TypeParam, std::remove_const_t<decltype(system)>>;
      return first_step<StepperT>(system, 0.9L, State(std::exp(std::sin(0.9L))), h).error(Component{0});
    };
    EXPECT_NEAR(static_cast<double>(std::log2(estimate(2e-3L) / estimate(1e-3L))), TypeParam::error_order,
                0.1);
  }
}

/// An oscillator that does not say that its stiff part is linear.
struct Unaware : Oscillator {
  Unaware() = default;
  [[nodiscard]] static bool has_linear_stiff_part() { return false; }
};

TYPED_TEST(Imex, SolvesALinearStiffPartByOneCorrectionAndOneMatrix) {
  constexpr std::int64_t implicit_stages = TypeParam::tableau.stages - 1;
  Stats counts;
  Plane y(0.5, 1), other = y;
  const auto end = integrate(ImexStepper<TypeParam, Oscillator>{}, Counted(Oscillator(), counts),
                             Span<double>{0, 10}, y, FixedStep<double>(0.1));
  EXPECT_EQ(end.stats.newton, 100 * implicit_stages);
  EXPECT_EQ(end.stats.factorisations, 1);
  EXPECT_EQ(counts.jacobian, 1);
  // Each half at the start of a step and the stiff part once a correction; Euler needs less of both.
  const std::int64_t nonstiff = TypeParam::order == 1 ? 1 : implicit_stages + 1;
  const std::int64_t stiff = TypeParam::order == 1 ? 1 : implicit_stages + 1;
  EXPECT_EQ(counts.rhs, 100 * (nonstiff + stiff));

  const auto iterated = integrate(ImexStepper<TypeParam, Unaware>{}, Unaware(), Span<double>{0, 10}, other,
                                  FixedStep<double>(0.1));
  EXPECT_LE(iterated.stats.newton, 200 * implicit_stages + 5);
  EXPECT_LT((y - other).norm(), 1e-13);
}

/// Three masses in a row: springs and dampers are the stiff part, cubic springs to the ground the other one.
struct ThreeMasses {
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::SparseMatrix<double>;
  using Jacobian = Eigen::SparseMatrix<double>;
  static constexpr bool linear_stiff_part = true;
  Eigen::Vector3d masses{0.5, 2, 1};

  static Eigen::Matrix3d K() { return Eigen::Matrix3d{{900, -400, 0}, {-400, 700, -300}, {0, -300, 300}}; }
  static Eigen::Matrix3d C() { return Eigen::Matrix3d{{3, -1, 0}, {-1, 2, -1}, {0, -1, 1}}; }
  static Eigen::Index dim() { return 6; }
  static Eigen::Index dofs() { return 3; }
  [[nodiscard]] Dofs mass() const { return masses; }
  void force(double, const Dofs& q, const Dofs& v, Dofs& f) const {
    f = -(K() * q + C() * v) - 50 * q.array().cube().matrix();
  }
  void stiffness(double, const Dofs& q, const Dofs&, DofMatrix& matrix) const {
    Eigen::Matrix3d tangent = K();
    tangent.diagonal() += 150 * q.cwiseAbs2();
    matrix = tangent.sparseView();
  }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& matrix) const { matrix = C().sparseView(); }
  void rhs_stiff(double, const State& y, State& dydt) const {
    dydt << y.tail(3), (-(K() * y.head(3) + C() * y.tail(3))).cwiseQuotient(masses);
  }
  void rhs_nonstiff(double, const State& y, State& dydt) const {
    dydt << Eigen::Vector3d::Zero(), (-50 * y.head(3).array().cube().matrix()).cwiseQuotient(masses);
  }
  void rhs(double t, const State& y, State& dydt) const {
    State other(6);
    rhs_stiff(t, y, dydt);
    rhs_nonstiff(t, y, other);
    dydt += other;
  }
  void jacobian_stiff(double, const State&, Jacobian& J) const {
    Eigen::MatrixXd packed = Eigen::MatrixXd::Zero(6, 6);
    packed.topRightCorner(3, 3).setIdentity();
    packed.bottomRows(3) << -(masses.cwiseInverse().asDiagonal() * K()),
        -(masses.cwiseInverse().asDiagonal() * C());
    J = packed.sparseView();
  }
  void stiffness_stiff(DofMatrix& matrix) const { matrix = K().sparseView(); }
  void damping_stiff(DofMatrix& matrix) const { matrix = C().sparseView(); }
};

template <class Method>
struct ImexOfAStructure : testing::Test {};
using OneOfEachOrder = testing::Types<tableaux::ImexEuler, tableaux::ImexArk324>;
TYPED_TEST_SUITE(ImexOfAStructure, OneOfEachOrder, MethodId);

TYPED_TEST(ImexOfAStructure, ReducesItsEquationsToItsVelocities) {
  using Reduced = ImexRk<TypeParam, ThreeMasses::State, stiff_equations_type<ThreeMasses>>;
  static_assert(std::is_same_v<stiff_equations_type<ThreeMasses>, MechanicalJacobian<double>>);
  ThreeMasses::State start(6);
  start << 0.1, -0.2, 0.3, 1, 0, -1;
  for (const Span<double> span : {Span<double>{0, 1}, Span<double>{0.125, 0}}) {
    ThreeMasses::State packed = start, reduced = start;
    integrate(ImexStepper<TypeParam, ThreeMasses>{}, ThreeMasses{}, span, packed,
              FixedStep<double>(1.0 / 64));
    const auto end = integrate(Reduced{}, ThreeMasses{}, span, reduced, FixedStep<double>(1.0 / 64));
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_EQ(end.stats.factorisations, 1);
    EXPECT_LT((packed - reduced).norm(), 1e-11 * packed.norm());
    EXPECT_GT(packed.norm(), 1e-3);
  }
}

TEST(StiffPart, OfAnErasedStructureIsAStructure) {
  const AnySystem system{ThreeMasses{}};
  const StiffPart<AnySystem> stiff(system);
  stiff_equations_type<AnySystem> J;
  JacobianSource<AnySystem::State, stiff_equations_type<AnySystem>> source;
  source.init(stiff);
  const AnySystem::State y = AnySystem::State::Ones(6);
  source.evaluate(stiff, 0, y, J);
  ASSERT_TRUE(std::holds_alternative<MechanicalJacobian<double>>(J));
  const auto& parts = std::get<MechanicalJacobian<double>>(J);
  EXPECT_EQ(Eigen::Matrix3d(parts.stiffness), ThreeMasses::K());
  EXPECT_EQ(Eigen::Matrix3d(parts.damping), ThreeMasses::C());
  EXPECT_EQ(Eigen::Vector3d(parts.mass.diagonal()), ThreeMasses{}.masses);
}

TYPED_TEST(ImexOfAStructure, SaysWhereTruncatedIterationsDoNotSolveItsEquations) {
  using Reduced = ImexRk<TypeParam, ThreeMasses::State, stiff_equations_type<ThreeMasses>>;
  ThreeMasses::State start(6);
  start << 0.1, -0.2, 0.3, 1, 0, -1;
  ThreeMasses::State exact = start, truncated = start;
  integrate(Reduced{}, ThreeMasses{}, Span<double>{0, 1}, exact, FixedStep<double>(1.0 / 64));
  Reduced stepper;
  stepper.set_linear_solve({.by = LinearSolve::By::conjugate_gradients, .tolerance = 0.1, .iterations = 1});
  const auto end =
      integrate(stepper, ThreeMasses{}, Span<double>{0, 1}, truncated, FixedStep<double>(1.0 / 64));
  if (end.outcome == Outcome::reached_end)
    EXPECT_LT((truncated - exact).norm(), 1e-3 * exact.norm());
  else
    EXPECT_EQ(end.outcome, Outcome::newton_failed);
}

TYPED_TEST(Imex, TakesJacobiansAsAsked) {
  for (const auto& [update, expected] :
       {std::pair{JacobianUpdate{JacobianUpdate::frozen}, 1}, std::pair{JacobianUpdate{1}, 50},
        std::pair{JacobianUpdate{20}, 3}}) {
    Stats counts;
    Plane y(0.5, 1);
    ImexStepper<TypeParam, Oscillator> stepper;
    stepper.set_jacobian_update(update);
    integrate(stepper, Counted(Oscillator(), counts), Span<double>{0, 5}, y, FixedStep<double>(0.1));
    EXPECT_EQ(counts.jacobian, expected);
  }
}

TYPED_TEST(Imex, SaysWhenItsEquationsHaveNoSolution) {
  // 1 - h gamma J = 0 exactly.
  const double h = 0.5, gamma = static_cast<double>(TypeParam::tableau.stiff.a[1][1]);
  using Real1 = Eigen::Matrix<double, 1, 1>;
  const double rate = 1 / (h * gamma);
  const auto singular = Split<Real1>{[=](double, const Real1& y, Real1& dydt) { dydt[0] = rate * y[0]; },
                                     nothing, [=](double, const Real1&, auto& J) { J(0, 0) = rate; }};
  Real1 y(1.0);
  const auto end = integrate(ImexStepper<TypeParam, std::remove_const_t<decltype(singular)>>{}, singular,
                             Span<double>{0, 1}, y, FixedStep<double>(h));
  if (1 - h * gamma * rate == 0) {
    EXPECT_EQ(end.outcome, Outcome::newton_failed);
  }

  const auto nowhere = Split<Real1>{
      [](double, const Real1&, Real1& dydt) { dydt[0] = std::numeric_limits<double>::quiet_NaN(); }, nothing,
      no_jacobian};
  EXPECT_EQ(integrate(ImexStepper<TypeParam, std::remove_const_t<decltype(nowhere)>>{}, nowhere,
                      Span<double>{0, 1}, y, FixedStep<double>(h))
                .outcome,
            Outcome::newton_failed);
}

TYPED_TEST(Imex, FollowsAToleranceHoweverStiffThePartIs) {
  if constexpr (TypeParam::error_order > 0) {
    // Prothero and Robinson: y' = -sin t + lambda (y - cos t), y = cos t.
    using Real1 = Eigen::Matrix<double, 1, 1>;
    for (const double lambda : {-1.0, -1e3, -1e6, -1e9}) {
      const auto system = Split<Real1>{
          [=](double t, const Real1& y, Real1& dydt) { dydt[0] = lambda * (y[0] - std::cos(t)); },
          [](double t, const Real1&, Real1& dydt) { dydt[0] = -std::sin(t); },
          [=](double, const Real1&, auto& J) { J(0, 0) = lambda; }};
      for (const double tolerance : {1e-4, 1e-7}) {
        Real1 y(1.0);
        const auto end = integrate(
            ImexStepper<TypeParam, std::remove_const_t<decltype(system)>>{}, system, Span<double>{0, 10}, y,
            Adaptive<double, PiController>({tolerance, tolerance}, TypeParam::error_order));
        EXPECT_EQ(end.outcome, Outcome::reached_end) << lambda;
        // lambda times the rounding of the cosine decides which steps are rejected: between two libraries
        // that are right to a unit in the last place the error varies from 1 to 25 tolerances.
        EXPECT_NEAR(y[0], std::cos(10.0), 50 * tolerance) << lambda;
        EXPECT_LT(end.stats.steps, 10000) << lambda;
      }
    }
  }
}

}  // namespace
}  // namespace hmax
