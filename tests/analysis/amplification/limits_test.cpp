#include "analysis/amplification/limits.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "analysis/amplification/multistep_amplification.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/methods/measured_amplification.hpp"
#include "integrators/multistep/adams_coefficients.hpp"
#include "tests/analysis/amplification/published_limits.hpp"

namespace hmax {
namespace {

StabilityLimits limits_of(std::string_view method) {
  return stability_limits(*find_formula(method).amplification);
}

void expect_limit(double found, double expected, const char* method, double tolerance = 1e-9) {
  if (std::isnan(expected)) return;
  if (std::isinf(expected))
    EXPECT_EQ(found, expected) << method;
  else
    EXPECT_NEAR(found, expected, tolerance) << method;
}

TEST(StabilityLimits, AreThePublishedOnes) {
  for (const PublishedLimit& row : published_limits) {
    const StabilityLimits limits = limits_of(row.method);
    expect_limit(limits.real, row.real, row.method);
    expect_limit(limits.imaginary, row.imaginary, row.method);
    expect_limit(limits.imaginary_weak, row.weak, row.method, 1e-4);
  }
}

TEST(StabilityLimits, OfAMethodUnstableFromTheOriginOnAreExactlyZero) {
  for (const char* method : {"explicit_euler", "rk2_heun", "adams_bashforth_2", "adams_bashforth_10",
                             "adams_moulton_12", "abm_pece_3", "rkc_2:stages=10", "bdf_3"})
    EXPECT_EQ(limits_of(method).imaginary, 0) << method;
}

TEST(StabilityLimits, OfThePairWithoutLastEvaluationAreThoseOfBashforthOneOrderHigher) {
  for (int k = 1; k < 12; ++k) {
    const StabilityLimits pec = stability_limits(adams_amplification(AdamsMode::pec, k, k + 1));
    const StabilityLimits bashforth = limits_of("adams_bashforth_" + std::to_string(k + 1));
    EXPECT_NEAR(pec.real, bashforth.real, 1e-9) << k;
    EXPECT_NEAR(pec.imaginary, bashforth.imaginary, 1e-9) << k;
  }
}

/// [hairer1996solving, V.1]: in closed form, 2 over the sum of weights with signs.
TEST(StabilityLimits, OfBashforthOnTheRealAxisComeFromTheRootMinusOne) {
  for (int k = 1; k <= 12; ++k) {
    std::vector<long double> w(static_cast<std::size_t>(k));
    static constexpr auto gamma = adams::gamma<12>();
    adams::weights_of_values<long double>(std::span(gamma).first(static_cast<std::size_t>(k)), w);
    long double alternating = 0;
    for (std::size_t i = 0; i < w.size(); ++i) alternating += (i % 2 == 0 ? w[i] : -w[i]);
    EXPECT_NEAR(limits_of("adams_bashforth_" + std::to_string(k)).real, static_cast<double>(2 / alternating),
                1e-9);
  }
}

TEST(StabilityLimits, OfThePairOfOrderTwelveStopAtTheFirstExitAndListTheLobeBehindIt) {
  const StabilityLimits limits = limits_of("adams_pece:order=12");
  EXPECT_NEAR(limits.real, 0.0617, 1e-4);
  ASSERT_EQ(limits.lobes.size(), 1u);
  EXPECT_FALSE(limits.lobes[0].imaginary);
  EXPECT_GT(limits.lobes[0].from, 0.1);
  EXPECT_LT(limits.lobes[0].from, 0.12);
  EXPECT_GT(limits.lobes[0].to, 0.15);
}

TEST(StabilityLimits, OfBackwardDifferentiationHaveThePublishedWedges) {
  for (const auto& [method, alpha] :
       {std::pair{"bdf_1", 90.0}, {"bdf_2", 90.0}, {"bdf_3", 86.03}, {"bdf_4", 73.35}, {"bdf_5", 51.84}}) {
    const StabilityLimits limits = limits_of(method);
    ASSERT_TRUE(limits.alpha_degrees) << method;
    EXPECT_NEAR(*limits.alpha_degrees, alpha, 0.006) << method;
    EXPECT_EQ(limits.a_stable, alpha == 90) << method;
    EXPECT_LT(limits.at_infinity.value(), 1e-12) << method;
  }
}

/// [sommeijer1998rkc]: about (2/3)(s^2 - 1)(1 - (2/15) eps); the Legendre methods reach (s^2 + s - 2) / 2 at
/// least.
TEST(StabilityLimits, OfStabilisedMethodsGrowWithTheSquareOfTheStages) {
  for (const int s : {2, 3, 5, 10, 20, 50}) {
    const double promised = 2.0 / 3 * (s * s - 1) * (1 - 2.0 / 15 * 2 / 13);
    const double real = limits_of("rkc_2:stages=" + std::to_string(s)).real;
    EXPECT_GE(real, promised) << s;
    EXPECT_LE(real, 1.2 * promised) << s;
  }
  for (const int s : {3, 5, 11, 51})
    EXPECT_GE(limits_of("rkl_2:stages=" + std::to_string(s)).real, (s * s + s - 2) / 2.0) << s;
}

TEST(StabilityLimits, AgreeWithWhatTheCatalogueSaysOfEveryMethod) {
  for (const Method& method : methods()) {
    if (!method.amplification || method.stages_by_radius) continue;
    const StabilityLimits limits = stability_limits(*method.amplification);
    EXPECT_EQ(limits.a_stable, method.a_stable) << method.id;
    EXPECT_EQ(limits.l_stable, method.l_stable) << method.id;
    EXPECT_TRUE(!method.is_explicit || std::isfinite(limits.real)) << method.id;
  }
}

/// R(z) = 1 / (1 - z + z^2/2 - z^3/6), the (0, 3) Pade approximation: A(88.23 degrees)-stable
/// [hairer1996solving, IV.4].
TEST(StabilityLimits, OfAOneStepRuleThatIsNotAStableAreAWedge) {
  const StepPolynomial in_z = StepPolynomial::real({{-1}, {1, -1, 0.5L, -1 / 6.0L}});
  Amplification pade;
  pade.in_z = in_z;
  pade.of_eigenmode = [in_z](const Eigenmode& mode) { return Growth{.polynomial = in_z.along(mode.lambda)}; };
  const StabilityLimits limits = stability_limits(pade);
  EXPECT_FALSE(limits.a_stable);
  EXPECT_FALSE(limits.l_stable);
  EXPECT_EQ(limits.real, no_limit);
  EXPECT_LT(limits.at_infinity.value(), 1e-12);
  EXPECT_NEAR(limits.alpha_degrees.value(), 88.23, 0.005);
}

TEST(Amplification, MeasuredAndDerivedAgreeForThePeersOfTheSameMethod) {
  const Method rk4 = find_method("rk4");
  const StabilityLimits derived = stability_limits(*rk4.amplification);
  const StabilityLimits measured = stability_limits(measured_amplification(rk4));
  EXPECT_NEAR(derived.real, measured.real, 1e-9);
  EXPECT_NEAR(derived.imaginary, measured.imaginary, 1e-6);
}

}  // namespace
}  // namespace hmax
