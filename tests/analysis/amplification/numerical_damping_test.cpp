#include "analysis/amplification/numerical_damping.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/amplification/one_step_amplification.hpp"
#include "analysis/amplification/principal_root.hpp"
#include "analysis/amplification/structural_amplification.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/models/problems.hpp"

namespace hmax {
namespace {

using std::numbers::pi;

ShownOscillation shown(const std::string& method, double frequency, double zeta, double h) {
  return shown_oscillation(*find_formula(method).amplification, 2 * pi * frequency, zeta, h);
}

/// From the eigenvalues of the 3 x 3 matrix that takes (q, h v, h^2 a) over a step, written down by hand from
/// the balance and Newmark's formulas [chung1993time]; the pair of them, since the third is parasitic.
TEST(NumericalDamping, OfAlphaMethodsIsThatOfThePairAlsoWhereTheSpuriousRootIsCloserToTheExactOne) {
  struct Row {
    const char* method;
    double frequency, zeta, h, zeta_shown, frequency_shown;
  };
  for (const Row& row :
       std::vector<Row>{{"hht_alpha", 5, 0.9, 0.06, 0.5622205108523475, 3.9399840385373692},
                        {"hht_alpha", 5, 0.9, 0.04, 0.7376809274708754, 3.8740931013191147},
                        {"hht_alpha", 5, 0.1, 0.03, 0.09015963495847593, 4.587709539138981},
                        {"hht_alpha:alpha=-0.3", 5, 0.5, 0.05, 0.3556949859947729, 3.840039019791131},
                        {"generalized_alpha", 5, 0.9, 0.06, 0.6922222198376484, 3.9795754388121987},
                        {"generalized_alpha", 5, 0.9, 0.03, 0.8681116217408805, 2.6064758665844794}}) {
    const ShownOscillation seen = shown(row.method, row.frequency, row.zeta, row.h);
    EXPECT_NEAR(seen.zeta, row.zeta_shown, 1e-10) << row.method << " at " << row.h;
    EXPECT_NEAR(seen.frequency_damped, row.frequency_shown, 1e-9) << row.method << " at " << row.h;
    EXPECT_FALSE(seen.aliased);
  }
}

/// Runs obey x_n+2 = a x_n+1 - b x_n once parasitic roots have died out: a and b, the sum and product of the
/// pair, come from four states.
TEST(NumericalDamping, IsWhatRunsShow) {
  constexpr double frequency = 1, h = 0.12;
  for (const double zeta : {0.05, 0.3}) {
    const double omega = 2 * pi * frequency;
    const Problem problem = make_problem(
        "liver_linear",
        {.parameters = {{"m", 1}, {"c", 2 * zeta * omega}, {"k1", omega * omega}}, .y0 = {1, 0}});
    for (const char* method : {"hht_alpha", "generalized_alpha", "newmark", "symplectic_euler",
                               "implicit_euler", "sdirk_4", "adams_bashforth_2", "abm_pece_3"}) {
      std::vector<double> x;
      find_method(method).bind(problem).run({.t_end = 40 * h, .h = h},
                                            [&](double, const auto& y) { x.push_back(y[0]); });
      ASSERT_GE(x.size(), 41U) << method;
      const std::size_t n = 30;
      const double determinant = x[n + 1] * x[n + 1] - x[n] * x[n + 2];
      const double a = (x[n + 2] * x[n + 1] - x[n + 3] * x[n]) / determinant,
                   b = (x[n + 2] * x[n + 2] - x[n + 1] * x[n + 3]) / determinant;
      const std::complex<double> root = a / 2 + std::sqrt(std::complex<double>(a * a / 4 - b)),
                                 rate = std::log(root);
      const ShownOscillation seen = shown(method, frequency, zeta, h);
      EXPECT_NEAR(seen.zeta, -rate.real() / std::abs(rate), 1e-6) << method << " " << zeta;
      EXPECT_NEAR(seen.frequency_damped, std::abs(rate.imag()) / (2 * pi * h), 1e-6) << method << " " << zeta;
    }
  }
}

/// (3/2 - z) r^2 - 2 r + 1/2 = 0: r = (2 + sqrt(1 + 2 z)) / (3 - 2 z), and 1 + 2 z stays in the upper
/// half-plane.
TEST(NumericalDamping, OfBdf2IsItsClosedFormAtEveryStep) {
  for (const double zeta : {0.0, 0.4, 0.95})
    for (const double x : {0.01, 0.3, 1.0, 2.0, 3.0, 10.0, 300.0}) {
      const Complex lambda(-zeta, std::sqrt(1 - zeta * zeta)), z = x * lambda;
      const Complex root = (2.0 + std::sqrt(1.0 + 2.0 * z)) / (3.0 - 2.0 * z), rate = std::log(root);
      const ShownOscillation seen = shown("bdf_2", 1 / (2 * pi), zeta, x);
      EXPECT_NEAR(seen.zeta, -rate.real() / std::abs(rate), 1e-10) << x;
      EXPECT_NEAR(seen.frequency_damped * 2 * pi * x, std::abs(rate.imag()), 1e-10) << x;
    }
}

TEST(NumericalDamping, SaysWhereNyquistIsPassed) {
  // The trapezoidal rule turns by 2 atan(omega h / 2), always less than half a circle; the mode itself passes
  // pi.
  const ShownOscillation below = shown("trapezoidal", 1, 0, 0.49), above = shown("trapezoidal", 1, 0, 0.51);
  EXPECT_FALSE(below.aliased);
  EXPECT_NEAR(below.period_error, pi * 0.98 / (2 * std::atan(pi * 0.49)) - 1, 1e-12);
  EXPECT_TRUE(above.aliased);
  EXPECT_TRUE(std::isnan(above.period_error));
  // rk4 turns the mode by more than half a circle at omega h = 2.8, where the mode turns by less: R(2.8 i)
  // has the angle -1.9719, reached over pi.
  const ShownOscillation fast = shown("rk4", 2.8 / (2 * pi), 0, 1);
  EXPECT_TRUE(fast.aliased);
  EXPECT_FALSE(shown("rk4", 1.5 / (2 * pi), 0, 1).aliased);
}

TEST(NumericalDamping, OfAMethodWithoutDampingIsZeroWithoutASign) {
  for (const char* method : {"newmark", "trapezoidal", "symplectic_euler", "implicit_midpoint"}) {
    const ShownOscillation seen = shown(method, 8, 0, 0.01);
    EXPECT_EQ(seen.zeta, 0) << method;
    EXPECT_FALSE(std::signbit(seen.zeta)) << method;
  }
}

/// The pair meets on the real axis and parts along it, and one of the two then meets the spurious root: the
/// larger root stays continuous.
TEST(PrincipalRoot, MovesContinuouslyWithTheStep) {
  for (const char* method : {"hht_alpha", "generalized_alpha", "generalized_alpha:rho_inf=0.2", "bdf_3",
                             "bdf_6", "adams_bashforth_3"})
    for (const double zeta : {0.3, 0.9, 0.999}) {
      const auto amplification = find_formula(method).amplification;
      const Complex lambda(-zeta, std::sqrt(1 - zeta * zeta));
      const Growth growth = amplification->of_oscillation
                                ? amplification->of_oscillation({.kappa = 1, .gamma = 2 * zeta})
                                : amplification->of_eigenmode(Eigenmode(lambda));
      Complex before = 1;
      for (double h = 0.02; h < 3; h += 0.02) {
        const Complex here = principal_root(*growth.polynomial, lambda, h).zeta;
        EXPECT_LT(std::abs(here - before), 0.2) << method << " " << zeta << " at " << h;
        before = here;
      }
    }
}

/// A step multiplies the mode of omega and zeta by radius exp(+-i angle).
void expect_shown(const ShownOscillation& shown, double radius, double angle, double omega, double zeta,
                  double h) {
  const double decay = -std::log(radius);
  EXPECT_NEAR(shown.omega, std::hypot(decay, angle) / h, 1e-11 * omega);
  EXPECT_NEAR(shown.zeta, decay / std::hypot(decay, angle), 1e-11);
  EXPECT_NEAR(shown.frequency_damped, angle / (2 * std::numbers::pi * h), 1e-12 * omega);
  EXPECT_NEAR(shown.period_error, omega * std::sqrt(1 - zeta * zeta) * h / angle - 1, 1e-11);
  EXPECT_NEAR(shown.spectral_radius, radius, 1e-12);
}

TEST(ShownOscillation, OfTheTrapezoidalRuleLastsLongerAndKeepsItsAmplitude) {
  // tan(angle / 2) = omega h / 2 [hughes2000finite, 9.3]
  const Amplification newmark = generalized_alpha_amplification(newmark_parameters(0.25L, 0.5L));
  constexpr std::array<long double, 4> a{0, 0, 0.5L, 0.5L};
  constexpr std::array<long double, 2> b{0.5L, 0.5L};
  const Amplification trapezoidal = runge_kutta_amplification(a, b, 2);
  for (const double h : {0.01, 0.3, 1.4})
    for (const Amplification& amplification : {newmark, trapezoidal})
      expect_shown(shown_oscillation(amplification, 2, 0, h), 1, 2 * std::atan(h), 2, 0, h);
}

TEST(ShownOscillation, OfADampedOneIsThatOfTheRootsOfTheMap) {
  // zeta^2 - (2 - h gamma - h^2 kappa) zeta + 1 - h gamma of symplectic Euler.
  const double omega = 3, zeta = 0.1, gamma = 2 * zeta * omega;
  for (const double h : {0.01, 0.2, 0.5}) {
    const double radius = std::sqrt(1 - h * gamma),
                 angle = std::acos((2 - h * gamma - h * h * omega * omega) / (2 * radius));
    expect_shown(shown_oscillation(symplectic_euler_amplification(), omega, zeta, h), radius, angle, omega,
                 zeta, h);
  }
}

TEST(ShownOscillation, OfImplicitEulerIsDampedByTheStep) {
  // 1 / (1 - i omega h)
  constexpr std::array<long double, 1> one{1};
  const Amplification euler = runge_kutta_amplification(one, one, 1);
  for (const double h : {0.01, 0.2, 0.5})
    expect_shown(shown_oscillation(euler, 3, 0, h), 1 / std::hypot(1, 3 * h), std::atan(3 * h), 3, 0, h);
}

TEST(ShownOscillation, OfTheFlowItselfIsTheMode) {
  Amplification flow;
  flow.of_eigenmode = [](const Eigenmode& mode) {
    return Growth{.polynomial = {},
                  .radius = [mode](double h) { return std::abs(std::exp(h * mode.lambda)); }};
  };
  flow.R = [](Complex z) { return std::exp(z); };
  const double omega = 5, zeta = 0.3, h = 0.2;
  expect_shown(shown_oscillation(flow, omega, zeta, h), std::exp(-zeta * omega * h),
               omega * std::sqrt(1 - zeta * zeta) * h, omega, zeta, h);
  // Known by its radius alone.
  flow.R = {};
  const ShownOscillation shown = shown_oscillation(flow, omega, zeta, h);
  EXPECT_TRUE(std::isnan(shown.omega) && std::isnan(shown.zeta) && std::isnan(shown.period_error));
  EXPECT_NEAR(shown.spectral_radius, std::exp(-zeta * omega * h), 1e-15);
}

}  // namespace
}  // namespace hmax
