#include "analysis/amplification/region.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "catalogue/methods/choice/formulas.hpp"

namespace hmax {
namespace {

std::vector<RegionCurve> curves_of(const char* method, int cells = 200) {
  const auto amplification = find_formula(method).amplification;
  return region_boundary(stable_at(*amplification), window_of(*amplification), cells);
}

TEST(RegionBoundary, OfExplicitEulerIsTheUnitCircleAroundMinusOne) {
  const auto curves = curves_of("explicit_euler");
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_FALSE(curves[0].clipped);
  for (const Complex z : curves[0].points) EXPECT_NEAR(std::abs(z + 1.0), 1, 1e-8);
  EXPECT_NEAR(curves[0].area(), std::numbers::pi, 1e-3);
}

TEST(RegionBoundary, OfImplicitEulerIsAHoleAroundOne) {
  const auto curves = curves_of("implicit_euler");
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_TRUE(curves[0].clipped);
  EXPECT_FALSE(curves[1].clipped);
  for (const Complex z : curves[1].points) EXPECT_NEAR(std::abs(z - 1.0), 1, 1e-8);
  EXPECT_NEAR(curves[1].area(), -std::numbers::pi, 1e-3);
}

TEST(RegionBoundary, OfDormandPrinceHasTwoLobesBesideItsBody) {
  const auto curves = curves_of("dormand_prince_54", 400);
  ASSERT_EQ(curves.size(), 3u);
  EXPECT_NEAR(curves[1].area(), curves[2].area(), 1e-9);
  EXPECT_GT(curves[1].area(), 0);
}

TEST(RegionBoundary, LiesWhereTheSpectralRadiusIsOne) {
  for (const char* method : {"rk4", "adams_bashforth_3", "abm_pece_4", "bdf_4", "rosenbrock_23",
                             "rkc_2:stages=5", "newmark:beta=0.1,gamma=0.5"}) {
    const auto amplification = find_formula(method).amplification;
    for (const RegionCurve& curve : curves_of(method)) {
      if (curve.clipped) continue;
      for (const Complex z : curve.points)
        EXPECT_NEAR(amplification->spectral_radius(z), 1, 2e-4) << method << " " << z;
    }
  }
}

TEST(RegionBoundary, TellsAtEveryEdgeThatItIsClipped) {
  // Half a disc in the middle of one edge each.
  const PlaneWindow window{-1, 1, -1, 1.5};
  for (const Complex middle : {Complex(-1, 0.25), Complex(1, 0.25), Complex(0, -1), Complex(0, 1.5)}) {
    const auto curves = region_boundary([&](Complex z) { return std::abs(z - middle) <= 0.5; }, window, 200);
    ASSERT_EQ(curves.size(), 1U) << middle;
    EXPECT_TRUE(curves[0].clipped) << middle;
    EXPECT_NEAR(curves[0].area(), std::numbers::pi / 8, 1e-3) << middle;
  }
}

TEST(RegionBoundary, ClosesWhatLeavesTheWindowAlongItsEdge) {
  const auto curves = region_boundary([](Complex z) { return z.real() <= 0; }, {-1, 1, -1, 1}, 10);
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_TRUE(curves[0].clipped);
  EXPECT_NEAR(curves[0].area(), 2, 1e-6);
}

TEST(RegionBoundary, SeparatesWhatTouchesOnlyAtACorner) {
  // Two quadrants: four crossings meet in the middle.
  const auto curves =
      region_boundary([](Complex z) { return z.real() * z.imag() > 0; }, {-1, 1, -1.1, 0.9}, 20);
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_NEAR(curves[0].area(), 1.1, 0.02);
  EXPECT_NEAR(curves[1].area(), 0.9, 0.02);
}

TEST(RegionBoundary, RefusesWindowsThatAreNone) {
  const auto all = [](Complex) { return true; };
  EXPECT_THROW(region_boundary(all, {1, 0, 0, 1}, 10), std::invalid_argument);
  EXPECT_THROW(region_boundary(all, {0, 0, 0, 1}, 10), std::invalid_argument);
  EXPECT_THROW(region_boundary(all, {0, 1, 2, 2}, 10), std::invalid_argument);
  EXPECT_THROW(region_boundary(all, {0, NAN, 0, 1}, 10), std::invalid_argument);
  EXPECT_THROW(region_boundary(all, {0, 1, 0, 1}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
