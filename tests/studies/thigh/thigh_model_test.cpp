#include "studies/thigh/thigh_model.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmax {
namespace {

constexpr std::array depths{0.004, 0.008, 0.012, 0.016, 0.02};  // [m]

TEST(ThighModel, IsInEquilibriumWhereNoProbePresses) {
  const Thigh thigh = true_thigh(4, 5);
  for (const Probe probe : {Probe::indentor, Probe::surface, Probe::across}) {
    const auto pressed = pressed_points(thigh, 7, probe);
    for (const PressedThigh& at : press(thigh, pressed, depths)) {
      Eigen::VectorXd r = thigh.forces(at.u);
      double force = 0;
      for (const Eigen::Index p : pressed) {
        EXPECT_NEAR(at.u[p], at.depth, 1e-15);
        force += r[p];
        r[p] = 0;
      }
      EXPECT_NEAR(at.force, force, 1e-12 * force);
      EXPECT_LT(r.lpNorm<Eigen::Infinity>(), 1e-9 * force);
    }
  }
}

TEST(ThighModel, HasTheForceOfItsSpringWithoutSkin) {
  Thigh thigh = true_thigh(2, 2);
  thigh.skin.clear();
  const std::array<Eigen::Index, 1> pressed{3};
  for (const PressedThigh& at : press(thigh, pressed, depths)) {
    const double force = thigh.a[3] * (std::exp(thigh.b[3] * at.depth) - 1);
    EXPECT_NEAR(at.force, force, 1e-12 * force);
    EXPECT_NEAR(at.u.head(3).norm(), 0, 1e-15);
  }
}

TEST(ThighModel, IsHarderToPressTheDeeperAndMovesLessThanTheProbe) {
  const Thigh thigh = true_thigh(5, 4);
  double last = 0, last_slope = 0;
  for (const PressedThigh& at : press(thigh, pressed_points(thigh, 9, Probe::surface), depths)) {
    EXPECT_GT(at.force / at.depth, last_slope);
    EXPECT_GT(at.force, last);
    last = at.force;
    last_slope = at.force / at.depth;
    EXPECT_GT(at.u.minCoeff(), 0);
    EXPECT_LE(at.u.maxCoeff(), at.depth * (1 + 1e-12));
    EXPECT_GT(at.slope.minCoeff(), 0);
    EXPECT_LE(at.slope.maxCoeff(), 1 + 1e-12);
  }
}

TEST(ThighModel, OffersALargerProbeMoreResistance) {
  const Thigh thigh = true_thigh();
  for (const Eigen::Index point : {0, 27, 63}) {
    const double small = press(thigh, pressed_points(thigh, point, Probe::indentor), depths).back().force;
    EXPECT_GT(press(thigh, pressed_points(thigh, point, Probe::surface), depths).back().force, small);
  }
}

TEST(ThighModel, HasTheStiffnessAndTheSlopeOfDifferences) {
  const Thigh thigh = true_thigh(3, 4);
  const auto pressed = pressed_points(thigh, 5, Probe::indentor);
  const double d = 1e-7;
  const auto at = press(thigh, pressed, std::array{0.01 - d, 0.01, 0.01 + d});
  const Eigen::MatrixXd K = thigh.stiffness(at[1].u);
  for (Eigen::Index j = 0; j < thigh.points(); ++j) {
    const Eigen::VectorXd e = d * Eigen::VectorXd::Unit(thigh.points(), j);
    const Eigen::VectorXd difference = (thigh.forces(at[1].u + e) - thigh.forces(at[1].u - e)) / (2 * d);
    EXPECT_LT((K.col(j) - difference).norm(), 1e-6 * K.norm()) << j;
  }
  EXPECT_LT((at[1].slope - (at[2].u - at[0].u) / (2 * d)).norm(), 1e-6);
}

TEST(ThighModel, HasTheForceGradientOfDifferences) {
  const Thigh thigh = true_thigh(3, 3);
  const auto pressed = pressed_points(thigh, 4, Probe::surface);
  const std::array one{0.015};
  const Eigen::VectorXd gradient = force_gradient(thigh, press(thigh, pressed, one).front());
  const auto difference = [&](auto change, double value) {
    const double d = 1e-5 * value;
    Thigh more = thigh, less = thigh;
    change(more) += d;
    change(less) -= d;
    return (press(more, pressed, one).front().force - press(less, pressed, one).front().force) / (2 * d);
  };
  const auto expect = [&](Eigen::Index k, double value) {
    EXPECT_NEAR(gradient[k], value, 1e-6 * std::abs(value) + 1e-9) << k;
  };
  for (Eigen::Index i = 0; i < 9; ++i) {
    expect(i, difference([i](Thigh& t) -> double& { return t.a[i]; }, thigh.a[i]));
    expect(9 + i, difference([i](Thigh& t) -> double& { return t.b[i]; }, thigh.b[i]));
  }
  for (std::size_t s = 0; s < thigh.skin.size(); ++s)
    expect(18 + static_cast<Eigen::Index>(s),
           difference([s](Thigh& t) -> double& { return t.skin[s].stiffness; }, thigh.skin[s].stiffness));
}

TEST(ThighModel, TellsThatForcesLeaveTheRangeOfNumbersByNoNumber) {
  Thigh thigh = true_thigh(2, 2);
  thigh.b[0] = 1e6;
  const std::array<Eigen::Index, 1> pressed{0};
  EXPECT_FALSE(std::isfinite(press(thigh, pressed, depths).back().force));
}

TEST(ThighModel, RefusesBadInput) {
  EXPECT_THROW(true_thigh(1, 8), std::invalid_argument);
  const Thigh thigh = true_thigh(2, 2);
  EXPECT_THROW(pressed_points(thigh, 4, Probe::indentor), std::invalid_argument);
  EXPECT_THROW(pressed_points(thigh, -1, Probe::indentor), std::invalid_argument);
  const std::array<Eigen::Index, 1> pressed{0};
  EXPECT_THROW(press(thigh, pressed, std::array{0.002, 0.001}), std::invalid_argument);
  EXPECT_THROW(press(thigh, pressed, std::array{0.0}), std::invalid_argument);
  EXPECT_THROW(press(thigh, pressed, std::array{std::numeric_limits<double>::infinity()}),
               std::invalid_argument);
  Thigh broken = thigh;
  broken.b[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(press(broken, pressed, depths), std::invalid_argument);
  broken = thigh;
  broken.skin[0].stiffness = -1;
  EXPECT_THROW(press(broken, pressed, depths), std::invalid_argument);
  broken = thigh;
  broken.a.resize(3);
  EXPECT_THROW(press(broken, pressed, depths), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
