/// Derivatives and linear equations of implicit methods.
#include "integrators/implicit/jacobian.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/explicit/adaptive.hpp"
#include "integrators/implicit/rosenbrock.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"
#include "integrators/integrate.hpp"
#include "integrators/saved_state.hpp"
#include "integrators/stats.hpp"
#include "problems/any_system.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {
namespace {

static_assert(DifferentiableSystem<AnySystem> && SecondOrderSystem<AnySystem> && SplitSystem<AnySystem> &&
              BoundedSpectrumSystem<AnySystem> && TimeDifferentiableSystem<AnySystem>);
static_assert(SecondOrderSystem<Oscillator> && SplitSystem<Oscillator> && BoundedSpectrumSystem<Oscillator>);
static_assert(SecondOrderSystem<Counted<Oscillator>> && SplitSystem<Counted<AnySystem>> &&
              DifferentiableSystem<Counted<Oscillator>> && TimeSplitSystem<Counted<Oscillator>>);

const OscillatorParameters parameters{.m = 1.3, .c = 0.7, .k1 = 0.9, .k3 = 2.1, .P = 0.4, .w = 1.7};
const Eigen::Vector2d y(0.6, -0.3);

/// The oscillator of `parameters` as somebody writes it who knows no derivatives.
struct PlainOscillator {
  using State = Eigen::VectorXd;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  static void rhs(double t, const State& u, State& dudt) {
    dudt[0] = u[1];
    dudt[1] = (0.4 * std::cos(1.7 * t) - 0.7 * u[1] - 0.9 * u[0] - 2.1 * u[0] * u[0] * u[0]) / 1.3;
  }
};

TEST(JacobianSource, DifferencesComeNearTheSystemsOwn) {
  const Oscillator oscillator(parameters);
  Eigen::Matrix2d exact;
  oscillator.jacobian(0.8, y, exact);
  const AnySystem system(PlainOscillator{});
  ASSERT_FALSE(has_jacobian(system));
  JacobianSource<AnySystem::State, AnySystem::Jacobian> source;
  source.init(system);
  AnySystem::Jacobian J;
  source.evaluate(system, 0.8, y, J);
  EXPECT_LT((std::get<0>(J) - exact).cwiseAbs().maxCoeff(), 1e-7);
}

/// x' = 1 - sqrt(s x), s = 1 or -1: defined on one side of 0, where its slope is infinite.
struct Draining {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  double s = 1;
  static Eigen::Index dim() { return 1; }
  void rhs(double, const State& u, State& dudt) const { dudt[0] = s * (1 - std::sqrt(s * u[0])); }
  void jacobian(double, const State& u, Jacobian& J) const {
    J.setConstant(1, 1, -0.5 / std::sqrt(s * u[0]));
  }
};

TEST(JacobianSource, ASlopeThatIsInfiniteIsADifferenceIntoTheDomain) {
  for (const double s : {1.0, -1.0}) {
    const Draining system{s};
    JacobianSource<Eigen::VectorXd, Eigen::MatrixXd> source;
    source.init(system);
    Eigen::MatrixXd J;
    source.evaluate(system, 0, Eigen::VectorXd::Zero(1), J);
    EXPECT_TRUE(J.allFinite()) << s;
    EXPECT_LT(J(0, 0), -1) << s;
    source.evaluate(system, 0, Eigen::VectorXd::Constant(1, s / 4), J);
    EXPECT_DOUBLE_EQ(J(0, 0), -1) << "its own where that is finite";
    // With u = sqrt(s x): t = -2 u - 2 ln(1 - u).
    Eigen::VectorXd x = Eigen::VectorXd::Zero(1);
    const auto end = integrate(Rosenbrock<tableaux::Rodas4, Eigen::VectorXd, Eigen::MatrixXd>(), system,
                               Span<double>{0, 4}, x,
                               adaptive<tableaux::Rodas4>(Tolerances<double>{1e-6, 1e-9}), ObserveNothing{});
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    const double u = std::sqrt(s * x[0]);
    EXPECT_NEAR(-2 * u - 2 * std::log(1 - u), 4, 1e-4);
  }
}

/// y' = (s t)^0.3 - y, whose slope in time is infinite at 0, where its domain ends.
struct RootOfTime {
  using State = Eigen::VectorXd;
  double s;
  static Eigen::Index dim() { return 1; }
  void rhs(double t, const State& at, State& f) const { f = State::Constant(1, std::pow(s * t, 0.3)) - at; }
  void jacobian(double, const State&, Eigen::MatrixXd& J) const { J = -Eigen::MatrixXd::Identity(1, 1); }
  void time_derivative(double t, const State&, State& dfdt) const {
    dfdt = State::Constant(1, 0.3 * s * std::pow(s * t, -0.7));
  }
};

TEST(TimeDerivative, ThatIsInfiniteIsTheSecantOverTheStep) {
  for (const double h : {0.1, 0.01}) {
    Eigen::VectorXd reached = Eigen::VectorXd::Ones(1);
    const auto end =
        integrate(Rosenbrock<tableaux::Rodas4, Eigen::VectorXd, Eigen::MatrixXd>(), RootOfTime{1},
                  Span<double>{0, 1}, reached, FixedStep<double>(h), ObserveNothing{});
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    // (1 + integral of e^t t^0.3 from 0 to 1) / e
    EXPECT_NEAR(reached[0], 0.8842680349, 0.5 * h);
  }
  // The domain ends on the other side.
  const RootOfTime back{-1};
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), f0 = -one;
  Eigen::VectorXd dfdt(1);
  evaluate_time_derivative(back, 0.0, -0.1, one, f0, dfdt);
  EXPECT_NEAR(dfdt[0], std::pow(0.1, 0.3) / -0.1, 1e-12);
}

