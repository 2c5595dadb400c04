#include "analysis/foreign_steps/step_derivative.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/foreign_steps/step_spectrum.hpp"
#include "tests/analysis/foreign_steps/mapped_stepper.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd curved(const VectorXd& y, double h) {
  return Eigen::Vector2d(y[0] + h * std::sin(40 * y[1]), y[1] - h * std::exp(30 * y[0]));
}

TEST(StepDerivative, ItsErrorIsWhatItEstimates) {
  const Eigen::Vector2d y(0.02, 0.03);
  const double h = 0.1;
  MatrixXd exact(2, 2);
  exact << 1, h * 40 * std::cos(40 * y[1]), -h * 30 * std::exp(30 * y[0]), 1;
  for (const bool single : {false, true}) {
    Mapped engine(curved, y, single);
    engine.save(0);
    const StateCoordinates coordinates(2, {});
    const StepDerivative derivative(engine, coordinates, Eigen::Vector2d(1, 1), 0, engine.state(), h);
    StepPattern pattern;
    const double error = (derivative.matrix(pattern) - exact).norm();
    EXPECT_LT(error, 10 * derivative.error()) << single;
    EXPECT_LT(error, single ? 1e-2 : 1e-6);
  }
}

TEST(StepDerivative, BalancingMeasuresVelocitiesInUnitsOfPositions) {
  MatrixXd J(2, 2);
  J << 1, 1e-3, -1e3, 1;  // omega = 1e3, h = 1e-3
  const VectorXd D = balancing_factors(J);
  EXPECT_NEAR(D[1] / D[0], 1e3, 1);
  const VectorXd by_products = balancing_factors([&](const VectorXd& v) { return VectorXd(J * v); }, 2);
  EXPECT_GT(by_products[1] / by_products[0], 200);
}

TEST(StepSpectrum, NeutralMultipliersDoNotGrow) {
  // A free mass and an oscillator by symplectic Euler: multipliers 1, 1 (one chain) and a pair of modulus 1.
  const auto free_and_bound = +[](const VectorXd& y, double h) {
    VectorXd next = y;
    next[3] -= h * 25 * y[1];
    next[0] += h * next[2];
    next[1] += h * next[3];
    return next;
  };
  for (const bool single : {false, true}) {
    Mapped engine(free_and_bound, VectorXd::Zero(4), single);
    engine.save(0);
    const StateCoordinates coordinates(4, {});
    StepPattern pattern;
    for (const double h : {0.01, 0.1, 0.39}) {
      const StepSpectrum found =
          spectrum_of_step(engine, coordinates, VectorXd::Ones(4), 0, VectorXd::Zero(4), h, pattern);
      EXPECT_FALSE(found.grows) << h << " " << found.spectral_radius;
      EXPECT_NEAR(found.spectral_radius, 1, single ? 1e-2 : 1e-5);
    }
    EXPECT_TRUE(
        spectrum_of_step(engine, coordinates, VectorXd::Ones(4), 0, VectorXd::Zero(4), 0.401, pattern).grows);
  }
}

TEST(StepPattern, GroupsGiveTheMatrixAndAMissingEntryIsNoticed) {
  // A ring of 30 numbers, each moved by its neighbour before it.
  const auto ring = +[](const VectorXd& y, double h) {
    VectorXd next = y;
    for (Eigen::Index i = 0; i < y.size(); ++i) next[i] += h * std::sin(y[(i + y.size() - 1) % y.size()]);
    return next;
  };
  Mapped engine(ring, VectorXd::LinSpaced(30, -1, 1));
  engine.save(0);
  const StateCoordinates coordinates(30, {});
  StepDerivative derivative(engine, coordinates, VectorXd::Ones(30), 0, engine.state(), 0.1);
  StepPattern learned;
  EXPECT_FALSE(learned.pays());
  const MatrixXd full = derivative.matrix(learned);
  ASSERT_TRUE(learned.pays());
  EXPECT_EQ(learned.entries().nonZeros(), 60);
  EXPECT_LE(learned.groups().size(), 3U);
  const auto grouped = derivative.grouped_matrix(learned);
  ASSERT_TRUE(grouped);
  EXPECT_EQ((MatrixXd(*grouped) - full).norm(), 0);

  Eigen::SparseMatrix<double> less = learned.entries();
  less.prune([](Eigen::Index i, Eigen::Index j, double) { return i != 7 || j == 7; });
  StepPattern declared(less);
  EXPECT_FALSE(derivative.grouped_matrix(declared));
  EXPECT_FALSE(declared.pays());
  (void)derivative.matrix(declared);
  ASSERT_TRUE(declared.undeclared());
  EXPECT_EQ(*declared.undeclared(), (std::pair<Eigen::Index, Eigen::Index>(7, 6)));
  EXPECT_FALSE(learned.undeclared());
}

TEST(StateCoordinates, APatternTakesAQuaternionAsAWhole) {
  const StateCoordinates coordinates(6, {1});
  Eigen::SparseMatrix<double> of_state(6, 6);
  of_state.insert(0, 4) = 1;  // of the quaternion's last number
  const MatrixXd pattern = coordinates.pattern(of_state);
  ASSERT_EQ(pattern.rows(), 5);
  EXPECT_TRUE((pattern.row(0).segment(1, 3).array() > 0).all());
  EXPECT_EQ((pattern.array() > 0).count(), 3);
}

TEST(StateCoordinates, GoThereAndBackOnRotations) {
  const StateCoordinates coordinates(9, {1, 5});
  ASSERT_EQ(coordinates.size(), 7);
  VectorXd y = VectorXd::Zero(9);
  y.segment<4>(1) = Eigen::Vector4d(0.5, -0.5, 0.5, 0.5);
  y.segment<4>(5) = Eigen::Vector4d(0, 0, 0, 1);
  const VectorXd x = VectorXd::LinSpaced(7, -0.1, 0.2);
  VectorXd z = coordinates.at(y, x);
  EXPECT_NEAR(z.segment<4>(1).norm(), 1, 1e-15);
  EXPECT_LT((coordinates.of(y, z) - x).norm(), 1e-15);
  z.segment<4>(5) *= -1;  // the same rotation
  EXPECT_LT((coordinates.of(y, z) - x).norm(), 1e-15);
  EXPECT_THROW(StateCoordinates(9, {1, 4}), std::invalid_argument);
  EXPECT_THROW(StateCoordinates(9, {6}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
