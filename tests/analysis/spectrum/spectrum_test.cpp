#include "analysis/spectrum/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "problems/test_set/arenstorf.hpp"
#include "problems/test_set/lorenz.hpp"
#include "problems/test_set/spring_chain.hpp"
#include "tests/analysis/spectrum/chain_model.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// 4 sin^2(j pi / (2 (n + 1))), j = 1 ... n: the second difference between two walls.
double second_difference(Index j, Index n) {
  const double s = std::sin(std::numbers::pi * static_cast<double>(j) / static_cast<double>(2 * (n + 1)));
  return 4 * s * s;
}

/// The model of a mechanical part, as linearise() would make it.
LinearModel model_of(const MechanicalPart& part) {
  const Index n = part.mass.size();
  MatrixXd J = MatrixXd::Zero(2 * n, 2 * n);
  J.topRightCorner(n, n).setIdentity();
  J.bottomLeftCorner(n, n) = -(part.mass.diagonal().cwiseInverse().asDiagonal() * dense(part.K));
  J.bottomRightCorner(n, n) = -(part.mass.diagonal().cwiseInverse().asDiagonal() * dense(part.C));
  return {.y = VectorXd::Zero(2 * n), .J = [J] { return J; }, .mechanical = part};
}

/// Largest distance between two spectra, each value of `a` to its nearest in `b` that is not taken yet.
double distance(const std::vector<Complex>& a, std::vector<Complex> b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (const Complex& value : a) {
    const auto nearest =
        std::ranges::min_element(b, {}, [&](const Complex& other) { return std::abs(other - value); });
    largest = std::max(largest, std::abs(*nearest - value));
    b.erase(nearest);
  }
  return largest;
}

/// The eigenvalues of the whole Jacobian, by Eigen alone.
std::vector<Complex> by_eigen(const LinearModel& model) {
  const Eigen::VectorXcd values = Eigen::EigenSolver<MatrixXd>(dense(model.J()), false).eigenvalues();
  return {values.begin(), values.end()};
}

void expect_eigenvectors(const LinearModel& model, double tolerance) {
  const Eigenvectors vectors = eigenvectors_of(model);
  const MatrixXd J = dense(model.J());
  const Index n = J.rows();
  ASSERT_FALSE(vectors.defective) << vectors.note;
  ASSERT_EQ(static_cast<Index>(vectors.lambda.size()), n);
  const Eigen::VectorXcd lambda = Eigen::Map<const Eigen::VectorXcd>(vectors.lambda.data(), n);
  const MatrixXcd& V = vectors.right;
  EXPECT_LT((J * V - V * lambda.asDiagonal()).norm(), tolerance * J.norm());
  EXPECT_LT((vectors.left * J - lambda.asDiagonal() * vectors.left).norm(),
            tolerance * J.norm() * vectors.left.norm());
  EXPECT_LT((vectors.left * V - MatrixXcd::Identity(n, n)).norm(), tolerance * vectors.condition);
  for (Index i = 0; i < n; ++i) EXPECT_NEAR(V.col(i).norm(), 1, 1e-14);
  EXPECT_LT(distance(vectors.lambda, spectrum_of(model).lambda), tolerance * J.norm());
}

