/// Sparse L D L^T gives what dense elimination gives.
#include "integrators/linear/panel_factor.hpp"

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/core/jobs.hpp"

namespace hmax {
namespace {

using Eigen::Index;

/// A symmetric matrix with every couple of a pattern coupled, of any signs, made well conditioned by its
/// diagonal, which has both signs too.
template <class Scalar>
Eigen::SparseMatrix<Scalar> symmetric(Index n, const std::vector<std::pair<Index, Index>>& couples,
                                      unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto number = [&] {
    if constexpr (Eigen::NumTraits<Scalar>::IsComplex)
      return Scalar(any(random), any(random));
    else
      return static_cast<Scalar>(any(random));
  };
  using Real = typename Eigen::NumTraits<Scalar>::Real;
  std::vector<Eigen::Triplet<Scalar>> entries;
  std::vector<Real> sums(static_cast<std::size_t>(n), Real(1));
  for (const auto& [i, j] : couples) {
    const Scalar value = number();
    entries.emplace_back(i, j, value);
    entries.emplace_back(j, i, value);
    sums[static_cast<std::size_t>(i)] += std::abs(value);
    sums[static_cast<std::size_t>(j)] += std::abs(value);
  }
  for (Index i = 0; i < n; ++i)
    entries.emplace_back(
        i, i,
        Scalar(any(random) < 0 ? -sums[static_cast<std::size_t>(i)] : sums[static_cast<std::size_t>(i)]));
  Eigen::SparseMatrix<Scalar> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

using Couples = std::vector<std::pair<Index, Index>>;

Couples dense(Index n) {
  Couples couples;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j) couples.emplace_back(i, j);
  return couples;
}

Couples scattered(Index n, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<Index> any(0, n - 1);
  Couples couples;
  for (int k = 0; k < count; ++k)
    if (const Index i = any(random), j = any(random); i != j) couples.emplace_back(i, j);
  return couples;
}

/// A grid of points in space, each with `size` unknowns, coupled with the neighbours along the axes.
Couples grid(Index side, Index size) {
  Couples couples;
  const auto couple = [&](Index a, Index b) {
    for (Index r = 0; r < size; ++r)
      for (Index c = 0; c < size; ++c)
        if (a != b || r < c) couples.emplace_back(size * a + r, size * b + c);
  };
  for (Index z = 0; z < side; ++z)
    for (Index y = 0; y < side; ++y)
      for (Index x = 0; x < side; ++x) {
        const Index a = (z * side + y) * side + x;
        couple(a, a);
        if (x + 1 < side) couple(a, a + 1);
        if (y + 1 < side) couple(a, a + side);
        if (z + 1 < side) couple(a, a + side * side);
      }
  return couples;
}

template <class Scalar>
void expect_what_dense_elimination_gives(const Eigen::SparseMatrix<Scalar>& A, PanelFactor<Scalar>& factor) {
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;
  using Real = typename Eigen::NumTraits<Scalar>::Real;
  const Vector b = Vector::Random(A.rows());
  const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> full = A;
  const Vector expected = full.partialPivLu().solve(b);
  ASSERT_TRUE(factor.factor(A));
  Vector x = b;
  factor.solve(x);
  EXPECT_LT((x - expected).norm(), 1000 * std::numeric_limits<Real>::epsilon() * expected.norm());
}

template <class Scalar>
class PanelFactorOf : public testing::Test {};
using Scalars = testing::Types<float, double, long double, std::complex<double>>;
TYPED_TEST_SUITE(PanelFactorOf, Scalars);

TYPED_TEST(PanelFactorOf, SolvesWithEveryPattern) {
  const auto check = [](Index n, const Couples& couples) {
    PanelFactor<TypeParam> factor;
    auto A = symmetric<TypeParam>(n, couples, 1);
    factor.analyse(A);
    expect_what_dense_elimination_gives(A, factor);
    // Another matrix of the pattern, after that one.
    A = symmetric<TypeParam>(n, couples, 2);
    expect_what_dense_elimination_gives(A, factor);
  };
  for (Index n = 1; n <= 40; ++n) check(n, dense(n));
  // More columns and rows than stay in the caches at once.
  check(300, dense(300));
  check(9, {});
  check(30, {{0, 29}});
  for (const int count : {20, 60, 150, 600}) check(100, scattered(100, count, 3));
  for (const Index size : {1, 2, 3, 5}) check(64 * size, grid(4, size));
  Couples arrow;
  for (Index i = 1; i < 50; ++i) arrow.emplace_back(0, i);
  check(50, arrow);
}

TEST(PanelFactor, HasTheSameBitsWithEveryInstructionSet) {
  for (const auto& couples : {dense(289), grid(5, 3)}) {
    const auto A = symmetric<double>(375, couples, 5);
    std::vector<Eigen::VectorXd> solutions;
    for (const auto* kernels : available_panel_kernels()) {
      PanelFactor<double> factor(*kernels);
      factor.analyse(A);
      ASSERT_TRUE(factor.factor(A));
      solutions.emplace_back(Eigen::VectorXd::LinSpaced(A.rows(), -1, 2));
      factor.solve(solutions.back());
      EXPECT_EQ(solutions.back(), solutions.front()) << kernels->name;
    }
  }
}

TEST(PanelFactor, HasTheSameBitsForAnyNumberOfThreads) {
  // One panel, which is large enough to be shared in both directions.
  const auto A = symmetric<double>(600, dense(600), 9);
  PanelFactor<double> factor;
  factor.analyse(A);
  ASSERT_GT(factor.work(), 2e7);
  std::vector<Eigen::VectorXd> solutions;
  for (const std::size_t threads : {1, 2, 5}) {
    const Jobs jobs(threads);
    ASSERT_TRUE(factor.factor(A));
    solutions.emplace_back(Eigen::VectorXd::LinSpaced(A.rows(), -1, 2));
    factor.solve(solutions.back());
    EXPECT_EQ(solutions.back(), solutions.front()) << threads << " threads";
  }
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(A.rows(), -1, 2);
  EXPECT_LT((A * solutions.front() - b).norm(), 1e-12 * b.norm());
}

TEST(PanelFactor, SharesWhatAPanelSubtractsFromOthersAmongThreads) {
  // Two panels of 150 columns, each coupled with the last 300 unknowns and not with the other.
  constexpr Index arm = 150, n = 600;
  Couples couples;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j)
      if (i >= 2 * arm || i / arm == j / arm) couples.emplace_back(i, j);
  const auto A = symmetric<double>(n, couples, 10);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1, 2);
  std::vector<Eigen::VectorXd> solutions;
  for (const std::size_t threads : {5, 2, 1}) {
    const Jobs jobs(threads);
    PanelFactor<double> factor;  // a new one: what threads leave out is not there from before
    factor.analyse(A);
    ASSERT_TRUE(factor.factor(A));
    solutions.push_back(b);
    factor.solve(solutions.back());
    EXPECT_EQ(solutions.back(), solutions.front()) << threads << " threads";
    EXPECT_LT((A * solutions.back() - b).norm(), 1e-12 * b.norm()) << threads << " threads";
  }
}

