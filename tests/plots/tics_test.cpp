#include "plots/tics.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

std::string linear(double low, double high, double length) {
  const std::string text = tics('x', {}, {low, high}, length), before = "nomirror ";
  const std::size_t at = text.find(before) + before.size();
  return text.substr(at, text.find('\n', at) - at);
}

TEST(Tics, OfALinearAxisAreTheClosestWhoseLabelsHaveRoom) {
  // A label takes 6.8 pixels a character, and 12 beside it.
  EXPECT_EQ(linear(95, 100, 300), "1");    // 60 pixels for three characters; 0.5 has 30 for four
  EXPECT_EQ(linear(95, 100, 500), "0.5");  // 50 pixels for four
  EXPECT_EQ(linear(8, 10, 44), "2");       // 22 pixels are too few for the 10
  EXPECT_EQ(linear(7, 9, 44), "1");
  EXPECT_EQ(linear(-100, -95, 300), "1");
}

TEST(Tics, OfALinearAxisReachBeyondItsEndByHalfALabel) {
  EXPECT_NEAR(overhang({}, {-0.00015, 0.00015}, 700), 3.4 * 7, 1e-9);  // 0.00015 at the very end
  EXPECT_NEAR(overhang({}, {-0.0003, -0.0001}, 700), 3.4 * 7, 1e-9);
  EXPECT_EQ(overhang({}, {0, 1.08}, 700), 0);  // 1 is 52 pixels before it
  EXPECT_EQ(overhang({.logarithmic = true}, {1, 1000}, 800), 0);
}

TEST(Tics, OfALogarithmicAxisIncludeItsEnds) {
  EXPECT_EQ(tics('x', {.logarithmic = true}, {1, 1000}, 800),
            "set xtics out scale 0.5 nomirror ('10^{0}' 1e0, '10^{1}' 1e1, '10^{2}' 1e2, '10^{3}' 1e3)\n");
  // A short one in equal steps: from 12 to 13 there are 70 pixels, from 13 to 13.5 33.
  EXPECT_EQ(tics('x', {.logarithmic = true}, {0.011, 0.0139}, 206),
            "set xtics out scale 0.5 nomirror ('0.011' 0.011, '0.012' 0.012, '0.013' 0.013)\n");
}

}  // namespace
}  // namespace hmax