TEST(Spectrum, OfTheSpringChainIsThatOfTheSecondDifference) {
  for (const double c : {0.0, 0.05, 1.0, 20.0})
    for (const double n : {2.0, 20.0, 61.0}) {
      const SpringChainParameters p{.n = n, .c = c};
      const Spectrum spectrum = spectrum_of(chain_model(p));
      const auto count = static_cast<Index>(n);
      ASSERT_EQ(static_cast<Index>(spectrum.mechanical.size()), count);
      ASSERT_EQ(static_cast<Index>(spectrum.lambda.size()), 2 * count);
      for (Index j = 1; j <= count; ++j) {
        const double shape = second_difference(j, count);
        const MechanicalMode& mode = spectrum.mechanical[static_cast<std::size_t>(j - 1)];
        EXPECT_NEAR(mode.kappa, p.k / p.m * shape, 1e-14 * 4 * p.k / p.m) << j;
        EXPECT_NEAR(mode.gamma, c / p.m * shape, 1e-13 * 4 * c / p.m) << j;
        for (const std::size_t i : {0U, 1U}) {
          const Complex l = spectrum.lambda[2 * static_cast<std::size_t>(j - 1) + i];
          const Complex residual = l * l + mode.gamma * l + mode.kappa;
          EXPECT_LT(std::abs(residual), 1e-14 * (std::norm(l) + std::abs(mode.gamma * l) + mode.kappa));
        }
      }
    }
}

TEST(Spectrum, OfAModeWithoutCancellation) {
  // lambda^2 + 1e9 lambda + 1 = 0 has the root -1e-9 (1 + 1e-18), lost by the schoolbook formula.
  const auto stiff = eigenvalues_of(MechanicalMode{.kappa = 1, .gamma = 1e9});
  EXPECT_NEAR(stiff[0].real(), -1e-9, 1e-23);
  EXPECT_NEAR(stiff[1].real(), -1e9, 1e-6);
  // Near critical damping, gamma = 2 (1 + 1e-12): lambda = -1 +- sqrt(2e-12).
  const double gamma = 2 * (1 + 1e-12), exactly = std::sqrt((gamma / 2 - 1) * (gamma / 2 + 1));
  EXPECT_NEAR(eigenvalues_of({.kappa = 1, .gamma = gamma})[0].real(), -gamma / 2 + exactly, 1e-15);
  EXPECT_EQ(eigenvalues_of({.kappa = 4, .gamma = 4})[0], eigenvalues_of({.kappa = 4, .gamma = 4})[1]);
  EXPECT_EQ(eigenvalues_of({.kappa = -4, .gamma = 0})[0], Complex(2, 0));
  EXPECT_EQ(eigenvalues_of({.kappa = 9, .gamma = 0})[0], Complex(0, 3));
  EXPECT_EQ(eigenvalues_of({.kappa = 0, .gamma = 0})[0], Complex(0, 0));
  EXPECT_EQ(eigenvalues_of({.kappa = 0, .gamma = 3})[1], Complex(-3, 0));
}

TEST(Spectrum, ModesHaveAFrequencyAndADampingRatio) {
  const Mode mode = mode_of(Complex(-0.6, 0.8));
  EXPECT_DOUBLE_EQ(mode.omega.value(), 1);
  EXPECT_DOUBLE_EQ(mode.zeta.value(), 0.6);
  EXPECT_FALSE(mode.rates);
  // x'' + 1.2 x' + x = 0 is the same.
  const Mode oscillation = mode_of(MechanicalMode{.kappa = 1, .gamma = 1.2});
  EXPECT_LT(std::abs(oscillation.lambda - mode.lambda), 1e-15);
  EXPECT_DOUBLE_EQ(oscillation.omega.value(), 1);
  EXPECT_DOUBLE_EQ(oscillation.zeta.value(), 0.6);
  EXPECT_FALSE(oscillation.rates);
}

