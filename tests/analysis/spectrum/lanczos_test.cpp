#include "analysis/spectrum/lanczos.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <gtest/gtest.h>

#include "analysis/spectrum/block_product.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/tissue/body.hpp"
#include "tests/core/jobs.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A symmetric matrix with these eigenvalues and no pattern.
MatrixXd with_eigenvalues(const VectorXd& values) {
  std::srand(3);
  const MatrixXd random = MatrixXd::Random(values.size(), values.size());
  const MatrixXd Q =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(MatrixXd(random + random.transpose())).eigenvectors();
  return Q * values.asDiagonal() * Q.transpose();
}
SymmetricOperator symmetric_product_with(const MatrixXd& A) {
  return [&A](const VectorXd& x, VectorXd& y) { y = A * x; };
}

TEST(Lanczos, FindsTheLargestEigenvalueWithinTheResidualItStates) {
  VectorXd values = VectorXd::LinSpaced(300, -5, 90);
  values[299] = 100;
  const MatrixXd A = with_eigenvalues(values);
  Index before = 0;
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    const LanczosPair pair = largest_eigenpair(symmetric_product_with(A), 300, {.tolerance = tolerance});
    ASSERT_TRUE(pair.converged) << tolerance;
    EXPECT_LE(pair.residual, 2 * tolerance * 100);
    EXPECT_LE(std::abs(pair.value - 100), pair.residual + 1e-12);
    EXPECT_NEAR((A * pair.vector - pair.value * pair.vector).norm(), pair.residual, 1e-12);
    EXPECT_NEAR(pair.vector.norm(), 1, 1e-14);
    EXPECT_GT(pair.products, before);
    EXPECT_LT(pair.products, 120);
    before = pair.products;
    // Without the vector the recurrence alone says the same.
    const LanczosPair value =
        largest_eigenpair(symmetric_product_with(A), 300, {.tolerance = tolerance, .with_vector = false});
    EXPECT_EQ(value.vector.size(), 0);
    EXPECT_EQ(value.products + 1, pair.products);
    EXPECT_NEAR(value.value, 100, value.residual + 1e-12);
    EXPECT_LE(pair.residual, 1.01 * value.residual + 1e-12);
  }
}

TEST(Lanczos, OneThatDoesNotConvergeSaysSo) {
  const MatrixXd A = with_eigenvalues(VectorXd::LinSpaced(400, 99.99, 100));
  EXPECT_FALSE(
      largest_eigenpair(symmetric_product_with(A), 400, {.tolerance = 1e-12, .most_products = 20}).converged);
  EXPECT_FALSE(first_eigenpairs(symmetric_product_with(A), 400, 3, Rank::largest, 1e-13, 20).converged);
}

TEST(Lanczos, TinyAndTrivialOperatorsAreServed) {
  for (const Index n : {1, 2, 5}) {
    const MatrixXd A = 3 * MatrixXd::Identity(n, n);
    const LanczosPair pair = largest_eigenpair(symmetric_product_with(A), n);
    EXPECT_TRUE(pair.converged);
    EXPECT_NEAR(pair.value, 3, 1e-14);
    const LanczosPairs all = first_eigenpairs(symmetric_product_with(A), n, n, Rank::largest);
    ASSERT_TRUE(all.converged) << n;
    EXPECT_LT((all.vectors.transpose() * all.vectors - MatrixXd::Identity(n, n)).norm(), 1e-13);
  }
}

TEST(Lanczos, EigenvaluesComeWithTheirMultiplicities) {
  VectorXd values = VectorXd::LinSpaced(200, 0, 50);
  values.tail(6) << 70, 70, 70, 80, 95, 95;
  values[0] = -99;
  const MatrixXd A = with_eigenvalues(values);
  const LanczosPairs largest = first_eigenpairs(symmetric_product_with(A), 200, 5, Rank::largest);
  ASSERT_TRUE(largest.converged);
  const VectorXd wanted{{95, 95, 80, 70, 70}};
  for (Index i = 0; i < 5; ++i) EXPECT_NEAR(largest.values[static_cast<std::size_t>(i)], wanted[i], 1e-9);
  EXPECT_LT((largest.vectors.transpose() * largest.vectors - MatrixXd::Identity(5, 5)).norm(), 1e-9);
  EXPECT_LT((A * largest.vectors - largest.vectors * wanted.asDiagonal()).norm(), 1e-7);
  EXPECT_NEAR(first_eigenpairs(symmetric_product_with(A), 200, 2, Rank::largest_modulus).values[0], -99,
              1e-9);
}