TEST(JacobianSource, TimeDerivativeByDifferencesComesNearTheSystemsOwn) {
  const Oscillator oscillator(parameters);
  Eigen::Vector2d exact;
  oscillator.time_derivative(0.8, y, exact);
  const AnySystem system(PlainOscillator{});
  Eigen::VectorXd f0(2), dfdt(2);
  system.rhs(0.8, y, f0);
  evaluate_time_derivative(system, 0.8, 0.1, Eigen::VectorXd(y), f0, dfdt);
  EXPECT_LT((dfdt - exact).cwiseAbs().maxCoeff(), 1e-7);
}

/// y' = b - 50 y, without a Jacobian.
struct Filling {
  using State = Eigen::VectorXd;
  double b;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& u, State& dudt) const {
    dudt[0] = b - 50 * u[0];
    dudt[1] = u[0] - 3 * u[1];
  }
};

TEST(JacobianSource, DifferencesFromZeroSeeWhatLargeConstantsHide) {
  for (const double b : {1.0, 1e10, 1e26}) {
    const Filling filling{b};
    JacobianSource<Eigen::VectorXd, Eigen::MatrixXd> source;
    Eigen::MatrixXd J;
    source.init(filling);
    source.evaluate(filling, 0, Eigen::VectorXd::Zero(2), J);
    EXPECT_NEAR(J(0, 0), -50, 0.01) << b;
    EXPECT_NEAR(J(1, 0), 1, 1e-4) << b;
    EXPECT_NEAR(J(1, 1), -3, 1e-4) << b;
    EXPECT_NEAR(J(0, 1), 0, 1e-2) << b;
  }
}

/// x' = 3, y' = sqrt(1 - y^2), which is defined for |y| <= 1 alone; counts evaluations.
struct Bounded {
  using State = Eigen::VectorXd;
  mutable int calls = 0;
  mutable double farthest = 0;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& u, State& dudt) const {
    ++calls;
    farthest = std::max(farthest, u.cwiseAbs().maxCoeff());
    if (std::abs(u[1]) > 1) throw std::domain_error("outside");
    dudt[0] = 3;
    dudt[1] = std::sqrt(1 - u[1] * u[1]);
  }
};

TEST(JacobianSource, ARowThatDependsOnNothingIsNotSearchedFarFromTheState) {
  for (const double at : {0.0, 1e-6, 0.5, 0.9}) {
    const Bounded system;
    JacobianSource<Eigen::VectorXd, Eigen::MatrixXd> source;
    Eigen::MatrixXd J;
    source.init(system);
    const Eigen::VectorXd u = Eigen::Vector2d(0, at);
    ASSERT_NO_THROW(source.evaluate(system, 0, u, J)) << at;
    EXPECT_EQ(J.row(0).cwiseAbs().maxCoeff(), 0);
    EXPECT_NEAR(J(1, 1), -at / std::sqrt(1 - at * at), 1e-6);
    EXPECT_LE(system.farthest, 1.01 * at + 1e-3);
    EXPECT_LE(system.calls, 11);  // f, two columns, and at most four increments more for each
  }
}