TEST(Spectrum, ModesThatDoNotOscillateHaveTwoRates) {
  using Rates = std::array<double, 2>;
  // (d/dt + 2) (d/dt + 8)
  const Mode overdamped = mode_of(MechanicalMode{.kappa = 16, .gamma = 10});
  EXPECT_EQ(overdamped.lambda, Complex(-8));
  EXPECT_EQ(overdamped.omega, 4);
  EXPECT_EQ(overdamped.zeta, 1.25);
  EXPECT_EQ(overdamped.rates, (Rates{8, 2}));
  EXPECT_EQ(mode_of(MechanicalMode{.kappa = 16, .gamma = -10}).rates, (Rates{-8, -2}));
  EXPECT_EQ(mode_of(MechanicalMode{.kappa = 4, .gamma = 4}).zeta, 1);
  // What stands up: (d/dt - 2) (d/dt + 8).
  const Mode buckling = mode_of(MechanicalMode{.kappa = -16, .gamma = 6});
  EXPECT_FALSE(buckling.omega || buckling.zeta);
  EXPECT_EQ(buckling.rates, (Rates{8, -2}));
  // A damper without a spring.
  const Mode free = mode_of(MechanicalMode{.kappa = 0, .gamma = 3});
  EXPECT_EQ(free.omega, 0);
  EXPECT_FALSE(free.zeta);
  EXPECT_EQ(free.rates, (Rates{3, 0}));
  // Alone a rate says nothing of a frequency.
  for (const double lambda : {-7.0, 0.0, 7.0}) {
    const Mode alone = mode_of(Complex(lambda));
    EXPECT_EQ(alone.lambda, Complex(lambda));
    EXPECT_FALSE(alone.omega || alone.zeta || alone.rates);
  }
}

/// Masses on springs of random strength, each fixed to a wall as well.
MatrixXd random_stiffness(Index n) {
  MatrixXd K = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    K(i, i) += 40 + 30 * std::sin(3.0 * static_cast<double>(i));
    if (i + 1 == n) break;
    const double k = 100 + 90 * std::cos(5.0 * static_cast<double>(i));
    K(i, i) += k;
    K(i + 1, i + 1) += k;
    K(i, i + 1) -= k;
    K(i + 1, i) -= k;
  }
  return K;
}
VectorXd random_mass(Index n) { return VectorXd::LinSpaced(n, 0.1, 2.3); }

TEST(Spectrum, RayleighDampingGivesEachModeAlphaPlusBetaKappa) {
  const Index n = 12;
  const MatrixXd K = random_stiffness(n), M = random_mass(n).asDiagonal();
  for (const auto& [alpha, beta] : {std::pair(0.7, 0.003), std::pair(0.0, 0.02), std::pair(5.0, 0.0)}) {
    const auto model = model_of(mechanical_part(random_mass(n), K, MatrixXd(alpha * M + beta * K)));
    ASSERT_EQ(model.mechanical->damping, Damping::proportional);
    const Spectrum spectrum = spectrum_of(model);
    for (const MechanicalMode& mode : spectrum.mechanical)
      EXPECT_NEAR(mode.gamma, alpha + beta * mode.kappa, 1e-11 * (alpha + beta * mode.kappa));
    EXPECT_LT(distance(spectrum.lambda, by_eigen(model)), 1e-9 * dense(model.J()).norm());
  }
}

TEST(Spectrum, RigidMotionsOfABodyDampedInItsStrainAloneAreUndamped) {
  // A free chain of unequal springs and masses, whose numbers are no sums of powers of two.
  constexpr Index n = 12;
  MatrixXd K = MatrixXd::Zero(n, n);
  for (Index i = 0; i + 1 < n; ++i) {
    const double k = 1000.0 / 3 / static_cast<double>(i + 1);
    K.block(i, i, 2, 2) += (MatrixXd(2, 2) << k, -k, -k, k).finished();
  }
  const VectorXd mass = VectorXd::LinSpaced(n, 0.1, 0.7);
  for (const double beta : {1e-3, 1.0 / 7, 2.3e-5}) {
    const MechanicalPart part = mechanical_part(mass, K, MatrixXd(beta * K));
    EXPECT_EQ(mechanical_modes(part).modes.front().gamma, 0) << beta;
  }
}

