/// The verbs of every problem of the test set agree with one another.
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>

#include "integrators/system.hpp"
#include "tests/problems/test_set.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using test_set::dense;
using test_set::lively;
using test_set::states_of;
using Quad = long double;

template <class Problem>
class TestSet : public testing::Test {};
TYPED_TEST_SUITE(TestSet, test_set::All<Quad>);

/// Column j of the derivative of `call` at x by central differences.
template <class Vector, class Call>
Vector central_quotient(const Call& call, const Vector& x, Eigen::Index j) {
  const Quad d = 1e-6L * (1 + std::abs(x[j])) * 0.01L;
  Vector plus = x, minus = x, at_plus = x, at_minus = x;
  plus[j] += d;
  minus[j] -= d;
  call(plus, at_plus);
  call(minus, at_minus);
  return (at_plus - at_minus) / (plus[j] - minus[j]);
}

/// Every column of A agrees with central differences of `call` at x, relative to the largest entry of A.
template <class Matrix, class Vector, class Call>
void expect_derivative(const Matrix& A, const Call& call, const Vector& x) {
  const auto full = dense(A);
  ASSERT_EQ(full.rows(), x.size());
  ASSERT_EQ(full.cols(), x.size());
  for (Eigen::Index j = 0; j < x.size(); ++j)
    EXPECT_LT((central_quotient(call, x, j) - full.col(j)).norm(), 1e-9L * (1 + full.norm()))
        << "column " << j;
}

TYPED_TEST(TestSet, SatisfiesTheConceptsOfItsVerbs) {
  static_assert(DifferentiableSystem<TypeParam>);
  static_assert(TypeParam::autonomous != TimeDifferentiableSystem<TypeParam>);
  static_assert(SecondOrderSystem<TypeParam> == requires { typename TypeParam::Dofs; });
  static_assert(SplitSystem<TypeParam> ==
                requires(const TypeParam& s, typename TypeParam::State& y) { s.rhs_nonstiff(Quad{}, y, y); });
  const TypeParam problem = lively<TypeParam>();
  EXPECT_EQ(problem.y0().size(), problem.dim());
  EXPECT_EQ(static_cast<Eigen::Index>(problem.states().size()), problem.dim());
  EXPECT_GT(TypeParam::t_end, 0);
  EXPECT_FALSE(TypeParam::note.empty());
}

TYPED_TEST(TestSet, JacobianAgreesWithCentralDifferences) {
  const TypeParam problem = lively<TypeParam>();
  for (const auto& y : states_of(problem, 20)) {
    typename TypeParam::Jacobian J;
    problem.jacobian(0.3L, y, J);
    expect_derivative(
        J, [&](const auto& at, auto& out) { problem.rhs(0.3L, at, out); }, y);
  }
}

TYPED_TEST(TestSet, TimeDerivativeAgreesWithCentralDifferencesAndIsZeroWhenAutonomous) {
  const TypeParam problem = lively<TypeParam>();
  typename TypeParam::State plus = problem.y0(), minus = plus, dfdt = plus;
  for (const auto& y : states_of(problem, 5)) {
    const Quad t = 0.3L, d = 1e-6L;
    problem.rhs(t + d, y, plus);
    problem.rhs(t - d, y, minus);
    if constexpr (TypeParam::autonomous) {
      EXPECT_EQ(plus, minus);
    } else {
      problem.time_derivative(t, y, dfdt);
      EXPECT_LT(((plus - minus) / (2 * d) - dfdt).norm(), 1e-9L * dfdt.norm());
    }
  }
}

TYPED_TEST(TestSet, PackedRhsIsVelocityAndForceOverMass) {
  if constexpr (SecondOrderSystem<TypeParam>) {
    const TypeParam problem = lively<TypeParam>();
    const Eigen::Index n = problem.dofs();
    ASSERT_EQ(problem.dim(), 2 * n);
    for (const auto& y : states_of(problem, 10)) {
      const typename TypeParam::Dofs q = y.head(n), v = y.tail(n);
      typename TypeParam::Dofs f = q;
      typename TypeParam::State dydt = y;
      problem.rhs(0.3L, y, dydt);
      problem.force(0.3L, q, v, f);
      EXPECT_EQ(dydt.head(n), v);
      EXPECT_LT((dydt.tail(n).cwiseProduct(problem.mass()) - f).norm(), 1e-17L * (1 + f.norm()));
    }
  }
}

