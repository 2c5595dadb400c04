#include "core/instructions/cosines.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/instructions/cosine.hpp"
#include "core/instructions/single_powers.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

void expect_the_bits_of_cos(const std::vector<double>& x) {
  for (const InstructionSet set : instruction_sets()) {
    std::vector<double> found(x.size());
    cosines(x, found, set);
    for (std::size_t i = 0; i < x.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(found[i]), std::bit_cast<std::uint64_t>(std::cos(x[i])))
          << to_string(set) << " " << x[i];
  }
  if (!cosines_are_those_of_musl()) return;
  for (const double each : x)
    if (std::abs(each) < cosine_parts::far_angle) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(cosine(each)), std::bit_cast<std::uint64_t>(std::cos(each)))
          << each;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(sine(each)), std::bit_cast<std::uint64_t>(std::sin(each)))
          << each;
    }
}

TEST(Cosines, HaveTheBitsOfCosOverManyPeriods) {
  std::mt19937_64 random(7);
  for (const double most : {1e-9, 1e-3, 0.8, 6.3, 40.0, 1e6}) {
    std::uniform_real_distribution<double> number(-most, most);
    std::vector<double> x(4999);
    for (double& each : x) each = number(random);
    expect_the_bits_of_cos(x);
  }
}

/// Multiples of pi/4, where the reduction cancels or decides between two quadrants, and their neighbours.
TEST(Cosines, HaveTheBitsOfCosAtEighthsOfAPeriod) {
  std::vector<double> x;
  for (int eighth = -50; eighth <= 50; ++eighth)
    for (int power = -60; power <= -6; ++power)
      for (const double side : {-1.0, 0.0, 1.0})
        x.push_back(eighth * std::numbers::pi / 4 + side * std::ldexp(1.3, power));
  expect_the_bits_of_cos(x);
}

/// The doubles next to multiples of pi/2 and of pi/4, where most digits cancel, up to far angles and beyond.
TEST(Cosines, HaveTheBitsOfCosNextToMultiplesOfAQuarterPi) {
  std::vector<double> x;
  std::mt19937_64 random(8);
  std::uniform_int_distribution<int> number(1, 2'200'000);
  for (int count = 0; count < 40'000; ++count) {
    const int eighth = count < 200 ? count : number(random);
    double each = static_cast<double>(eighth * (std::numbers::pi_v<long double> / 4));
    for (int step = 0; step < 3; ++step) {
      x.push_back(each);
      each = std::nextafter(each, infinity);
    }
  }
  x.push_back(cosine_parts::far_angle);
  x.push_back(std::nextafter(cosine_parts::far_angle, 0.0));
  expect_the_bits_of_cos(x);
}

TEST(Cosines, HaveTheBitsOfCosOfWhatIsNoAngle) {
  expect_the_bits_of_cos({0.0, -0.0, 5e-324, -1e-310, 1e22, -1e300, std::numeric_limits<double>::max()});
  for (const double x : {infinity, -infinity, std::nan("")}) {
    std::vector<double> found{1, x, 1};
    cosines(found, found);
    EXPECT_TRUE(std::isnan(found[1]));
    EXPECT_EQ(found[0], std::cos(1.0));
    EXPECT_EQ(found[2], std::cos(1.0));
  }
  expect_the_bits_of_cos({});
}

/// Every 997th float of the range, by its bits.
TEST(SinglePowers, HaveTheBitsOfTheFunctionsOfMusl) {
  if (!cosines_are_those_of_musl()) GTEST_SKIP() << "this build has other elementary functions";
  for (std::uint32_t bits = 0x00800000; bits < 0x7f800000; bits += 997) {
    const auto x = std::bit_cast<float>(bits);
    ASSERT_EQ(std::bit_cast<std::uint32_t>(single_log2(x)), std::bit_cast<std::uint32_t>(std::log2(x))) << x;
    if (x >= 126) continue;
    for (const float y : {x, -x})
      ASSERT_EQ(std::bit_cast<std::uint32_t>(single_exp2(y)), std::bit_cast<std::uint32_t>(std::exp2(y)))
          << y;
  }
  EXPECT_EQ(std::bit_cast<std::uint32_t>(single_log2(1.0F)), 0U);
}

}  // namespace
}  // namespace hmax
