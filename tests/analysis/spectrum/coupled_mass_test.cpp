/// Linear models whose mass couples unknowns, beside closed forms and Eigen's solver of the dense pencil.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "analysis/amplification/curve_limit.hpp"
#include "analysis/dynamics/coupled_motion.hpp"
#include "analysis/spectrum/damped_eigenvalues.hpp"
#include "analysis/spectrum/davidson.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/spectrum/modal_motion.hpp"
#include "analysis/spectrum/scaled_matrices.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "tests/problems/bar.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Root = CoupledMass::Root;

constexpr Root roots[]{Root::factor, Root::polynomial};

std::pair<Sparse, Sparse> uneven_bar(Index n) {
  return bar(
      n, [](int e) { return 1 + 0.5 * std::sin(e); }, [](int e) { return 1 + 0.4 * std::cos(2 * e); });
}

MechanicalPart part_of(const Sparse& K, const Sparse& M, const Sparse& C, Root root = Root::fitting) {
  return mechanical_part(MassMatrix<double>(std::make_shared<const CoupledMass>(M, root)), K, C);
}

VectorXd pencil(const Sparse& K, const Sparse& M) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(MatrixXd(K), MatrixXd(M)).eigenvalues();
}

TEST(CoupledMassModes, OfALongBarHaveTheirClosedForm) {
  constexpr Index n = 1000;
  const auto [K, M] = uniform_bar(n);
  for (const Root root : roots) {
    const MechanicalPart part = part_of(K, M, Sparse(n + 1, n + 1), root);
    const ExtremeStiffnesses largest = largest_stiffnesses(part);
    ASSERT_TRUE(largest.converged);
    // omega^2 = 6 (1 - cos) / (2 + cos) at cos = -1.
    EXPECT_NEAR(largest.kappa[0], 12, 12e-10);
    const ExtremeStiffnesses smallest = smallest_stiffnesses(part, 3);
    ASSERT_TRUE(smallest.converged);
    for (int j = 1; j < 3; ++j) {
      const double c = std::cos(j * std::numbers::pi / n);
      EXPECT_NEAR(smallest.kappa[static_cast<std::size_t>(j)], 6 * (1 - c) / (2 + c), 1e-9) << j;
    }
    EXPECT_LE(12, ScaledMatrices(part).largest_k().bound);
    EXPECT_NEAR(ScaledMatrices(part).largest_k().bound, 12, 1e-3);
  }
}

TEST(CoupledMassModes, AreThoseOfTheDensePencil) {
  const auto [K, M] = uneven_bar(60);
  const VectorXd expected = pencil(K, M);
  const Index n = expected.size();
  for (const Root root : roots) {
    const MechanicalPart part = part_of(K, M, Sparse(0.1 * M + 0.2 * K), root);
    EXPECT_TRUE(part.symmetric);
    EXPECT_EQ(part.damping, Damping::proportional);
    const auto rayleigh = rayleigh_coefficients(part);
    ASSERT_TRUE(rayleigh);
    EXPECT_NEAR((*rayleigh)[0], 0.1, 1e-11);
    EXPECT_NEAR((*rayleigh)[1], 0.2, 1e-11);
    const MechanicalModes all = mechanical_modes(part, true);
    for (Index i = 0; i < n; ++i) {
      EXPECT_NEAR(all.modes[static_cast<std::size_t>(i)].kappa, expected[i], 1e-12) << i;
      EXPECT_NEAR(all.modes[static_cast<std::size_t>(i)].gamma, 0.1 + 0.2 * expected[i], 1e-11) << i;
    }
    EXPECT_LT((all.shapes.transpose() * M * all.shapes - MatrixXd::Identity(n, n)).norm(), 1e-12);
    // By iteration: the largest, the smallest, and those beside a place.
    const ExtremeStiffnesses largest = largest_stiffnesses(part, 4, 0),
                             smallest = smallest_stiffnesses(part, 4, 0),
                             near = stiffnesses_near(part, expected[30]);
    ASSERT_TRUE(largest.converged && smallest.converged && near.converged);
    for (Index i = 0; i < 4; ++i) {
      EXPECT_NEAR(largest.kappa[static_cast<std::size_t>(i)], expected[n - 1 - i], 1e-10) << i;
      EXPECT_NEAR(smallest.kappa[static_cast<std::size_t>(i)], expected[i], 1e-10) << i;
      const VectorXd u = largest.shapes.col(i);
      EXPECT_NEAR(u.dot(M * u), 1, 1e-10);
      EXPECT_LT((K * u - expected[n - 1 - i] * (M * u)).norm(), 1e-8);
    }
    EXPECT_NEAR(near.kappa[0], expected[30], 1e-9);
  }
}