TEST(JacobianSource, TheSearchForHiddenColumnsEndsAlsoInARunThatGoesOn) {
  const Bounded system;
  const Eigen::VectorXd u = Eigen::Vector2d(0, 0.5);
  Eigen::MatrixXd J;
  const auto cost = [&](auto& source) {
    const int before = system.calls;
    source.evaluate(system, 0, u, J);
    return system.calls - before;
  };
  JacobianSource<Eigen::VectorXd, Eigen::MatrixXd> first, resumed;
  first.init(system);
  const int searching = cost(first);
  for (int i = 0; i < 300; ++i) cost(first);
  ASSERT_EQ(cost(first), 3);
  ASSERT_GT(searching, 3);
  StateBytes bytes;
  StateSaver save(bytes);
  save(first);
  resumed.init(system);
  StateLoader load(bytes);
  load(resumed);
  EXPECT_EQ(cost(resumed), 3);
  first.init(system);
  EXPECT_EQ(cost(first), searching);
}

TEST(JacobianSource, DifferencesOfSmallStatesAreAsGoodAsThoseOfLargeOnes) {
  // f = -y - (y / s)^2 y with f' = -4 at y = s, whatever s is.
  for (const double s : {1e-18, 1e-12, 1.0, 1e12}) {
    struct Cube {
      using State = Eigen::VectorXd;
      double s;
      [[nodiscard]] static Eigen::Index dim() { return 1; }
      void rhs(double, const State& u, State& dudt) const {
        dudt[0] = -u[0] - u[0] * (u[0] / s) * (u[0] / s);
      }
    };
    const Cube cube{s};
    JacobianSource<Eigen::VectorXd, Eigen::MatrixXd> source;
    Eigen::MatrixXd J;
    source.init(cube);
    source.evaluate(cube, 0, Eigen::VectorXd::Constant(1, s), J);
    EXPECT_NEAR(J(0, 0), -4, 1e-6) << s;
  }
}

/// y' = (cos(t / s) - y) / s: the solution is a function of t / s. It counts what is asked outside of [0,
/// end].
struct Scaled {
  using State = Eigen::VectorXd;
  double s, end;
  mutable int outside = 0;
  [[nodiscard]] static Eigen::Index dim() { return 1; }
  void rhs(double t, const State& u, State& dudt) const {
    if (t < 0 || t > end) ++outside;
    dudt[0] = (std::cos(t / s) - u[0]) / s;
  }
};

TEST(JacobianSource, DifferencesInTimeKnowTheLengthOfTheStepAndStayInIt) {
  const auto result = [](double s) {
    const int steps = 20;
    const double h = 0.1 * s;
    const Scaled system{s, steps * h};
    Rosenbrock<tableaux::Rodas4, Eigen::VectorXd> stepper;
    Eigen::VectorXd u = Eigen::VectorXd::Ones(1), next = u;
    stepper.init(system, 0, u);
    for (int i = 0; i < steps; ++i) {
      // The last step ends at the end of the span.
      const double t = i * h;
      EXPECT_EQ(stepper.attempt(system, t, u, i + 1 < steps ? h : system.end - t, next), StepStatus::ok);
      stepper.accept(next);
      u = next;
    }
    EXPECT_EQ(system.outside, 0) << s;
    return u[0];
  };
  // y = (cos t + sin t + exp(-t)) / 2
  const double exact = (std::cos(2.0) + std::sin(2.0) + std::exp(-2.0)) / 2;
  for (const double s : {1e12, 1.0, 1e-12}) EXPECT_NEAR(result(s), exact, 1e-6) << s;
}

TEST(JacobianSource, DifferencesInTimeStayInStepsOfAFewRoundings) {
  const double t = 1, h = 4 * std::numeric_limits<double>::epsilon();
  for (const double step : {h, -h}) {
    const double d = detail::time_increment(t, step);
    EXPECT_GT(d / step, 0);
    EXPECT_LE(std::abs(d), h);
  }
  EXPECT_LT(detail::time_increment(1e3, 1e-9), 1.1e-12);
  EXPECT_LT(detail::time_increment(0.0, -1e-12), 0);
}

