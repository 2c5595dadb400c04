#include "studies/organ_material.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// With free sides: sigma = E e of small strain; S = E (e + e^2 / 2) and P = (1 + e) S of Green's strain,
/// whatever nu is; (exp(5 e) - 1) E / 5 of exponential springs.
TEST(StressCurves, OfBarsHaveTheirClosedForms) {
  const double E = 5300;
  for (const double nu : {0.3, 0.45}) {
    const std::vector<StressCurve> curves = stress_curves(E, nu);
    ASSERT_EQ(curves.size(), 5U);
    for (std::size_t i = 0; i < curves[0].strain.size(); ++i) {
      const double e = curves[0].strain[i];
      EXPECT_NEAR(curves[0].stress[i], E * e, 1e-6 * E) << e;
      EXPECT_NEAR(curves[1].stress[i], E * (1 + e) * (e + e * e / 2), 1e-6 * E) << e;
      EXPECT_NEAR(curves[2].stress[i], E * e, 1e-6 * E) << e;  // nothing turns
      EXPECT_NEAR(curves[4].stress[i], E * std::expm1(5 * e) / 5, 1e-6 * E) << e;
    }
    // The neo-Hookean law has the same slope at rest.
    const auto& law = curves[3];
    for (std::size_t i = 1; i + 1 < law.strain.size(); ++i)
      if (std::abs(law.strain[i]) < 1e-9) {
        EXPECT_NEAR((law.stress[i + 1] - law.stress[i - 1]) / (law.strain[i + 1] - law.strain[i - 1]), E,
                    0.02 * E);
      }
  }
}

TEST(SkinEffects, StiffenABodyAndShortenItsSteps) {
  const SkinEffect effect = skin_effect("phantom", "male_normal");
  EXPECT_LT(effect.skinned, 0.9 * effect.bare);
  EXPECT_LT(effect.h_skinned, 0.9 * effect.h_bare);
}

}  // namespace
}  // namespace hmax
