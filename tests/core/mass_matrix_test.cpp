/// Mass matrices: roots, inverses and what is refused.
#include "core/mass_matrix.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/core/jobs.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Root = CoupledMass::Root;

/// Consistent masses of linear elements on a grid of n x n points: the Kronecker product of those of two
/// bars, with other weights of the points.
Sparse plate(Index n, Index coordinates = 1) {
  const auto weight = [](Index i) { return 1 + 0.5 * std::sin(static_cast<double>(i)); };
  const auto bar = [&](Index i, Index j) { return i == j ? (i == 0 || i == n - 1 ? 2.0 : 4.0) : 1.0; };
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n * n; ++i)
    for (Index a = -1; a <= 1; ++a)
      for (Index b = -1; b <= 1; ++b) {
        const Index x = i / n + a, y = i % n + b;
        if (x < 0 || y < 0 || x >= n || y >= n) continue;
        for (Index c = 0; c < coordinates; ++c)
          entries.emplace_back(static_cast<int>(coordinates * i + c),
                               static_cast<int>(coordinates * (x * n + y) + c),
                               weight(i) * weight(x * n + y) * bar(i / n, x) * bar(i % n, y));
      }
  Sparse M(coordinates * n * n, coordinates * n * n);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

TEST(CoupledMass, DividesAndHasARootByAFactorAndByPolynomials) {
  for (const Index coordinates : {1, 3})
    for (const Root root : {Root::factor, Root::polynomial}) {
      const Sparse M = plate(6, coordinates);
      const MatrixXd full(M);
      const MassMatrix<double> mass(std::make_shared<const CoupledMass>(M, root));
      EXPECT_EQ(mass.coupled()->has_factor(), root == Root::factor);
      const MatrixXd same = MatrixXd::Identity(M.rows(), M.rows());
      EXPECT_LT((full * mass.solve(same) - same).norm(), 1e-12);
      const MatrixXd inverse_root = mass.root_solve(same);
      // R^-T M R^-1 = 1, both ways of R^-T.
      EXPECT_LT((inverse_root.transpose() * full * inverse_root - same).norm(), 1e-12);
      EXPECT_LT((mass.transposed_root_solve(same) - inverse_root.transpose()).norm(), 1e-13);
      EXPECT_LT((mass.root_times(inverse_root) - same).norm(), 1e-12);
      const Eigen::VectorXcd x = Eigen::VectorXcd::LinSpaced(M.rows(), {1, -2}, {3, 1});
      EXPECT_LT((full * mass.solve(x) - x).norm(), 1e-12 * x.norm());
      EXPECT_LT((full * x - mass.times(x)).norm(), 1e-12 * (full * x).norm());
      // No eigenvalue of D^-1 M is smaller.
      const MatrixXd D = full.diagonal().asDiagonal();
      const VectorXd shares = Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(full, D).eigenvalues();
      EXPECT_LE(mass.coupled()->least_share(), shares[0]);
      EXPECT_GE(mass.coupled()->least_share(), 0.9 * shares[0]);
    }
}

TEST(CoupledMass, TakesPolynomialsWhereAFactorWouldBeWork) {
  const CoupledMass small(plate(10)), large(plate(220, 3));
  EXPECT_TRUE(small.has_factor());
  EXPECT_FALSE(large.has_factor());
  VectorXd x = VectorXd::LinSpaced(large.size(), -1, 2);
  const VectorXd f = x;
  large.solve(x);
  EXPECT_LT((large.matrix() * x - f).norm(), 1e-13 * f.norm());
  // To the last bit by any number of threads.
  for (const std::size_t count : {1, 3}) {
    const Jobs threads(count);
    VectorXd again = f;
    large.solve(again);
    EXPECT_EQ(again, x) << count;
  }
}

TEST(CoupledMass, RefusesWhatIsNoMass) {
  const auto refusal = [](const MatrixXd& M, Root root = Root::fitting) {
    return error_of<std::invalid_argument>([&] { const CoupledMass mass(M.sparseView(), root); });
  };
  EXPECT_TRUE(says(refusal(MatrixXd{{1, 2}, {2, 1}}), "not positive definite"));
  EXPECT_TRUE(says(refusal(MatrixXd{{1, 1}, {1, -1}}), "not positive definite"));
  // Without a single entry.
  EXPECT_TRUE(says(refusal(MatrixXd::Zero(2, 2)), "not positive definite"));
  EXPECT_TRUE(says(refusal(MatrixXd{{2, 1}, {0.5, 2}}), "not symmetric"));
  EXPECT_TRUE(says(refusal(MatrixXd{{2, NAN}, {NAN, 2}}), "not symmetric"));
  EXPECT_TRUE(says(refusal(MatrixXd::Ones(2, 3)), "square"));
  EXPECT_EQ(refusal(MatrixXd{{2, 1}, {1, 3}}), "");
  // Far from its diagonal, but positive definite: by a factor.
  EXPECT_EQ(refusal(MatrixXd{{1, 1 - 1e-7}, {1 - 1e-7, 1}}), "");
  EXPECT_TRUE(says(refusal(MatrixXd{{1, 1 - 1e-7}, {1 - 1e-7, 1}}, Root::polynomial), "nearly singular"));
}

TEST(MassMatrix, OfLumpedMassesDividesByEach) {
  const Eigen::Vector3d m(1, 4, 9), x(2, 3, -1);
  const MassMatrix<double> mass = m;
  EXPECT_TRUE(mass.is_diagonal());
  EXPECT_EQ(mass.lumped(), VectorXd(m));
  EXPECT_EQ(mass.times(x), VectorXd(m.cwiseProduct(x)));
  EXPECT_EQ(mass.solve(x), VectorXd(x.cwiseQuotient(m)));
  EXPECT_EQ(mass.root_times(x), VectorXd(Eigen::Vector3d(2, 6, -3)));
  EXPECT_EQ(MatrixXd(mass.matrix()), MatrixXd(m.asDiagonal()));
  const MassMatrix<double> coupled(
      std::make_shared<const CoupledMass>(MatrixXd{{2, 1}, {1, 3}}.sparseView()));
  EXPECT_THROW((void)coupled.lumped(), std::invalid_argument);
  EXPECT_EQ(coupled.diagonal(), VectorXd(Eigen::Vector2d(2, 3)));
}

}  // namespace
}  // namespace hmax