/// Reaction and diffusion in a row of n cells: y_i' = y_(i-1) - 2 y_i + y_(i+1) - y_i^3.
template <class JacobianT>
struct CellRow {
  using State = Eigen::VectorXd;
  using Jacobian = JacobianT;
  Eigen::Index n;
  [[nodiscard]] Eigen::Index dim() const { return n; }
  void rhs(double, const State& u, State& dudt) const {
    for (Eigen::Index i = 0; i < n; ++i)
      dudt[i] = (i > 0 ? u[i - 1] : 0) - 2 * u[i] + (i + 1 < n ? u[i + 1] : 0) - u[i] * u[i] * u[i];
  }
};
template <class JacobianT>
struct PatternedRow : CellRow<JacobianT> {
  void sparsity(Eigen::SparseMatrix<double>& pattern) const {
    pattern.resize(this->n, this->n);
    for (Eigen::Index j = 0; j < this->n; ++j)
      for (Eigen::Index i = std::max<Eigen::Index>(j - 1, 0); i < std::min(j + 2, this->n); ++i)
        pattern.insert(i, j) = 1;
  }
};
static_assert(PatternedSystem<PatternedRow<Eigen::MatrixXd>> && !PatternedSystem<CellRow<Eigen::MatrixXd>>);

/// Error of the Jacobian by differences of a row of 40 cells, and what it cost.
template <class System>
std::pair<double, std::int64_t> difference_error(const System& row) {
  const Eigen::Index n = row.dim();
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(n, 0.5, 2);
  Eigen::MatrixXd exact = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    exact(i, i) = -2 - 3 * u[i] * u[i];
    if (i > 0) exact(i, i - 1) = exact(i - 1, i) = 1;
  }
  Stats stats;
  const Counted counted(row, stats);
  using Matrix = jacobian_type<System>;
  JacobianSource<Eigen::VectorXd, Matrix> source;
  Matrix J;
  source.init(counted);
  double error = 0;
  for (int repeat = 0; repeat < 2; ++repeat) {
    stats.rhs = 0;
    source.evaluate(counted, 0, u, J);
    if constexpr (detail::is_variant<Matrix>)
      std::visit([&](const auto& held) { error += (Eigen::MatrixXd(held) - exact).cwiseAbs().maxCoeff(); },
                 J);
    else
      error += (Eigen::MatrixXd(J) - exact).cwiseAbs().maxCoeff();
  }
  return {error, stats.rhs};
}

TEST(JacobianSource, TakesTheColumnsOfATridiagonalMatrixInThreeGroups) {
  using Sparse = Eigen::SparseMatrix<double>;
  const auto check = [](const auto& row, std::int64_t cost) {
    const auto [error, rhs] = difference_error(row);
    EXPECT_LT(error, 1e-6);
    EXPECT_EQ(rhs, cost);
  };
  check(PatternedRow<Eigen::MatrixXd>{{40}}, 3 + 1);
  check(PatternedRow<Sparse>{{40}}, 3 + 1);
  check(AnySystem(PatternedRow<Eigen::MatrixXd>{{40}}), 3 + 1);
  check(CellRow<Eigen::MatrixXd>{40}, 40 + 1);
  check(CellRow<Sparse>{40}, 40 + 1);
}

TEST(JacobianSource, OfASystemWithAPatternIsSparseBehindAnyType) {
  const AnySystem row(PatternedRow<Eigen::MatrixXd>{{40}});
  ASSERT_TRUE(has_sparsity(row));
  EXPECT_FALSE(has_sparsity(AnySystem(PlainOscillator{})));
  JacobianSource<AnySystem::State, AnySystem::Jacobian> source;
  AnySystem::Jacobian J;
  source.init(row);
  source.evaluate(row, 0, Eigen::VectorXd::Ones(40), J);
  EXPECT_EQ(std::get<1>(J).nonZeros(), 3 * 40 - 2);
}

