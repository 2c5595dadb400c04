/// Structures whose mass couples unknowns: their equation, and the steps of methods beside closed forms.
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/implicit/dirk.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"
#include "integrators/integrate.hpp"
#include "integrators/mechanical.hpp"
#include "integrators/structural/generalized_alpha.hpp"
#include "problems/linear_structure.hpp"
#include "tests/problems/bar.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Root = CoupledMass::Root;

/// A free bar of n elements of length 1, E A = 1, rho A = 1, with consistent masses.
struct Bar {
  Sparse K, M;

  explicit Bar(Index n) { std::tie(K, M) = uniform_bar(n); }
  /// omega^2 = 6 (1 - cos a) / (2 + cos a) with the shape cos(a i), a = j pi / n.
  [[nodiscard]] double omega(Index j) const {
    const double c = std::cos(angle(j));
    return std::sqrt(6 * (1 - c) / (2 + c));
  }
  [[nodiscard]] VectorXd shape(Index j) const {
    VectorXd u(K.rows());
    for (Index i = 0; i < u.size(); ++i) u[i] = std::cos(angle(j) * static_cast<double>(i));
    return u;
  }
  [[nodiscard]] double angle(Index j) const {
    return static_cast<double>(j) * std::numbers::pi / static_cast<double>(K.rows() - 1);
  }
  [[nodiscard]] AnySystem system(Root root, double alpha, double beta) const {
    return AnySystem(LinearStructure<Sparse>(
        K, MassMatrix<double>(std::make_shared<const CoupledMass>(M, root)), Sparse(alpha * M + beta * K)));
  }
};

constexpr Root roots[]{Root::factor, Root::polynomial};
constexpr Index elements = 12, mode = 7;
constexpr double alpha = 0.03, beta = 0.05, h = 0.4;
constexpr int steps = 25;

/// After steps from the shape at rest: the amplitude and the velocity of the mode.
template <class Stepper>
void expect_amplitude(Stepper stepper, Complex amplitude_of_step(Complex), double a, double b) {
  const Bar bar(elements);
  const double omega = bar.omega(mode), half = (a + b * omega * omega) / 2;
  const Complex lambda(-half, std::sqrt(omega * omega - half * half));
  // q(n h) = Re(weight zeta^n) with q(0) = Re(weight) = 1 and v(0) = Re(lambda weight) = 0.
  const Complex zeta = amplitude_of_step(h * lambda), weight(1, lambda.real() / lambda.imag());
  const double expected = (weight * std::pow(zeta, steps)).real();
  for (const Root root : roots) {
    const AnySystem system = bar.system(root, a, b);
    VectorXd y(system.dim());
    y << bar.shape(mode), VectorXd::Zero(bar.K.rows());
    integrate(stepper, system, Span<double>{0, steps * h}, y, FixedStep(h));
    EXPECT_LT((y.head(bar.K.rows()) - expected * bar.shape(mode)).norm(), 1e-10) << static_cast<int>(root);
  }
}

TEST(CoupledStructure, HasTheAccelerationThatSolvesItsEquation) {
  const Bar bar(elements);
  const Index n = bar.K.rows();
  const Sparse C = 0.1 * bar.M + 0.2 * bar.K;
  for (const Root root : roots) {
    const AnySystem system = bar.system(root, 0.1, 0.2);
    ASSERT_TRUE(system.has_sparse_matrices());
    EXPECT_THROW((void)system.mass(), std::invalid_argument);
    const VectorXd y = VectorXd::LinSpaced(2 * n, -1, 3).array().sin();
    VectorXd rates(2 * n), f(n);
    system.rhs(0, y, rates);
    EXPECT_EQ(rates.head(n), y.tail(n));
    const VectorXd F = -(bar.K * y.head(n) + C * y.tail(n));
    EXPECT_LT((bar.M * rates.tail(n) - F).norm(), 1e-13 * F.norm());
    system.force(0, y.head(n), y.tail(n), f);
    EXPECT_LT((f - F).norm(), 1e-14 * F.norm());
    AnySystem::Jacobian J;
    system.jacobian(0, y, J);
    EXPECT_LT((std::get<Sparse>(J) * y - rates).norm(), 1e-12 * rates.norm());
  }
}

TEST(CoupledStructure, IsSteppedByExplicitMethodsAsItsModesAre) {
  expect_amplitude(
      Rk<tableaux::Rk4, VectorXd>{},
      [](Complex z) { return 1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))); }, alpha, beta);
}

TEST(CoupledStructure, IsSteppedByImplicitMethodsAsItsModesAre) {
  using Matrix = equations_type<AnySystem>;
  expect_amplitude(
      Dirk<tableaux::ImplicitEuler, VectorXd, Matrix>{}, [](Complex z) { return 1.0 / (1.0 - z); }, alpha,
      beta);
  expect_amplitude(
      GeneralizedAlpha<VectorXd, VectorXd, AnySystem::DofMatrix>(newmark_parameters(0.25L, 0.5L)),
      [](Complex z) { return (1.0 + z / 2.0) / (1.0 - z / 2.0); }, 0, 0);
  // The trapezoidal rule of damped structures too.
  expect_amplitude(
      GeneralizedAlpha<VectorXd, VectorXd, AnySystem::DofMatrix>(newmark_parameters(0.25L, 0.5L)),
      [](Complex z) { return (1.0 + z / 2.0) / (1.0 - z / 2.0); }, alpha, beta);
}

TEST(CoupledStructure, StructuralMethodsThatLumpDampingRefuseAMassThatIsNotLumped) {
  const auto run = [](double a) {
    const Bar bar(elements);
    VectorXd y(2 * bar.K.rows());
    y << bar.shape(mode), VectorXd::Zero(bar.K.rows());
    integrate(CentralDifference<VectorXd>{}, bar.system(Root::fitting, a, 0), Span<double>{0, steps * h}, y,
              FixedStep(h));
    return y;
  };
  EXPECT_THROW((void)run(0.1), std::invalid_argument);
  // Without damping cos(n theta), sin(theta / 2) = omega h / 2.
  const Bar bar(elements);
  const double theta = 2 * std::asin(bar.omega(mode) * h / 2);
  EXPECT_LT((run(0).head(bar.K.rows()) - std::cos(steps * theta) * bar.shape(mode)).norm(), 1e-10);
}

TEST(CoupledStructure, KeepsItsStatesWhereMatricesAreSparse) {
  const Bar bar(3);
  const AnySystem system = linear_structure(bar.K, bar.M);
  AnySystem::DofMatrix K;
  system.stiffness(0, VectorXd::Zero(4), VectorXd::Zero(4), K);
  EXPECT_EQ(MatrixXd(std::get<Sparse>(K)), MatrixXd(bar.K));
  EXPECT_EQ(MatrixXd(system.mass_matrix().matrix()), MatrixXd(bar.M));
  Sparse negative = bar.M;
  negative.coeffRef(0, 0) = -1;
  EXPECT_THROW((void)linear_structure(bar.K, negative), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
