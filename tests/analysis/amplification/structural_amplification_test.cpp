#include "analysis/amplification/structural_amplification.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

Amplification newmark(long double beta, long double gamma) {
  return generalized_alpha_amplification(newmark_parameters(beta, gamma));
}

TEST(StructuralAmplification, IsStableAtTheEigenvaluesInsideOfItsClosedRegion) {
  struct Region {
    std::string name;
    Amplification amplification;
    std::function<double(Complex)> inside;  // > 0, with h gamma = -2 Re z and h^2 kappa = |z|^2
  };
  const std::vector<Region> regions{
      {"symplectic_euler", symplectic_euler_amplification(),
       [](Complex z) { return 4 + 4 * z.real() - std::norm(z); }},
      {"velocity_verlet", kick_drift_kick_amplification(KickDamping::half_step),
       [](Complex z) { return 4 + 4 * z.real() - std::norm(z); }},
      {"stormer_verlet", kick_drift_kick_amplification(KickDamping::predicted),
       [](Complex z) { return 4 + 8 * z.real() - std::norm(z); }},
      {"central_difference", kick_drift_kick_amplification(KickDamping::lumped),
       [](Complex z) { return 4 - std::norm(z); }},
      {"explicit_newmark", newmark(0, 0.5L), [](Complex z) { return 4 - std::norm(z); }},
      {"newmark", newmark(0.25L, 0.5L), [](Complex) { return 1.0; }},
      {"newmark 1/12", newmark(1 / 12.0L, 0.5L), [](Complex z) { return 6 - std::norm(z); }}};
  for (const Region& region : regions) {
    int in = 0, out = 0;
    for (double x = -4; x < 0; x += 0.093)
      for (double y = 0.05; y < 4; y += 0.087) {
        const double inside = region.inside({x, y});
        if (std::abs(inside) < 1e-3) continue;
        ++(inside > 0 ? in : out);
        EXPECT_EQ(region.amplification.stable_at({x, y}), inside > 0)
            << region.name << " at " << Complex(x, y);
        EXPECT_FALSE(region.amplification.stable_at({-x, y})) << region.name << " at " << Complex(-x, y);
      }
    EXPECT_GT(in, 40) << region.name;
    EXPECT_EQ(out > 40, region.name != "newmark") << region.name;
  }
}

/// Unstable at large steps of oscillations q'' + gamma q' + q = 0 whose gamma is in a range, stable
/// elsewhere.
Amplification unstable_where(double from, double to) {
  Amplification made;
  made.of_oscillation = [=, stable = newmark(0.25L, 0.5L),
                         unstable = symplectic_euler_amplification()](const MechanicalMode& mode) {
    return (mode.gamma >= from && mode.gamma <= to ? unstable : stable).of_oscillation(mode);
  };
  return made;
}

TEST(StructuralAmplification, IsUnconditionallyStableOnlyIfItIsForEveryDamping) {
  EXPECT_TRUE(is_unconditionally_stable(newmark(0.25L, 0.5L)));
  EXPECT_TRUE(is_unconditionally_stable(unstable_where(1e3, 1e9)));
  EXPECT_FALSE(is_unconditionally_stable(unstable_where(0, 0)));        // undamped alone
  EXPECT_FALSE(is_unconditionally_stable(unstable_where(1e-3, 4e-3)));  // a thousandth of critical damping
  EXPECT_FALSE(is_unconditionally_stable(unstable_where(1.9, 2.1)));    // critical damping
  EXPECT_FALSE(is_unconditionally_stable(unstable_where(10, 30)));      // ten times critical damping
  EXPECT_FALSE(is_unconditionally_stable(newmark(0.24L, 0.5L)));        // 2 beta < gamma
  EXPECT_FALSE(is_unconditionally_stable(newmark(0.25L, 0.49L)));       // gamma < 1/2
}

TEST(StructuralAmplification, OfAnInfinitelyFastModeIsThatOfRhoInfinity) {
  for (const double rho : {0.0, 0.2, 0.8, 1.0}) {
    const Amplification made = generalized_alpha_amplification(generalized_alpha_parameters(rho));
    EXPECT_EQ(annihilates_fast_modes(made), rho == 0) << rho;
    EXPECT_NEAR(made.of_oscillation({.kappa = 1, .gamma = 0}).polynomial.value().radius_at_infinity(), rho,
                1e-6)
        << rho;
  }
}

}  // namespace
}  // namespace hmax
