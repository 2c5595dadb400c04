#include "core/instructions/cosines.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hmax