TEST(PanelFactor, RefusesAPivotThatIsZeroOrNotFinite) {
  auto A = symmetric<double>(30, grid(3, 1), 6);
  PanelFactor<double> factor;
  factor.analyse(A);
  for (const double bad : {0.0, double(NAN), double(INFINITY)}) {
    auto wrong = A;
    for (Index k = 0; k < wrong.nonZeros(); ++k) wrong.valuePtr()[k] *= bad;
    EXPECT_FALSE(factor.factor(wrong));
  }
  expect_what_dense_elimination_gives(A, factor);
}

TEST(PanelFactor, CountsTheOperationsOfADenseMatrix) {
  PanelFactor<double> factor;
  const auto A = symmetric<double>(20, dense(20), 7);
  factor.analyse(A);
  EXPECT_EQ(factor.work(), 20 * 21 * 41 / 6.0);
}

TEST(PanelAnalysis, AddsFewZeros) {
  // A chain has no fill: two numbers a column, and a few of the panels that were merged.
  Couples chain;
  for (Index i = 1; i < 200; ++i) chain.emplace_back(i - 1, i);
  const auto A = symmetric<double>(200, chain, 8);
  PanelFactor<double> factor;
  factor.analyse(A);
  EXPECT_LT(factor.work(), 3 * 200 * 4);
}

}  // namespace
}  // namespace hmax