TEST(ColumnGroups, PutNoTwoColumnsWithACommonRowTogether) {
  // An arrow: the first column meets every row, all the others only their own and the first.
  Eigen::SparseMatrix<double> arrow(6, 6);
  for (Eigen::Index i = 0; i < 6; ++i) {
    arrow.coeffRef(i, 0) = 1;
    arrow.coeffRef(i, i) = 1;
  }
  const auto groups = ColumnGroups(arrow).members();
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0], (std::vector<Eigen::Index>{0}));
  EXPECT_EQ(groups[1].size(), 5U);
}

TEST(AnySystem, HasTheVerbsOfTheSystemBehindIt) {
  const Oscillator oscillator(parameters);
  const AnySystem any(oscillator);
  EXPECT_TRUE(any.has_jacobian() && any.has_time_derivative() && any.has_split());
  EXPECT_FALSE(any.is_autonomous());
  EXPECT_TRUE(any.has_spectral_radius());
  EXPECT_EQ(any.dofs(), 1);
  Eigen::Vector2d own, stiff, nonstiff;
  Eigen::VectorXd erased(2), part(2);
  oscillator.rhs(0.8, y, own);
  any.rhs(0.8, y, erased);
  EXPECT_EQ(erased, own);
  oscillator.rhs_stiff(0.8, y, stiff);
  oscillator.rhs_nonstiff(0.8, y, nonstiff);
  EXPECT_LT((stiff + nonstiff - own).cwiseAbs().maxCoeff(), 1e-15);
  any.rhs_stiff(0.8, y, part);
  EXPECT_EQ(part, stiff);

  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, y[0]), v = Eigen::VectorXd::Constant(1, y[1]);
  Eigen::VectorXd f(1);
  any.force(0.8, q, v, f);
  EXPECT_NEAR(f[0] / any.mass()[0], own[1], 1e-15);
  Eigen::Matrix2d J;
  oscillator.jacobian(0.8, y, J);
  AnySystem::Jacobian K, C;
  any.stiffness(0.8, q, v, K);
  any.damping(0.8, q, v, C);
  EXPECT_NEAR(std::get<0>(K)(0, 0) / any.mass()[0], -J(1, 0), 1e-15);
  EXPECT_NEAR(std::get<0>(C)(0, 0) / any.mass()[0], -J(1, 1), 1e-15);
}

TEST(AnySystem, ComputesInLongDoubleWhereTheSystemDoes) {
  const BasicAnySystem<long double> any{BasicOscillator<long double>(parameters)};
  const BasicAnySystem<long double> rounded{PlainOscillator{}};
  const Eigen::Vector<long double, Eigen::Dynamic> wide = y.cast<long double>();
  Eigen::Vector<long double, Eigen::Dynamic> a(2), b(2);
  any.rhs(0.8L, wide, a);
  rounded.rhs(0.8L, wide, b);
  EXPECT_NE(a, b);
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-15L);
}

TEST(Counted, CountsEveryVerbThatEvaluates) {
  Stats stats;
  const Counted<Oscillator> counted(Oscillator(parameters), stats);
  Eigen::Vector2d dydt;
  Eigen::Matrix2d J;
  const Oscillator::Dofs q(0.1), v(0.2);
  Oscillator::Dofs f;
  Oscillator::DofMatrix K;
  counted.rhs(0, y, dydt);
  counted.rhs_at(0.3, y, dydt);
  counted.rhs_stiff(0, y, dydt);
  counted.rhs_nonstiff(0, y, dydt);
  counted.force(0, q, v, f);
  EXPECT_EQ(stats.rhs, 5);
  counted.jacobian(0, y, J);
  counted.jacobian_stiff(0, y, J);
  counted.stiffness(0, q, v, K);
  EXPECT_EQ(stats.jacobian, 3);
}

/// A tridiagonal matrix, diagonally dominant.
Eigen::MatrixXd tridiagonal(Eigen::Index n) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    A(i, i) = -2 - 0.1 * static_cast<double>(i);
    if (i > 0) A(i, i - 1) = A(i - 1, i) = 1;
  }
  return A;
}

using Either = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>>;