TYPED_TEST(TestSet, StiffnessAndDampingAreMinusTheDerivativesOfTheForce) {
  if constexpr (SecondOrderSystem<TypeParam>) {
    const TypeParam problem = lively<TypeParam>();
    const Eigen::Index n = problem.dofs();
    for (const auto& y : states_of(problem, 10)) {
      const typename TypeParam::Dofs q = y.head(n), v = y.tail(n);
      typename TypeParam::DofMatrix K, C;
      problem.stiffness(0.3L, q, v, K);
      problem.damping(0.3L, q, v, C);
      using Dofs = typename TypeParam::Dofs;
      auto minus_force = [&](const Dofs& at_q, const Dofs& at_v, Dofs& out) {
        problem.force(0.3L, at_q, at_v, out);
        out = -out;
      };
      expect_derivative(
          K, [&](const Dofs& at, Dofs& out) { minus_force(at, v, out); }, q);
      expect_derivative(
          C, [&](const Dofs& at, Dofs& out) { minus_force(q, at, out); }, v);
    }
  }
}

TYPED_TEST(TestSet, StiffAndNonstiffPartsSumUp) {
  if constexpr (SplitSystem<TypeParam>) {
    const TypeParam problem = lively<TypeParam>();
    for (const auto& y : states_of(problem, 10)) {
      typename TypeParam::State stiff = y, nonstiff = y, whole = y;
      problem.rhs_stiff(0.3L, y, stiff);
      problem.rhs_nonstiff(0.3L, y, nonstiff);
      problem.rhs(0.3L, y, whole);
      EXPECT_LT((stiff + nonstiff - whole).norm(), 1e-17L * (1 + stiff.norm() + nonstiff.norm()));
      EXPECT_GT(nonstiff.norm(), 0);
      typename TypeParam::Jacobian J;
      problem.jacobian_stiff(0.3L, y, J);
      expect_derivative(
          J, [&](const auto& at, auto& out) { problem.rhs_stiff(0.3L, at, out); }, y);
    }
  }
}

TYPED_TEST(TestSet, AStiffPartThatIsCalledLinearIsLinear) {
  if constexpr (SplitSystem<TypeParam>) {
    const TypeParam problem = lively<TypeParam>();
    ASSERT_TRUE(has_linear_stiff_part(problem));
    const auto states = states_of(problem, 2);
    typename TypeParam::State one = states[0], other = one;
    typename TypeParam::Jacobian J;
    problem.rhs_stiff(0.3L, states[0], one);
    problem.rhs_stiff(0.3L, states[1], other);
    problem.jacobian_stiff(0.7L, states[0], J);
    EXPECT_LT((J * (states[1] - states[0]) - (other - one)).norm(), 1e-16L * (one.norm() + other.norm()));
  }
}

TYPED_TEST(TestSet, SparseJacobiansKeepTheirPatternAndTheirMemory) {
  using Jacobian = typename TypeParam::Jacobian;
  if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<Jacobian>, Jacobian>) {
    const TypeParam problem = lively<TypeParam>();
    const auto states = states_of(problem, 2);
    Jacobian J, fresh;
    problem.jacobian(0, states[0], J);
    const auto* values = J.valuePtr();
    problem.jacobian(0, states[1], J);
    EXPECT_EQ(J.valuePtr(), values);
    problem.jacobian(0, states[1], fresh);
    EXPECT_EQ(dense(J), dense(fresh));
    // The stiff part has the same pattern, so one analysis serves both.
    const auto entries = J.nonZeros();
    problem.jacobian_stiff(0, states[1], J);
    EXPECT_EQ(J.nonZeros(), entries);
    EXPECT_EQ(J.valuePtr(), values);
    EXPECT_TRUE(J.isCompressed());
  }
}

