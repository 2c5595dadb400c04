/// Sparse equations of mechanical systems. tests/catalogue/methods/packed_states_test.cpp steps with them.
#include "integrators/mechanical.hpp"

#include <complex>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/linear/sparse_solver.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// A grid of masses in space whose springs have blocks of 3 x 3, and a random symmetric positive definite
/// matrix of its pattern.
Sparse blocks_in_space(int side, double shift, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> direction(-1, 1);
  const int n = side * side * side;
  std::vector<Eigen::Triplet<double>> entries;
  const auto spring = [&](int a, int b) {
    const Eigen::Vector3d d = Eigen::Vector3d(direction(random), direction(random), direction(random));
    const Eigen::Matrix3d k = d * d.transpose() + 0.1 * Eigen::Matrix3d::Identity();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        entries.emplace_back(3 * a + r, 3 * a + c, k(r, c));
        entries.emplace_back(3 * b + r, 3 * b + c, k(r, c));
        entries.emplace_back(3 * a + r, 3 * b + c, -k(r, c));
        entries.emplace_back(3 * b + r, 3 * a + c, -k(r, c));
      }
  };
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const int a = (z * side + y) * side + x;
        if (x + 1 < side) spring(a, a + 1);
        if (y + 1 < side) spring(a, a + side);
        if (z + 1 < side) spring(a, a + side * side);
        if (x + 1 < side && z + 1 < side) spring(a, a + 1 + side * side);
      }
  for (int i = 0; i < 3 * n; ++i) entries.emplace_back(i, i, shift);
  Sparse A(3 * n, 3 * n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

TEST(SparseCombination, AddsACoupledMassInPlaceWhereItsEntriesAre) {
  // M has every second entry of the pattern of K and C; then one that is outside of it.
  const Sparse K = blocks_in_space(3, 0.05, 4), C = 0.25 * K;
  Sparse M = 0.5 * K;
  M.prune([](Index i, Index j, double) { return i == j || (i + j) % 2 == 1; });
  Sparse A = K;
  const double* const place = A.valuePtr();
  set_sparse_combination<double, double>(M, 2.0, C, 3.0, K, A);
  EXPECT_EQ(A.valuePtr(), place);
  EXPECT_LT((A - (Sparse(M + 2 * C) + 3 * K)).norm(), 1e-14 * A.norm());
  ASSERT_EQ(K.coeff(0, K.rows() - 1), 0);
  M.coeffRef(0, K.rows() - 1) = 7;
  set_sparse_combination<double, double>(M, 2.0, C, 3.0, K, A);
  EXPECT_EQ(A.coeff(0, K.rows() - 1), 7);
  EXPECT_LT((A - (Sparse(M + 2 * C) + 3 * K)).norm(), 1e-14 * A.norm());
}

TEST(SparseSolver, SolvesSymmetricEquationsByEveryWay) {
  const Sparse A = blocks_in_space(6, 0.05, 1);
  const VectorXd x = VectorXd::LinSpaced(A.rows(), -1, 2), b = A * x;
  for (const auto by :
       {LinearSolve::By::direct, LinearSolve::By::conjugate_gradients, LinearSolve::By::automatic}) {
    SparseSolver<double> solver;
    solver.set({.by = by});
    ASSERT_TRUE(solver.factor(A));
    for (int repetition = 0; repetition < 60; ++repetition) {
      VectorXd found = b;
      solver.solve(found);
      EXPECT_LT((found - x).norm(), 1e-7 * x.norm());
    }
  }
}

template <class Scalar>
void expect_rounding_of_long_double(const Eigen::SparseMatrix<Scalar>& A) {
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;
  const Vector x = Vector::LinSpaced(A.rows(), Scalar(-1.0L), Scalar(2.0L)) / Scalar(3.0L);
  SparseSolver<Scalar> solver;
  ASSERT_TRUE(solver.factor(A));
  Vector found = A * x;
  solver.solve(found);
  EXPECT_LT((found - x).norm(), 1e-17L * x.norm());
}

TEST(SparseSolver, SolvesToTheRoundingOfLongDouble) {
  const Sparse A = blocks_in_space(4, 0.5, 1);
  const Eigen::SparseMatrix<long double> symmetric = A.cast<long double>() / 3.0L;
  expect_rounding_of_long_double(symmetric);
  Eigen::SparseMatrix<long double> general = symmetric;
  general.coeffRef(0, 7) += 1 / 7.0L;
  expect_rounding_of_long_double(general);
  using Wide = std::complex<long double>;
  Eigen::SparseMatrix<Wide> turned = general.cast<Wide>();
  turned *= Wide(0.6L, 0.8L);
  for (Index i = 0; i < turned.rows(); ++i) turned.coeffRef(i, i) += Wide(0.1L, -0.3L);
  expect_rounding_of_long_double(turned);
  // Singular.
  EXPECT_FALSE(SparseSolver<long double>().factor(Eigen::SparseMatrix<long double>(3, 3)));
}

TEST(SparseSolver, SolvesWhatIsIndefiniteOrNotSymmetric) {
  Sparse indefinite = blocks_in_space(5, 0.05, 2);
  for (int i = 0; i < 40; ++i) indefinite.coeffRef(3 * i, 3 * i) -= 8;
  Sparse lopsided = blocks_in_space(5, 0.05, 3);
  for (int i = 0; i + 3 < lopsided.rows(); i += 2) lopsided.coeffRef(i, i + 3) += 0.3;
  lopsided.makeCompressed();
  for (const Sparse& A : {indefinite, lopsided}) {
    const VectorXd x = VectorXd::LinSpaced(A.rows(), -1, 2);
    SparseSolver<double> solver;
    ASSERT_TRUE(solver.factor(A));
    VectorXd found = A * x;
    solver.solve(found);
    EXPECT_LT((found - x).norm(), 1e-9 * x.norm());
  }
}

TEST(SparseSolver, SeesThatPivotsAreTooSmall) {
  // Without pivoting each pair loses all that it is.
  Sparse pairs(200, 200);
  for (int i = 0; i < 200; i += 2) {
    pairs.insert(i, i) = pairs.insert(i + 1, i + 1) = 1e-17;
    pairs.insert(i, i + 1) = pairs.insert(i + 1, i) = 1;
    if (i > 0) pairs.insert(i, i - 2) = pairs.insert(i - 2, i) = 0.1;
  }
  pairs.makeCompressed();
  const VectorXd x = VectorXd::LinSpaced(pairs.rows(), -1, 2);
  for (const auto by : {LinearSolve::By::direct, LinearSolve::By::automatic}) {
    SparseSolver<double> solver;
    solver.set({.by = by});
    ASSERT_TRUE(solver.factor(pairs));
    VectorXd found = pairs * x;
    solver.solve(found);
    EXPECT_LT((found - x).norm(), 1e-10 * x.norm());
    EXPECT_FALSE(solver.is_symmetric());
  }
}

TEST(SparseSolver, TakesComplexMatricesThatAreSymmetricAsSuch) {
  using Complex = std::complex<double>;
  Eigen::SparseMatrix<Complex> A = blocks_in_space(5, 0.05, 3).cast<Complex>() * std::polar(1.0, -1.7);
  for (int i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += 1;
  for (const bool symmetric : {true, false}) {
    if (!symmetric) A.coeffRef(0, 3) += Complex(0, 0.1);
    const Eigen::VectorXcd x = Eigen::VectorXcd::Random(A.rows());
    SparseSolver<Complex> solver;
    ASSERT_TRUE(solver.factor(A));
    EXPECT_EQ(solver.is_symmetric(), symmetric);
    Eigen::VectorXcd found = A * x;
    solver.solve(found);
    EXPECT_LT((found - x).norm(), 1e-12 * x.norm());
  }
}

TEST(SparseSolver, StopsWhereItIsToldTo) {
  const Sparse A = blocks_in_space(6, 1e-4, 4);
  const VectorXd x = VectorXd::LinSpaced(A.rows(), -1, 2), b = A * x;
  const auto residual_after = [&](LinearSolve how) {
    SparseSolver<double> solver;
    solver.set(how);
    EXPECT_TRUE(solver.factor(A));
    VectorXd found = b;
    const int iterations = solver.solve(found);
    EXPECT_GT(iterations, 0);
    if (how.iterations > 0) {
      EXPECT_EQ(iterations, how.iterations);
    }
    return (b - A * found).norm() / b.norm();
  };
  using By = LinearSolve::By;
  const double one = residual_after({.by = By::conjugate_gradients, .tolerance = 1e-12, .iterations = 1});
  const double five = residual_after({.by = By::conjugate_gradients, .tolerance = 1e-12, .iterations = 5});
  EXPECT_GT(one, five);
  EXPECT_GT(five, 1e-9);
  const double loose = residual_after({.by = By::conjugate_gradients, .tolerance = 1e-3});
  EXPECT_LT(loose, 2e-3);
  EXPECT_GT(loose, 1e-8);
  SparseSolver<double> direct;
  direct.set({.by = By::direct});
  ASSERT_TRUE(direct.factor(A));
  VectorXd found = b;
  EXPECT_EQ(direct.solve(found), 0);
}

TEST(SparseSolver, RefusesWhatHasNoSolution) {
  SparseSolver<double> solver;
  Sparse zero(6, 6);
  EXPECT_FALSE(solver.factor(zero));
  Sparse not_a_number = blocks_in_space(2, 1, 5);
  not_a_number.valuePtr()[3] = NAN;
  EXPECT_FALSE(solver.factor(not_a_number));
}

TEST(SparseSolver, FollowsAPatternThatChanges) {
  SparseSolver<double> solver;
  for (const int side : {3, 6, 4}) {
    const Sparse A = blocks_in_space(side, 0.1, 6);
    const VectorXd x = VectorXd::LinSpaced(A.rows(), -1, 2);
    ASSERT_TRUE(solver.factor(A));
    VectorXd found = A * x;
    solver.solve(found);
    EXPECT_LT((found - x).norm(), 1e-7 * x.norm());
  }
}

}  // namespace
}  // namespace hmax