TEST(LinearSolver, DenseSparseAndEitherSolveTheShiftedEquation) {
  const Eigen::MatrixXd J = tridiagonal(9);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(9, -1, 2);
  const auto residual = [&]<class Matrix>(const Matrix& given) {
    Matrix A;
    set_shifted(given, 0.3, A);
    LinearSolver<Matrix> solver;
    EXPECT_TRUE(solver.factor(A));
    Eigen::VectorXd x = b;
    solver.solve(x);
    return (x - 0.3 * J * x - b).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(residual(J), 1e-14);
  EXPECT_LT(residual(Eigen::SparseMatrix<double>(J.sparseView())), 1e-14);
  EXPECT_LT(residual(Either(J)), 1e-14);
  EXPECT_LT(residual(Either(Eigen::SparseMatrix<double>(J.sparseView()))), 1e-14);
}

TEST(LinearSolver, SolvesDenseEquationsOfEverySize) {
  // Random matrices need exchanges of rows; small and large ones go different ways.
  for (const Eigen::Index n : {1, 2, 3, 4, 7, 16, 17, 40}) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, n);
    const Eigen::VectorXd exact = Eigen::VectorXd::Random(n);
    LinearSolver<Eigen::MatrixXd> solver;
    ASSERT_TRUE(solver.factor(A));
    Eigen::VectorXd x = A * exact;
    solver.solve(x);
    EXPECT_LT((x - exact).cwiseAbs().maxCoeff(), 1e-12 * A.inverse().norm() * A.norm()) << n;
  }
  Eigen::Matrix3d A;
  A << 0, 2, 1, 1, 0, 0, 0, 0, 4;
  Eigen::Vector3d x(7, 1, 8);
  LinearSolver<Eigen::Matrix3d> solver;
  ASSERT_TRUE(solver.factor(A));
  solver.solve(x);
  EXPECT_EQ(x, Eigen::Vector3d(1, 2.5, 2));
}

TEST(LinearSolver, SeesWhatIsNotFiniteWhereverItStands) {
  for (const Eigen::Index n : {2, 3, 5, 20})
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) {
          Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
          A(i, j) = bad;
          EXPECT_FALSE(LinearSolver<Eigen::MatrixXd>().factor(A)) << n << ' ' << i << ' ' << j;
        }
}

TEST(LinearSolver, TakesComplexShiftsOfRealMatrices) {
  using Complex = std::complex<double>;
  const Eigen::MatrixXd J = tridiagonal(5);
  const Complex s(0.2, 0.7);
  for (const Either& given : {Either(J), Either(Eigen::SparseMatrix<double>(J.sparseView()))}) {
    with_scalar<Either, Complex> A;
    set_shifted(given, s, A);
    LinearSolver<with_scalar<Either, Complex>> solver;
    ASSERT_TRUE(solver.factor(A));
    const Eigen::VectorXcd b = Eigen::VectorXcd::Constant(5, Complex(1, -2));
    Eigen::VectorXcd x = b;
    solver.solve(x);
    EXPECT_LT((x - s * (J * x) - b).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(LinearSolver, SaysThatAMatrixIsSingularOrNotFinite) {
  Eigen::MatrixXd A(2, 2);
  A << 1, 2, 2, 4;
  EXPECT_FALSE(LinearSolver<Eigen::MatrixXd>().factor(A));
  EXPECT_FALSE(LinearSolver<Eigen::SparseMatrix<double>>().factor(A.sparseView()));
  A(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(LinearSolver<Eigen::MatrixXd>().factor(A));
  EXPECT_FALSE(LinearSolver<Eigen::SparseMatrix<double>>().factor(A.sparseView()));
  EXPECT_FALSE(LinearSolver<Either>().factor(A));
}

TEST(LinearSolver, CombinesMassDampingAndStiffness) {
  const Eigen::MatrixXd C = tridiagonal(4), K = 3 * tridiagonal(4);
  const Eigen::VectorXd m = Eigen::VectorXd::LinSpaced(4, 1, 2);
  const Eigen::MatrixXd expected = Eigen::MatrixXd(m.asDiagonal()) + 0.5 * C + 0.25 * K;
  Eigen::MatrixXd dense;
  set_combination(m, 0.5, C, 0.25, K, dense);
  EXPECT_LT((dense - expected).cwiseAbs().maxCoeff(), 1e-15);
  Either either;
  set_combination(m, 0.5, Either(Eigen::SparseMatrix<double>(C.sparseView())), 0.25,
                  Either(Eigen::SparseMatrix<double>(K.sparseView())), either);
  EXPECT_LT((Eigen::MatrixXd(std::get<1>(either)) - expected).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace hmax