TYPED_TEST(TestSet, StartsFromDoublesInEveryPrecision) {
  const TypeParam problem = lively<TypeParam>();
  const auto y = problem.y0();
  EXPECT_EQ(y.template cast<double>().template cast<Quad>(), y);
}

TYPED_TEST(TestSet, RefusesParametersThatAreNotFinite) {
  for (const auto& [name, member] : TypeParam::Parameters::names)
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      typename TypeParam::Parameters p;
      p.*member = bad;
      const std::string message = error_of<std::invalid_argument>([&] { TypeParam{p}; });
      EXPECT_TRUE(says(message, name)) << bad;
      EXPECT_TRUE(says(message, TypeParam::id));
    }
}

template <template <class> class Problem>
void expect_same_in_double() {
  const Problem<double> narrow;
  const Problem<Quad> wide;
  typename Problem<double>::State y = narrow.y0(), dydt = y;
  typename Problem<Quad>::State y_wide = wide.y0(), dydt_wide = y_wide;
  EXPECT_EQ(y.template cast<Quad>(), y_wide);
  narrow.rhs(0.25, y, dydt);
  wide.rhs(0.25L, y_wide, dydt_wide);
  typename Problem<double>::Jacobian J;
  narrow.jacobian(0.25, y, J);
  EXPECT_LT((dydt_wide.template cast<double>() - dydt).norm(), 1e-14 * (dense(J).norm() * y.norm()));
}

TEST(TestSetInDouble, ComputesTheSameAsInLongDouble) {
  expect_same_in_double<Dahlquist>();
  expect_same_in_double<VanDerPol>();
  expect_same_in_double<Robertson>();
  expect_same_in_double<Hires>();
  expect_same_in_double<Pleiades>();
  expect_same_in_double<Oregonator>();
  expect_same_in_double<Kepler>();
  expect_same_in_double<Arenstorf>();
  expect_same_in_double<Lorenz>();
  expect_same_in_double<Brusselator>();
  expect_same_in_double<ProtheroRobinson>();
  expect_same_in_double<SpringChain>();
}

TEST(TestSetParameters, OutsideTheirRangeAreRefused) {
  EXPECT_THROW(Kepler<double>({.e = 1}), std::invalid_argument);
  EXPECT_THROW(Kepler<double>({.e = -0.1}), std::invalid_argument);
  EXPECT_THROW(Arenstorf<double>({.mu = 0}), std::invalid_argument);
  EXPECT_THROW(Oregonator<double>({.s = 0}), std::invalid_argument);
  EXPECT_THROW(Brusselator<double>({.n = 2.5}), std::invalid_argument);
  EXPECT_THROW(Brusselator<double>({.n = 0}), std::invalid_argument);
  EXPECT_THROW(Brusselator<double>({.alpha = -1}), std::invalid_argument);
  EXPECT_THROW(SpringChain<double>({.n = 1e9}), std::invalid_argument);
  EXPECT_THROW(SpringChain<double>({.m = 0}), std::invalid_argument);
  EXPECT_THROW(SpringChain<double>({.k = -1}), std::invalid_argument);
  EXPECT_THROW(SpringChain<double>({.c = -1}), std::invalid_argument);
}

TEST(TestSetSizes, AreOneTwoAndManyForChainsAndGrids) {
  for (const double n : {1.0, 2.0, 7.0}) {
    const Brusselator<double> grid({.n = n});
    EXPECT_EQ(grid.dim(), 2 * n);
    Brusselator<double>::Jacobian J;
    grid.jacobian(0, grid.y0(), J);
    EXPECT_EQ(J.nonZeros(), 4 * n + 4 * (n - 1));
    const SpringChain<double> chain({.n = n});
    SpringChain<double>::DofMatrix K;
    chain.stiffness(0, chain.y0().head(chain.dofs()), chain.y0().tail(chain.dofs()), K);
    EXPECT_EQ(K.nonZeros(), 3 * n - 2);
  }
}

}  // namespace
}  // namespace hmax