TEST(Spectrum, ProportionalDampingNeedNotBeRayleighs) {
  // C = delta K M^-1 K: gamma = delta kappa^2 [caughey1965classical].
  const Index n = 9;
  const MatrixXd K = random_stiffness(n), inverse = random_mass(n).cwiseInverse().asDiagonal();
  const auto part = mechanical_part(random_mass(n), K, MatrixXd(1e-4 * K * inverse * K));
  ASSERT_EQ(part.damping, Damping::proportional);
  const auto modes = mechanical_modes(part).modes;
  const double largest = 1e-4 * modes.back().kappa * modes.back().kappa;
  for (const MechanicalMode& mode : modes)
    EXPECT_NEAR(mode.gamma, 1e-4 * mode.kappa * mode.kappa, 1e-13 * largest);
}

TEST(Spectrum, WithinRepeatedFrequenciesDampingIsDiagonalisedToo) {
  // Equal masses on equal springs to the wall, joined by dampers alone: kappa is n-fold, gamma is the second
  // difference.
  const Index n = 7;
  MatrixXd C = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    C(i, i) = 2 * 0.3;
    if (i + 1 < n) C(i, i + 1) = C(i + 1, i) = -0.3;
  }
  const auto part = mechanical_part(VectorXd::Constant(n, 0.2), 50 * MatrixXd::Identity(n, n), C);
  const auto modal = mechanical_modes(part, true);
  std::vector<double> gamma;
  for (const MechanicalMode& mode : modal.modes) {
    EXPECT_NEAR(mode.kappa, 250, 1e-12);
    gamma.push_back(mode.gamma);
  }
  std::ranges::sort(gamma);
  for (Index j = 1; j <= n; ++j)
    EXPECT_NEAR(gamma[static_cast<std::size_t>(j - 1)], 1.5 * second_difference(j, n), 1e-14 * 6);
  const MatrixXd& shapes = modal.shapes;
  const MatrixXd damping = shapes.transpose() * C * shapes;
  EXPECT_LT((damping - MatrixXd(damping.diagonal().asDiagonal())).norm(), 1e-13);
  EXPECT_LT(
      (shapes.transpose() * part.mass.diagonal().asDiagonal() * shapes - MatrixXd::Identity(n, n)).norm(),
      1e-13);
}

TEST(Spectrum, GeneralDampingSolvesTheQuadraticEigenvalueProblem) {
  const Index n = 5;
  const MatrixXd K = random_stiffness(n), M = random_mass(n).asDiagonal();
  MatrixXd C = MatrixXd::Zero(n, n);
  C(1, 1) = 3;  // one damper to the wall
  const auto model = model_of(mechanical_part(random_mass(n), K, C));
  ASSERT_EQ(model.mechanical->damping, Damping::general);
  const Spectrum spectrum = spectrum_of(model);
  EXPECT_TRUE(spectrum.mechanical.empty());
  Complex sum = 0;
  for (const Complex& l : spectrum.lambda) {
    const MatrixXcd pencil = l * l * M + l * C + K;
    const auto values = Eigen::JacobiSVD<MatrixXcd, Eigen::NoQRPreconditioner>(pencil).singularValues();
    EXPECT_LT(values[n - 1], 1e-13 * values[0]) << l;
    sum += l;
  }
  EXPECT_NEAR(sum.real(), -C(1, 1) / M(1, 1), 1e-12);  // the trace of -M^-1 C
  EXPECT_THROW(mechanical_modes(*model.mechanical), std::invalid_argument);
}

TEST(Spectrum, OfTheTriangularPointsOfEarthAndMoon) {
  // Lagrange: lambda^4 + lambda^2 + 27/4 mu (1 - mu) = 0; imaginary for the moon, though the potential has a
  // maximum there: the rotation alone keeps it stable.
  const double mu = 0.012277471;
  const Arenstorf<double> problem({.mu = mu});
  const Eigen::Vector4d l4(0.5 - mu, std::sqrt(3.0) / 2, 0, 0);
  const auto model = linearise(problem, 0, l4);
  for (const Complex& l : spectrum_of(model).lambda) {
    EXPECT_NEAR(l.real(), 0, 1e-14);
    EXPECT_LT(std::abs(l * l * l * l + l * l + 6.75 * mu * (1 - mu)), 1e-14);
  }
  expect_eigenvectors(model, 1e-13);
}

