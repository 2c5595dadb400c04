/// The largest eigenvalue by Arnoldi iteration beside all of them by a dense solver.
#include "analysis/spectrum/arnoldi.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "analysis/spectrum/lanczos.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Numbers that no structure makes easy.
MatrixXd some_matrix(Eigen::Index n) {
  const VectorXd numbers = start_vector(n * n);
  return Eigen::Map<const MatrixXd>(numbers.data(), n, n);
}

LinearOperator product_with(const MatrixXd& A) {
  return [&A](const VectorXd& x) -> VectorXd { return A * x; };
}

double dense_radius(const MatrixXd& A) {
  return Eigen::EigenSolver<MatrixXd>(A).eigenvalues().cwiseAbs().maxCoeff();
}

TEST(Arnoldi, HasTheSpectralRadiusOfADenseSolver) {
  for (const Eigen::Index n : {1, 2, 3, 20, 120}) {
    const MatrixXd A = some_matrix(n);
    const DominantEigenvalue found =
        dominant_eigenvalue(product_with(A), VectorXd::Ones(n), {.most_products = 2000, .tolerance = 1e-10});
    EXPECT_TRUE(found.converged || n < 30) << n;
    EXPECT_NEAR(std::abs(found.value), dense_radius(A), 1e-8 * dense_radius(A)) << n;
    const Eigen::VectorXcd v = found.vector;
    EXPECT_LE((A * v - found.value * v).norm(), 1e-8 * std::abs(found.value)) << n;
  }
}

TEST(Arnoldi, MeasuresResidualsAndStretchInTheGivenInnerProduct) {
  const Eigen::Index n = 40;
  const VectorXd weights = VectorXd::LinSpaced(n, 1, 1e4), root = weights.cwiseSqrt();
  const MatrixXd A = some_matrix(n);
  const DominantEigenvalue found =
      dominant_eigenvalue(product_with(A), VectorXd::Ones(n),
                          {.basis = n, .most_products = n, .inner = [&](const VectorXd& x) -> VectorXd {
                             return weights.cwiseProduct(x);
                           }});
  EXPECT_NEAR(
      std::sqrt((found.vector.adjoint() * weights.cast<std::complex<double>>().cwiseProduct(found.vector))
                    .value()
                    .real()),
      1, 1e-10);
  // The residual is measured there, and vanishes in the whole space.
  const Eigen::VectorXcd left = A * found.vector - found.value * found.vector;
  EXPECT_NEAR((root.cast<std::complex<double>>().cwiseProduct(left)).norm(), 0, 1e-9 * std::abs(found.value));
  EXPECT_NEAR(found.residual, 0, 1e-9 * std::abs(found.value));
}

TEST(Arnoldi, SaysThatAProductHasLeftTheRangeOfNumbers) {
  const LinearOperator lost = [](const VectorXd& x) -> VectorXd {
    return VectorXd::Constant(x.size(), std::numeric_limits<double>::quiet_NaN());
  };
  EXPECT_TRUE(std::isinf(std::abs(dominant_eigenvalue(lost, VectorXd::Ones(5)).value)));
}

TEST(Arnoldi, StopsEarlyOnlyWhereTheSideOfTheThresholdIsKnown) {
  MatrixXd A = 0.5 * some_matrix(200) / std::sqrt(200.0);
  A(0, 0) += 3;
  const double radius = dense_radius(A);
  for (const double threshold : {0.9 * radius, 2 * radius}) {
    const DominantEigenvalue found = dominant_eigenvalue(product_with(A), VectorXd::Ones(200),
                                                         {.most_products = 400, .threshold = threshold});
    EXPECT_EQ(found.exceeds(threshold), radius > threshold) << threshold;
    EXPECT_LE(found.products, 60) << threshold;
  }
}

}  // namespace
}  // namespace hmax
