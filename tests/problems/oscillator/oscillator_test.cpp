#include "problems/oscillator/oscillator.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "integrators/system.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

static_assert(DifferentiableSystem<BasicOscillator<float>>);
static_assert(DifferentiableSystem<Oscillator>);
static_assert(DifferentiableSystem<BasicOscillator<long double>>);
static_assert(noexcept(std::declval<const Oscillator&>().rhs(0.0, std::declval<const Eigen::Vector2d&>(),
                                                             std::declval<Eigen::Vector2d&>())));

using LongOscillator = BasicOscillator<long double>;

TEST(Oscillator, SpectralRadiusIsThatOfItsJacobian) {
  for (const double c : {-0.4, 0.0, 0.5, 3.0, 40.0})
    for (const double x : {0.0, 0.7, -2.0}) {
      const Oscillator system({.m = 1.3, .c = c, .k1 = 0.9, .k3 = 0.6, .P = 0.4, .w = 1.7});
      const Eigen::Vector2d y(x, 0.2);
      Eigen::Matrix2d J;
      system.jacobian(0, y, J);
      const double radius = J.eigenvalues().cwiseAbs().maxCoeff();
      EXPECT_NEAR(system.spectral_radius(0, y), radius, 1e-12 * radius) << c << " " << x;
    }
}

TEST(Oscillator, RhsIsNewtonsLawOfTheSixTerms) {
  const OscillatorParameters p{.m = 2, .c = 3, .k1 = 5, .k3 = 7, .P = 11, .w = 0};
  Eigen::Vector2d dydt;
  Oscillator(p).rhs(4.0, {0.5, -0.25}, dydt);
  EXPECT_EQ(dydt[0], -0.25);
  // (11 - 3 (-1/4) - 5/2 - 7/8) / 2
  EXPECT_DOUBLE_EQ(dydt[1], 4.1875);
}

TEST(Oscillator, JacobianAndTimeDerivativeAgreeWithCentralDifferences) {
  const LongOscillator system;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-3, 3);
  const long double d = 1e-6L;
  for (int repeat = 0; repeat < 100; ++repeat) {
    const LongOscillator::State y(uniform(random), uniform(random));
    const long double t = 10 * uniform(random);
    LongOscillator::Jacobian J;
    system.jacobian(t, y, J);
    LongOscillator::State plus, minus, dfdt;
    for (int j = 0; j < 2; ++j) {
      const LongOscillator::State step = LongOscillator::State::Unit(j) * d;
      system.rhs(t, y + step, plus);
      system.rhs(t, y - step, minus);
      EXPECT_LT(((plus - minus) / (2 * d) - J.col(j)).norm(), 1e-11L);
    }
    system.time_derivative(t, y, dfdt);
    system.rhs(t + d, y, plus);
    system.rhs(t - d, y, minus);
    EXPECT_LT(((plus - minus) / (2 * d) - dfdt).norm(), 1e-11L);
  }
}

TEST(Oscillator, EnergyFallsByThePowerOfTheDamper) {
  OscillatorParameters p;
  p.P = 0;
  const LongOscillator system(p);
  const LongOscillator::State y(0.7L, -1.3L);
  LongOscillator::State dydt;
  system.rhs(0, y, dydt);
  const long double d = 1e-6L;
  const long double power = (system.energy(y + d * dydt) - system.energy(y - d * dydt)) / (2 * d);
  EXPECT_NEAR(static_cast<double>(power), -2 * 1.3 * 1.3, 1e-11);
}

TEST(Oscillator, ZeroForceGivesTheUnforcedModelAtAnyTime) {
  OscillatorParameters p;
  p.P = 0;
  p.w = 1e300;  // w t overflows: a cosine of it would be NaN
  Eigen::Vector2d dydt, dfdt;
  Oscillator(p).rhs(1e300, {1.0, 0.0}, dydt);
  Oscillator(p).time_derivative(1e300, {1.0, 0.0}, dfdt);
  EXPECT_DOUBLE_EQ(dydt[1], -1.5 / 1.45);
  EXPECT_EQ(dfdt[1], 0.0);
}

TEST(Oscillator, DecimalDataAreTheSameDoublesInEveryPrecision) {
  OscillatorParameters p;
  p.P = 0;
  p.k3 = 0;
  p.c = 0;
  LongOscillator::State dydt;
  LongOscillator(p).rhs(0, {1.0L, 0.0L}, dydt);
  EXPECT_EQ(dydt[1], -(static_cast<long double>(0.7) / static_cast<long double>(1.45)));
}

std::string message(const OscillatorParameters& p) {
  return error_of<std::invalid_argument>([&] { const Oscillator system(p); });
}

TEST(Oscillator, RefusesMassesThatAreNotPositiveAndParametersThatAreNotFinite) {
  OscillatorParameters p;
  p.m = 0;
  EXPECT_TRUE(says(message(p), "m is 0"));
  p.m = -1;
  EXPECT_TRUE(says(message(p), "must be positive"));
  p.m = -2.5e-9;
  EXPECT_TRUE(says(message(p), "m is -2.5e-09"));
  for (const auto& [name, member] : oscillator_parameter_names)
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      p = {};
      p.*member = bad;
      EXPECT_TRUE(says(message(p), "parameter " + std::string(name) + " is not a finite"));
    }
  p = {};
  p.m = 1e-310;
  EXPECT_TRUE(says(message(p), "overflows"));
}

}  // namespace
}  // namespace hmax
