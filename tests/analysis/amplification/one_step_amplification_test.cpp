#include "analysis/amplification/one_step_amplification.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// The coefficients of R = 1 + z sum b_i S_i of Kutta's 3/8 rule with one third rounded to sixteen digits.
ComplexPolynomial numerator(double more_of_first_weight) {
  constexpr long double t = 0.3333333333333333;
  constexpr std::array<long double, 16> a{0, 0, 0, 0, t, 0, 0, 0, -t, 1, 0, 0, 1, -1, 1, 0};
  const std::array<long double, 4> b{0.125L + more_of_first_weight, 0.375L, 0.375L, 0.125L};
  ComplexPolynomial n = runge_kutta_amplification(a, b, 4).in_z.value().coefficients()[0];
  for (LongComplex& c : n) c = -c;
  return n;
}

TEST(OneStepAmplification, OfRoundedCoefficientsIsTheExponentialUpToTheOrder) {
  const ComplexPolynomial n = numerator(0);
  ASSERT_EQ(n.size(), 5U);
  long double factorial = 1;
  for (std::size_t j = 0; j < n.size(); ++j) {
    EXPECT_LE(std::abs(n[j] - 1 / factorial), 1e-19L) << j;
    factorial *= static_cast<long double>(j + 1);
  }
}

TEST(OneStepAmplification, OfAWrongCoefficientIsNotPutRight) {
  // R = 1 + (b_1 + b_2 + b_3 + b_4) z + ...
  EXPECT_NEAR(static_cast<double>(numerator(1e-8)[1].real() - 1), 1e-8, 1e-17);
}

}  // namespace
}  // namespace hmax