TEST(CoupledMassModes, OfGeneralDampingAreThoseOfTheJacobian) {
  auto [K, M] = uneven_bar(40);
  K.coeffRef(0, 0) += 1;  // held: a rigid motion has a double eigenvalue of one vector
  const Sparse C = bar(
                       40, [](int e) { return e < 10 ? 0.4 : 0.01; }, [](int) { return 0.0; })
                       .first;
  const MechanicalPart part = part_of(K, M, C);
  ASSERT_EQ(part.damping, Damping::general);
  EXPECT_FALSE(rayleigh_coefficients(part));
  const Index n = K.rows();
  MatrixXd J = MatrixXd::Zero(2 * n, 2 * n);
  J.topRightCorner(n, n).setIdentity();
  J.bottomLeftCorner(n, n) = -MatrixXd(M).llt().solve(MatrixXd(K));
  J.bottomRightCorner(n, n) = -MatrixXd(M).llt().solve(MatrixXd(C));
  std::vector<Complex> expected;
  for (const Complex lambda : J.eigenvalues()) expected.push_back(lambda);
  std::ranges::sort(expected, std::ranges::greater{}, [](Complex l) { return std::abs(l); });
  const auto matrices = std::make_shared<const ScaledMatrices>(part);
  const LargestEigenpair k = matrices->largest_k(), c = matrices->largest_c();
  for (const DampedEigenvalues& largest :
       {DampedSearch(matrices, k, c).first(20, 1000), many_damped_eigenvalues(*matrices, k, c)}) {
    ASSERT_GE(largest.lambda.size(), 2U);
    for (std::size_t i = 0; i < largest.lambda.size(); ++i) {
      const Complex lambda = largest.lambda[i];
      EXPECT_NEAR(std::abs(lambda), std::abs(expected[i]), 1e-7) << i;
      const Eigen::VectorXcd u = largest.shapes[i], Mu = part.mass.times(u);
      EXPECT_NEAR(std::real(u.dot(Mu)), 1, 1e-10);
      EXPECT_LT((lambda * lambda * Mu + lambda * (C * u) + K * u).norm(), 1e-6 * std::norm(lambda));
    }
  }
  const LinearModel model{
      .t = 0, .y = VectorXd::Zero(2 * n), .J = [J] { return AnyMatrix(J); }, .mechanical = part};
  std::vector<Complex> all = spectrum_of(model).lambda;
  std::ranges::sort(all, std::ranges::greater{}, [](Complex l) { return std::abs(l); });
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_NEAR(std::abs(all[i]), std::abs(expected[i]), 1e-6) << i;
  // Right and left vectors in the states themselves.
  const Eigenvectors vectors = eigenvectors_of(model);
  ASSERT_FALSE(vectors.defective);
  for (Index i = 0; i < 2 * n; ++i)
    EXPECT_LT((J * vectors.right.col(i) - vectors.lambda[static_cast<std::size_t>(i)] * vectors.right.col(i))
                  .norm(),
              1e-6);
  EXPECT_LT((vectors.left * vectors.right - Eigen::MatrixXcd::Identity(2 * n, 2 * n)).norm(), 1e-6);
}

TEST(CoupledMassModes, MoveAsTheirSum) {
  const auto [K, M] = uniform_bar(20);
  const MechanicalPart part = part_of(K, M, Sparse(21, 21));
  VectorXd y0 = VectorXd::Zero(42);
  const double a = 5 * std::numbers::pi / 20, omega = std::sqrt(6 * (1 - std::cos(a)) / (2 + std::cos(a)));
  for (Index i = 0; i < 21; ++i) y0[i] = std::cos(a * static_cast<double>(i));
  const ModalMotion motion(part, VectorXd::Zero(21), y0);
  EXPECT_LT((motion.at(3).head(21) - std::cos(3 * omega) * y0.head(21)).norm(), 1e-11);
  EXPECT_LT((motion.at(3).tail(21) + omega * std::sin(3 * omega) * y0.head(21)).norm(), 1e-11);
}

TEST(Davidson, FindsTheLargestWithTheirMultiplicities) {
  // Three equal bars, in turn: every eigenvalue three times.
  const auto [K, M] = uneven_bar(80);
  const auto three = [](const Sparse& A) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < A.outerSize(); ++j)
      for (Sparse::InnerIterator entry(A, j); entry; ++entry)
        for (int c = 0; c < 3; ++c)
          entries.emplace_back(3 * static_cast<int>(entry.row()) + c, 3 * j + c, entry.value());
    Sparse B(3 * A.rows(), 3 * A.rows());
    B.setFromTriplets(entries.begin(), entries.end());
    return B;
  };
  const VectorXd expected = pencil(K, M);
  const Sparse K3 = three(K);
  const CoupledMass mass(three(M));
  const PencilPairs found =
      largest_pencil_eigenpairs([&](const VectorXd& x, VectorXd& y) { y = K3 * x; }, mass, 7);
  ASSERT_TRUE(found.converged);
  for (Index i = 0; i < 7; ++i)
    EXPECT_NEAR(found.values[static_cast<std::size_t>(i)], expected[80 - i / 3], 1e-10) << i;
  EXPECT_LT((found.vectors.transpose() * mass.matrix() * found.vectors - MatrixXd::Identity(7, 7)).norm(),
            1e-10);
}

}  // namespace
}  // namespace hmax
