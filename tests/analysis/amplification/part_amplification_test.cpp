#include "analysis/amplification/part_amplification.hpp"

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"

namespace hmax {
namespace {

/// Implicit-explicit Euler: y1 = y0 + z_slow y0 + z_fast y1, so that R = (1 + z_slow) / (1 - z_fast).
TEST(PartAmplification, OfImplicitExplicitEulerBesideAStiffPart) {
  const auto pair = find_method("imex_euler").amplification;
  for (const Complex fast : {Complex(0), Complex(-3), Complex(0, 2)}) {
    const SlowPolynomial R = in_slow(*pair, fast);
    ASSERT_EQ(R.size(), 2U) << fast;
    for (const Complex c : R) EXPECT_LT(std::abs(c - 1.0 / (1.0 - fast)), 1e-14) << fast;
    const Amplification beside = beside_stiff(pair, fast);
    const double reach = std::abs(1.0 - fast);
    EXPECT_TRUE(beside.stable_at(-1.0 + 0.999 * reach));
    EXPECT_FALSE(beside.stable_at(-1.0 + 1.001 * reach));
  }
}

/// Linearly implicit Euler with J = lambda / ratio: R = 1 + z / (1 - z / ratio), which reaches -1 at
/// z = -2 / (1 - 2 / ratio) where ratio > 2, and nowhere else on the negative axis.
TEST(PartAmplification, OfLinearlyImplicitEulerWithAnOldJacobian) {
  const auto method = find_method("linearly_implicit_euler").amplification;
  const Amplification of_four = with_old_jacobian(method, 4);
  EXPECT_TRUE(of_four.stable_at(-3.999));
  EXPECT_FALSE(of_four.stable_at(-4.001));
  EXPECT_TRUE(with_old_jacobian(method, 1.5).stable_at(-1e4));
}

}  // namespace
}  // namespace hmax
