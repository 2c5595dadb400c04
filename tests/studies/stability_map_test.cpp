#include "studies/stability_map.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string refusal_of_axis(std::string_view text, bool logarithmic = false) {
  return error_of<InputError>([&] { map_axis("--x", text, logarithmic); });
}

TEST(MapAxis, StepsEquallyOrInEqualRatiosAndEndsWhereItIsTold) {
  const MapAxis linear = map_axis("--x", "c=0:10:5", false);
  EXPECT_EQ(linear.name, "c");
  EXPECT_EQ(linear.values, (std::vector<double>{0, 2.5, 5, 7.5, 10}));
  const MapAxis ratios = map_axis("--x", "k1=0.1:10:3", true);
  EXPECT_NEAR(ratios.values[1], 1, 1e-15);
  EXPECT_EQ(ratios.values.back(), 10);
}

TEST(MapAxis, RefusesWhatIsNone) {
  for (const char* text : {"c", "c=1", "c=0:10", "=0:1:3", "c=0:10:81:2", "c=10:0:5", "c=0:0:5", "c=0:1:1",
                           "c=0:1:2.5", "c=0:nan:5", "c=0:inf:5", "c=a:b:c", "c=0:1:1e9"})
    EXPECT_TRUE(says(refusal_of_axis(text), "is no axis")) << text;
  EXPECT_TRUE(says(refusal_of_axis("c=0:1:3", true), "logarithmic"));
  EXPECT_EQ(refusal_of_axis("c=0:1:3"), "");
}

TEST(StabilityMap, OfExplicitEulerIsItsClosedForm) {
  const MapAxis x = map_axis("--x", "c=0:10:21", false), y = map_axis("--y", "k1=0.1:10:12", false);
  const std::vector<StabilityMap> maps =
      stability_maps({find_method("explicit_euler"), find_method("symplectic_euler"), find_method("newmark")},
                     over_parameters("liver_linear", {}, x, y), x, y);
  ASSERT_EQ(maps.size(), 3U);
  constexpr double m = 1.45;
  for (std::size_t row = 0; row < y.values.size(); ++row)
    for (std::size_t column = 0; column < x.values.size(); ++column) {
      const double c = x.values[column], k = y.values[row], gap = c * c - 4 * k * m;
      // docs/reference/facts.md
      const double euler = gap < 0 ? c / k : 4 * m / (c + std::sqrt(gap));
      const double symplectic = (std::sqrt(c * c + 4 * k * m) - c) / k;
      EXPECT_NEAR(maps[0].at(column, row), euler, 1e-9 * euler) << c << " " << k;
      EXPECT_NEAR(maps[1].at(column, row), symplectic, 1e-9 * symplectic) << c << " " << k;
      EXPECT_TRUE(std::isinf(maps[2].at(column, row)));
      // More damping lengthens the step of explicit Euler as long as the model swings, and shrinks it after.
      if (column + 1 < x.values.size() && std::abs(gap) > 12) {
        EXPECT_EQ(maps[0].falls_along_x(column, row), gap > 0) << c << " " << k;
      }
    }
  EXPECT_EQ(maps[1].falling_share_x(), 1);
  EXPECT_EQ(maps[2].falling_share_x(), 0);
}

TEST(StabilityMap, OfRayleighDampingIsThatOfTheDamperItMakes) {
  const MapAxis alpha = map_axis("--x", "alpha=0:2:3", false), beta = map_axis("--y", "beta=0:0.4:3", false);
  const ProblemSettings settings{.parameters = {{"k1", 3}}};
  const StabilityMap map = stability_maps({find_method("symplectic_euler")},
                                          over_rayleigh("liver_linear", settings), alpha, beta)[0];
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column) {
      const double c = alpha.values[column] * 1.45 + beta.values[row] * 3;
      EXPECT_NEAR(map.at(column, row), (std::sqrt(c * c + 4 * 3 * 1.45) - c) / 3, 1e-9);
    }
  EXPECT_THROW(over_rayleigh("van_der_pol", {}), InputError);
}

TEST(StabilityMap, HasNoNumberWhereTheModelItselfGrows) {
  const MapAxis x = map_axis("--x", "c=-1:1:3", false), y = map_axis("--y", "k1=1:2:2", false);
  const StabilityMap map =
      stability_maps({find_method("rk4")}, over_parameters("liver_linear", {}, x, y), x, y)[0];
  EXPECT_TRUE(std::isnan(map.at(0, 0)));
  EXPECT_GT(map.at(1, 0), 0);
  EXPECT_TRUE(says(map.note, "grows"));
}

TEST(StabilityMap, EndsWhenProgressThrows) {
  const MapAxis x = map_axis("--x", "c=0:1:3", false), y = map_axis("--y", "k1=1:2:2", false);
  EXPECT_THROW(stability_maps({find_method("rk4")}, over_parameters("liver_linear", {}, x, y), x, y,
                              [](double) { throw 1; }),
               int);
  EXPECT_THROW(over_parameters("liver_linear", {}, x, x), InputError);
}

}  // namespace
}  // namespace hmax
