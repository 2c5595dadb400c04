#include "core/numbers.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(Numbers, AreWrittenWithTheFewestDigitsThatReadBack) {
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(-0.0), "-0");
  EXPECT_EQ(to_text(1e22), "1e+22");
  EXPECT_EQ(to_text(-std::nan("")), "nan");
  EXPECT_EQ(to_text(infinity) + " " + to_text(-infinity), "inf -inf");
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-300, 300);
  for (int i = 0; i < 1000; ++i) {
    const double x = std::pow(10, exponent(random)) * (i % 2 == 0 ? 1 : -1);
    EXPECT_EQ(to_number(to_text(x)), x);
  }
  // The longest: 17 digits, a sign and an exponent of three digits.
  EXPECT_EQ(to_text(-2.2250738585072014e-308), "-2.2250738585072014e-308");
}

TEST(Numbers, AreRoundedForPeople) {
  EXPECT_EQ(rounded_text(2212.4, 3), "2210");
  EXPECT_EQ(rounded_text(999'999, 3), "1e+06");
  EXPECT_EQ(rounded_text(-123'456, 2), "-120000");
  EXPECT_EQ(rounded_text(0.00012345, 3), "0.000123");
  EXPECT_EQ(short_number(-0.0), "0");
  EXPECT_EQ(short_number(infinity) + " " + short_number(-infinity) + " " + short_number(std::nan("")),
            "infinite -infinite undefined");
  EXPECT_EQ(millimetres(0.0086612), "8.66 mm");
}

TEST(Numbers, AreReadWholeOrNotAtAll) {
  EXPECT_EQ(to_number(" +1.5D+3\t"), 1500.0);
  EXPECT_EQ(to_number("-2d-1"), -0.2);
  EXPECT_EQ(to_number("inf"), infinity);
  for (const char* text : {"", "  ", "1 2", "1.5x", "+-1", "++1", "d", "1e999", "0x10"})
    EXPECT_FALSE(to_number(text)) << text;
}

}  // namespace
}  // namespace hmax
