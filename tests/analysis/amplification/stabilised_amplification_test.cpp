#include "analysis/amplification/stabilised_amplification.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// R_s(z) of RKC of order 2 on the real axis by Chebyshev polynomials [sommeijer1998rkc]:
///   R = 1 + b (T_s(w0 + w1 z) - T_s(w0)),   w1 = T_s'(w0) / T_s''(w0),   b = T_s''(w0) / T_s'(w0)^2,
/// with T_s(cosh u) = cosh s u.
double chebyshev(int s, double z) {
  const double w0 = 1 + 2 / (13.0 * s * s), u = std::acosh(w0), root = std::sqrt(w0 * w0 - 1);
  const auto T = [&](double x) { return x > 1 ? std::cosh(s * std::acosh(x)) : std::cos(s * std::acos(x)); };
  const double first = s * std::sinh(s * u) / root,
               second = (s * s * std::cosh(s * u) - w0 * first) / (root * root);
  const double w1 = first / second, b = second / (first * first);
  return 1 + b * (T(w0 + w1 * z) - T(w0));
}

TEST(StabilisedAmplification, TakesTheStagesOfEachStepWhateverWasAskedBefore) {
  const Growth growth = stabilised_amplification<Rkc2>().of_eigenmode(Eigenmode(-1.0));
  // The least s with 2/3 (s^2 - 1) (1 - 4/195) >= h, of steps that grow, shrink and stay.
  for (const auto& [h, s] :
       {std::pair{1.0, 2}, {10.0, 5}, {100.0, 13}, {101.0, 13}, {3.0, 3}, {1.0, 2}, {10.0, 5}})
    EXPECT_NEAR(growth.spectral_radius(h), std::abs(chebyshev(s, -h)), 1e-11) << h;
}

TEST(StabilisedAmplification, OfAGivenNumberOfStagesIsThatOfChebyshevPolynomials) {
  for (const int s : {2, 3, 5, 10, 40}) {
    const Growth growth = stabilised_amplification<Rkc2>(s).of_eigenmode(Eigenmode(-1.0));
    for (const double share : {0.01, 0.3, 0.77, 1.0}) {
      const double h = share * 0.65 * (s * s - 1);
      EXPECT_NEAR(growth.spectral_radius(h), std::abs(chebyshev(s, -h)), 1e-10) << s << ' ' << h;
    }
  }
}

// With thousands of stages an evaluation takes long: what decays slowly beside a fast mode leaves where the
// most stages end, and is looked for there.
TEST(StabilisedAmplification, FindsTheExitOfASlowDecayBesideAFastModeInFewLooks) {
  const double alone = first_exit(stabilised_amplification<Rkc2>().of_eigenmode(Eigenmode(-1.0)));
  Eigenmode slow(-1.0);
  slow.radius = 1e5;
  Growth growth = stabilised_amplification<Rkc2>().of_eigenmode(slow);
  int looks = 0;
  growth.radius = [&looks, radius = growth.radius](double h) {
    ++looks;
    return radius(h);
  };
  EXPECT_NEAR(first_exit(growth), alone, 1e-9 * alone);
  EXPECT_LT(looks, 300);
  const int most = most_stabilized_stages<double>();
  EXPECT_NEAR(alone, Rkc2::reach<double>(most), 1e-3 * alone);
}

}  // namespace
}  // namespace hmax
