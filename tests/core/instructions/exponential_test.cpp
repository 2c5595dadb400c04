#include "core/instructions/exponential.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/instructions/cosines.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

/// Numbers of all sizes, and those next to where the reduction takes another power of two.
std::vector<double> numbers() {
  std::vector<double> all;
  std::mt19937_64 random(3);
  for (const double most : {1e-300, 1e-20, 1e-9, 1e-3, 0.36, 0.7, 1.1, 2.0, 40.0, 60.0, 708.0}) {
    std::uniform_real_distribution<double> number(-most, most);
    for (int n = 0; n < 20'000; ++n) all.push_back(number(random));
  }
  for (int half = -140; half <= 140; ++half)
    for (int power = -60; power <= -6; ++power)
      for (const double side : {-1.0, 0.0, 1.0})
        all.push_back(half * std::numbers::ln2 / 2 + side * std::ldexp(1.3, power));
  return all;
}

/// The error of a finite number in units of its last digit.
double error(double found, long double exact) {
  const double size = std::abs(static_cast<double>(exact));
  return static_cast<double>(std::abs(found - exact) / (std::nextafter(size, infinity) - size));
}

TEST(Exponential, ErrsByLessThanAUnitOfTheLastDigit) {
  double worst_less_one = 0, worst = 0;
  for (const double x : numbers()) {
    if (x != 0)
      worst_less_one =
          std::max(worst_less_one, error(exponential_less_one(x), std::expm1(static_cast<long double>(x))));
    worst = std::max(worst, error(exponential(x), std::exp(static_cast<long double>(x))));
  }
  EXPECT_LT(worst_less_one, 0.9);
  EXPECT_LT(worst, 0.8);
}

TEST(Exponential, HasAtItsEndsWhatTheSeriesHas) {
  EXPECT_EQ(exponential_less_one(infinity), infinity);
  EXPECT_EQ(exponential(infinity), infinity);
  EXPECT_EQ(exponential_less_one(-infinity), -1);
  EXPECT_EQ(exponential(-infinity), 0);
  EXPECT_TRUE(std::isnan(exponential_less_one(std::nan(""))));
  EXPECT_TRUE(std::isnan(exponential(std::nan(""))));
  EXPECT_TRUE(std::signbit(exponential_less_one(-0.0)));
  EXPECT_EQ(exponential(0), 1);
  EXPECT_TRUE(std::isfinite(exponential(exponential_parts::most)));
  EXPECT_EQ(exponential(std::nextafter(exponential_parts::most, infinity)), infinity);
  EXPECT_TRUE(std::isnormal(exponential(exponential_parts::least)));
  EXPECT_EQ(exponential(std::nextafter(exponential_parts::least, -infinity)), 0);
  EXPECT_EQ(exponential_less_one(5e-324), 5e-324);
}

TEST(Exponential, LessOneHasTheBitsOfMusl) {
  if (!cosines_are_those_of_musl()) GTEST_SKIP() << "this build has other elementary functions";
  for (const double x : numbers())
    ASSERT_EQ(std::bit_cast<std::uint64_t>(exponential_less_one(x)),
              std::bit_cast<std::uint64_t>(std::expm1(x)))
        << x;
}

}  // namespace
}  // namespace hmax
