/// Searches that restart, against the closed form of a uniform chain; others are in
/// tests/analysis/step_limits/damping_range_test.cpp.
#include "analysis/spectrum/damped_eigenvalues.hpp"

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Equal masses on equal springs between two walls, C = alpha M + beta K.
struct UniformChain {
  Index n;
  double m = 0.5, k = 200, alpha = 3, beta = 1e-3;

  [[nodiscard]] MechanicalPart part() const {
    Sparse K(n, n), M(n, n);
    for (Index i = 0; i < n; ++i) {
      M.insert(i, i) = m;
      K.coeffRef(i, i) = 2 * k;
      if (i > 0) K.coeffRef(i, i - 1) = K.coeffRef(i - 1, i) = -k;
    }
    return mechanical_part(VectorXd::Constant(n, m), K, Sparse(alpha * M + beta * K));
  }
  [[nodiscard]] double angle(Index j) const {
    return static_cast<double>(j) * std::numbers::pi / static_cast<double>(n + 1);
  }
  /// lambda^2 + (alpha + beta kappa) lambda + kappa = 0, kappa = 4 k / m sin^2(j pi / (2 (n + 1))), Im > 0.
  [[nodiscard]] std::complex<double> eigenvalue(Index j) const {
    const double sine = std::sin(angle(j) / 2);
    const double kappa = 4 * k / m * sine * sine, gamma = alpha + beta * kappa;
    return {-gamma / 2, std::sqrt(kappa - gamma * gamma / 4)};
  }
  /// sin(j p pi / (n + 1)) of the body p, of length 1 in the norm of M.
  [[nodiscard]] Eigen::VectorXcd shape(Index j) const {
    VectorXd u(n);
    for (Index p = 0; p < n; ++p) u[p] = std::sin(angle((p + 1) * j));
    return (u.normalized() / std::sqrt(m)).cast<std::complex<double>>();
  }
};

TEST(ScaledMatrices, FindTheLargestEigenvalueOfEverySumOfBoth) {
  const UniformChain chain{.n = 20};
  const ScaledMatrices matrices(chain.part());
  const auto kappa = [&](Index j) { return std::norm(chain.eigenvalue(j)); };
  const auto gamma = [&](Index j) { return chain.alpha + chain.beta * kappa(j); };
  const FindLargestOfSum find = matrices.largest_of_sum(1.1 * gamma(chain.n), 1.1 * kappa(chain.n));
  // a gamma + b kappa rises with kappa, or falls where b is negative: then the slowest mode has the largest.
  for (const auto& [a, b, j] :
       {std::tuple(1.0, 0.0, chain.n), {0.0, 1.0, chain.n}, {0.0, -1.0, Index(1)}, {-2.0, -1.0, Index(1)}}) {
    const LargestOfSum found = find(a, b, 1e-10);
    EXPECT_TRUE(found.converged) << a << " " << b;
    const double size = std::abs(a) * gamma(chain.n) + std::abs(b) * kappa(chain.n);
    EXPECT_NEAR(found.value, a * gamma(j) + b * kappa(j), 1e-9 * size) << a << " " << b;
    EXPECT_NEAR(found.kappa, kappa(j), 1e-6 * kappa(chain.n)) << a << " " << b;
    EXPECT_NEAR(found.gamma, gamma(j), 1e-6 * gamma(chain.n)) << a << " " << b;
  }
}

TEST(DampedSearch, ThatRestartsFindsTheEigenvaluesOfAUniformChain) {
  // Three or eight times the room of the space, whose restarts must keep what has been found.
  const UniformChain chain{.n = 200};
  const auto matrices = std::make_shared<const ScaledMatrices>(chain.part());
  for (const std::size_t most : {1U, 2U, 6U}) {
    DampedSearch search(matrices, matrices->largest_k(1e-3), matrices->largest_c(1e-3));
    const DampedEigenvalues found = search.first(most, 500);
    ASSERT_EQ(found.lambda.size(), 2 * most);
    for (std::size_t i = 0; i < found.lambda.size(); ++i) {
      const Index j = chain.n - static_cast<Index>(i / 2);
      const auto expected = chain.eigenvalue(j);
      EXPECT_LT(std::abs(found.lambda[i] - (i % 2 == 0 ? expected : std::conj(expected))),
                1e-9 * std::abs(expected))
          << most << " " << i;
      EXPECT_NEAR(std::abs(found.shapes[i].dot(chain.shape(j))) * chain.m, 1, 1e-4) << most << " " << i;
    }
    const double last = std::abs(chain.eigenvalue(chain.n + 1 - static_cast<Index>(most)));
    EXPECT_NEAR(found.rest, last, 1e-9 * last);
  }
}

}  // namespace
}  // namespace hmax
