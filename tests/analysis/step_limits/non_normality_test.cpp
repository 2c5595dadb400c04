#include "analysis/step_limits/non_normality.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "core/numbers.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "problems/test_set/spring_chain.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::Vector2d;

Matrix2d two(double a, double b, double c, double d) { return (Matrix2d() << a, b, c, d).finished(); }

double resolvent_norm(const MatrixXd& J, Complex z) {
  const MatrixXcd A = z * MatrixXcd::Identity(J.rows(), J.cols()) - J.cast<Complex>();
  return 1 / Eigen::JacobiSVD<MatrixXcd, Eigen::NoQRPreconditioner>(A).singularValues()[J.rows() - 1];
}

/// The largest value of f on a fine grid of (0, infinity).
template <class F>
double largest(const F& f) {
  double most = 0;
  for (int i = -400000; i <= 400000; ++i) most = std::max(most, f(std::pow(10.0, i * 1e-5)));
  return most;
}

TEST(NonNormality, OfATriangularMatrixIsItsCorner) {
  for (const double k : {0.0, 1.0, 100.0, 1e6}) {
    const NonNormality found = non_normality(two(-1, k, 0, -2));
    EXPECT_NEAR(found.departure, k, 1e-14 * (1 + k));
    EXPECT_NEAR(found.relative_departure, k / std::sqrt(5 + k * k), 1e-14);
    EXPECT_NEAR(found.spectral_abscissa, -1, 1e-15);
    EXPECT_NEAR(found.numerical_abscissa, -1.5 + std::sqrt(1 + k * k) / 2, 1e-14 * (1 + k));
  }
}

TEST(NonNormality, OfASmallCornerIsNotLostInRounding) {
  EXPECT_NEAR(non_normality(two(-1, 1e-9, 0, -2)).departure, 1e-9, 1e-22);
}

TEST(NonNormality, OfAModelThatStandsStillIsNone) {
  const NonNormality found = non_normality(MatrixXd::Zero(3, 3));
  EXPECT_EQ(found.departure, 0);
  EXPECT_EQ(found.relative_departure, 0);
  EXPECT_EQ(found.spectral_abscissa, 0);
  EXPECT_EQ(found.numerical_abscissa, 0);
}

TEST(KreissConstant, OfNormalMatricesIsOne) {
  for (const Matrix2d& J : {two(-1, 0, 0, -3), two(0, 7, -7, 0), two(-1, 2, -2, -1)}) {
    EXPECT_EQ(kreiss_constant(J).value, 1) << J;
    EXPECT_EQ(kreiss_constant(J).bound, 1) << J;
  }
}

TEST(KreissConstant, OfAJordanBlockIsThatOfItsResolvent) {
  // |(z I - J)^-1| of (-1, b; 0, -1) is (g / 2 + sqrt(1 + g^2 / 4)) / r with r = |z + 1|, g = b / r: largest
  // on the real axis.
  for (const double b : {3.0, 20.0, 1000.0}) {
    const double exact = largest([b](double x) {
      const double r = x + 1, g = b / r;
      return x / r * (g / 2 + std::sqrt(1 + g * g / 4));
    });
    const KreissConstant found = kreiss_constant(two(-1, b, 0, -1));
    EXPECT_NEAR(found.value, exact, 1e-8 * exact) << b;
    EXPECT_GE(found.bound, found.value);
    EXPECT_LE(found.bound, 1.0002 * found.value);
    EXPECT_NEAR(found.at.imag(), 0, 1e-3);
  }
  EXPECT_NEAR(kreiss_constant(two(-1, 1e6, 0, -1)).value, 1e6 / 4, 1);  // x b / (x + 1)^2 at x = 1
}

TEST(KreissConstant, LiesBelowTheTransientGrowthAsTheTheoremSays) {
  for (const double k : {5.0, 50.0, 5000.0}) {
    const double growth = largest([k](double t) {
      // exp(t J) of (-1, k; 0, -2).
      const double slow = std::exp(-t), fast = std::exp(-2 * t), corner = k * (slow - fast);
      const double square = slow * slow + fast * fast + corner * corner, det = slow * fast;
      return (std::sqrt(square + 2 * det) + std::sqrt(std::max(0.0, square - 2 * det))) / 2;
    });
    const KreissConstant found = kreiss_constant(two(-1, k, 0, -2));
    EXPECT_LE(found.value, growth * (1 + 1e-9));
    EXPECT_GE(std::numbers::e * 2 * found.bound, growth);
    EXPECT_NEAR(found.value, found.at.real() * resolvent_norm(two(-1, k, 0, -2), found.at),
                1e-9 * found.value);
  }
}

TEST(KreissConstant, IsNoSmallerThanAnySampleAndItsBoundHolds) {
  MatrixXd J(6, 6);
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j)
      J(i, j) = (j > i ? 6 : 1) *
                std::sin(1.0 + 3.7 * static_cast<double>(i) + 1.3 * static_cast<double>(i * j + j));
  const double shift = non_normality(J).spectral_abscissa + 0.2;
  J.diagonal().array() -= shift;
  const KreissConstant found = kreiss_constant(J);
  EXPECT_GT(found.value, 2);
  double most = 0;
  for (int i = 0; i < 120; ++i)
    for (int j = 0; j <= 120; ++j) {
      const Complex z(std::pow(10.0, -3 + 0.05 * i), j * 0.25);
      most = std::max(most, z.real() * resolvent_norm(J, z));
    }
  EXPECT_GE(found.value, most * (1 - 1e-9));
  EXPECT_LE(found.value, most * 1.01);
  EXPECT_LE(found.bound, 1.0002 * found.value);
}

TEST(KreissConstant, OfWhatGrowsForeverIsInfinite) {
  EXPECT_EQ(kreiss_constant(two(0.1, 0, 0, -1)).value, infinity);
  EXPECT_EQ(kreiss_constant(two(0, 1, 0, 0)).value, infinity);  // a free body drifts
}

TEST(EnergyCoordinates, MakeUndampedChainsNormalAndPassiveOnesContract) {
  for (const double c : {0.0, 0.05, 5.0}) {
    const SpringChain<double> chain({.n = 12, .c = c});
    const LinearModel model = linearise(chain, 0, chain.y0());
    const MatrixXd J = jacobian_in_energy_coordinates(model);
    const NonNormality found = non_normality(J);
    EXPECT_NEAR(found.numerical_abscissa, 0, 1e-13 * J.norm());
    EXPECT_EQ(found.relative_departure < 1e-13, c == 0) << found.relative_departure;
    EXPECT_EQ(kreiss_constant(J).value, 1);
    // In metres and metres per second the same chain seems to grow.
    EXPECT_GT(non_normality(dense(model.J())).relative_departure, 0.9);
  }
}

TEST(EnergyCoordinates, MeasureTheEnergy) {
  const Oscillator liver({.k3 = 0, .P = 0});
  const Vector2d y(0.3, -0.8);
  const auto energy = energy_coordinates(*linearise(liver, 0, y).mechanical);
  EXPECT_NEAR((energy.to * y).squaredNorm(), 2 * liver.energy(y), 1e-15);
  EXPECT_LT((energy.to * energy.from - MatrixXd::Identity(2, 2)).norm(), 1e-15);
}

}  // namespace
}  // namespace hmax