TEST(Lanczos, ProductsByBlocksAreThoseOfTheMatrix) {
  const TissueBody body(ball_mesh(0.1, 2), {.supports = {{.points = {0, 5}}}});
  TissueBody::DofMatrix K;
  const VectorXd zero = VectorXd::Zero(body.dofs());
  body.stiffness(0, zero, zero, K);
  const VectorXd scale = body.mass().cwiseSqrt().cwiseInverse();
  const SymmetricProduct blocks(K, scale);
  EXPECT_TRUE(blocks.has_blocks());
  // The same numbers with one zero less are no whole blocks.
  Eigen::SparseMatrix<double> ragged = K;
  ragged.prune([](Index row, Index column, double) { return row + column != 1; });
  EXPECT_FALSE(SymmetricProduct(ragged, scale).has_blocks());
  const VectorXd x = start_vector(body.dofs());
  VectorXd y(x.size()), z(x.size());
  blocks(x, y);
  const VectorXd expected = scale.cwiseProduct(K * scale.cwiseProduct(x));
  EXPECT_LT((y - expected).norm(), 1e-13 * expected.norm());
  SymmetricProduct(ragged, scale)(x, z);
  const VectorXd expected_ragged = scale.cwiseProduct(ragged * scale.cwiseProduct(x));
  EXPECT_LT((z - expected_ragged).norm(), 1e-13 * expected.norm());
}

TEST(Lanczos, ProductsAreTheSameForAnyNumberOfThreads) {
  // A band of blocks, and of entries: enough for several threads.
  constexpr int points = 60'000, wide = 4;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < 3 * points; ++i)
    for (int block = std::max(0, i / 3 - wide); block <= std::min(points - 1, i / 3 + wide); ++block)
      for (int j = 3 * block; j < 3 * block + 3; ++j) entries.emplace_back(i, j, 1.0 / (1 + i % 7 + j % 7));
  Eigen::SparseMatrix<double> A(3 * points, 3 * points);
  A.setFromTriplets(entries.begin(), entries.end());
  const VectorXd scale = VectorXd::Ones(A.rows()), x = start_vector(A.rows());
  for (const bool has_blocks : {true, false}) {
    if (!has_blocks) A.prune([](Index row, Index column, double) { return row + column != 1; });
    const SymmetricProduct product(A, scale);
    EXPECT_EQ(product.has_blocks(), has_blocks);
    VectorXd one(x.size()), three(x.size());
    {
      const Jobs threads(1);
      product(x, one);
    }
    const Jobs threads(3);
    product(x, three);
    EXPECT_EQ(one, three);
    EXPECT_LT((one - A * x).norm(), 1e-13 * one.norm());
  }
}

TEST(Lanczos, NeedsNoMatrixForALinearBody) {
  const TissueBody body(ball_mesh(0.1, 3), {.model = tissue_model("fem_cauchy")});
  const VectorXd zero = VectorXd::Zero(body.dofs()), root = body.mass().cwiseSqrt().cwiseInverse();
  const SymmetricOperator by_forces = [&](const VectorXd& x, VectorXd& y) {
    body.force(0, root.cwiseProduct(x), zero, y);
    y = -root.cwiseProduct(y);
  };
  TissueBody::DofMatrix K;
  body.stiffness(0, zero, zero, K);
  const MatrixXd k = root.asDiagonal() * MatrixXd(K) * root.asDiagonal();
  const double exact = Eigen::SelfAdjointEigenSolver<MatrixXd>(k).eigenvalues().maxCoeff();
  const LanczosPair pair = largest_eigenpair(by_forces, body.dofs());
  EXPECT_TRUE(pair.converged);
  EXPECT_NEAR(pair.value, exact, 1e-6 * exact);
}

}  // namespace
}  // namespace hmax