TEST(Spectrum, EigenvaluesComeWithGrowingModulusAndConjugatesTogether) {
  const Lorenz<double> lorenz;
  const auto lambda = spectrum_of(linearise(lorenz, 0, {8.4, 8.5, 27.0})).lambda;
  ASSERT_EQ(lambda.size(), 3U);
  EXPECT_TRUE(std::ranges::is_sorted(lambda, {}, [](const Complex& l) { return std::abs(l); }));
  for (std::size_t i = 0; i < 3; ++i)
    if (lambda[i].imag() > 0) {
      ASSERT_LT(i + 1, lambda.size());
      EXPECT_EQ(lambda[i + 1], std::conj(lambda[i]));
    }
}

TEST(Eigenvectors, BelongToTheEigenvaluesOnBothSides) {
  expect_eigenvectors(chain_model({.n = 13, .c = 0}), 1e-13);
  expect_eigenvectors(chain_model({.n = 13, .c = 0.05}), 1e-13);
  expect_eigenvectors(chain_model({.n = 8, .c = 3}), 1e-11);
  expect_eigenvectors(linearise(Oscillator{}, 0, Vector2d(0.5, 1)), 1e-14);
  expect_eigenvectors(linearise(Lorenz<double>{}, 0, {8.4, 8.5, 27.0}), 1e-13);
  const Index n = 5;
  MatrixXd C = MatrixXd::Zero(n, n);
  C(1, 1) = 3;
  expect_eigenvectors(model_of(mechanical_part(random_mass(n), random_stiffness(n), C)), 1e-13);
}

TEST(Eigenvectors, OfUndampedModesArePerfectlyConditionedInEnergy) {
  EXPECT_NEAR(eigenvectors_of(chain_model({.c = 0})).condition, 1, 1e-12);
}

TEST(Eigenvectors, OfAPairThatIsRealToRoundingAreNotDefective) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const MatrixXd J = (MatrixXd(2, 2) << 1, -1.5 * eps, 2.5 * eps, 1).finished();
  const LinearModel model{.y = VectorXd::Zero(2), .J = [J] { return J; }};
  EXPECT_LT(eigenvectors_of(model).condition, 10);
}

TEST(Eigenvectors, CriticalDampingIsDefective) {
  const double critical = 2 * std::sqrt(1.45 * 0.7);
  const Oscillator liver({.c = critical, .k3 = 0});
  auto model = linearise(liver, 0, Vector2d(0, 0));
  for (const bool mechanical : {true, false}) {
    if (!mechanical) model.mechanical.reset();
    const Eigenvectors vectors = eigenvectors_of(model);
    EXPECT_TRUE(vectors.defective) << vectors.condition;
    EXPECT_EQ(vectors.left.size(), 0);
    EXPECT_TRUE(says(vectors.note, "critical"));
    EXPECT_TRUE(vectors.right.allFinite());
  }
  EXPECT_FALSE(
      eigenvectors_of(linearise(Oscillator({.c = 1.001 * critical, .k3 = 0}), 0, Vector2d(0, 0))).defective);
}

TEST(Eigenvectors, AJordanBlockIsDefective) {
  const MatrixXd J = (MatrixXd(3, 3) << -1, 1, 0, 0, -1, 1, 0, 0, -1).finished();
  const LinearModel model{.y = VectorXd::Zero(3), .J = [J] { return J; }};
  EXPECT_TRUE(eigenvectors_of(model).defective);
}

TEST(Spectrum, TooManyUnknownsAreRefused) {
  EXPECT_TRUE(says(error_of<InputError>([&] { (void)spectrum_of(chain_model({.n = 5000})); }), "extreme"));
}

}  // namespace
}  // namespace hmax
