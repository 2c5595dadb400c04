#include "bench/timing/formula_reference.hpp"

#include <cmath>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>

#include "problems/formula_system.hpp"

namespace hmax {
namespace {

FormulaReference decay(double t_end) {
  const FormulaSystem system(
      FormulaDefinition{.name = "decay", .equations = {{"y", "-y"}}, .y0 = {1}, .t_end = t_end});
  return {AnySystem(system), system.y0(), t_end};
}

TEST(FormulaReference, OfExponentialDecayIsWithinItsBound) {
  const FormulaReference reference = decay(10);
  EXPECT_LT(reference.error_bound(), 1e-9);
  EXPECT_NEAR(reference.valid_until(), 10, 1e-12);
  // 0.0137 s is no multiple of the distance of two grid points: most points lie between them.
  for (int i = 0; 0.0137 * i < 10; ++i) {
    const double t = 0.0137 * i;
    ASSERT_EQ(reference.at(t).size(), 1);
    EXPECT_NEAR(reference.at(t)[0], std::exp(-t), reference.error_bound()) << t;
  }
}

TEST(FormulaReference, IsLeftWhereItsWatchThrows) {
  struct Enough {};
  const FormulaSystem system(
      FormulaDefinition{.name = "decay", .equations = {{"y", "-y"}}, .y0 = {1}, .t_end = 1});
  const auto watch = [] { throw Enough{}; };
  EXPECT_THROW(FormulaReference(AnySystem(system), system.y0(), 1, watch), Enough);
}

TEST(FormulaReference, IsAsExactInAnyUnitOfItsStates) {
  // x'' = -x - k x^3 from x = 1 / sqrt(k) is one motion in units of 1 / sqrt(k); from x = v = 0 with a force
  // of that size another.
  for (const double pushed : {0, 1}) {
    const auto reference_in = [&](double unit) {
      const FormulaSystem system(
          FormulaDefinition{.name = "spring",
                            .equations = {{"x", "v"}, {"v", "f - x - k*x^3"}},
                            .parameters = {{"k", 1 / (unit * unit)}, {"f", pushed * unit}},
                            .y0 = {(1 - pushed) * unit, 0}});
      return FormulaReference(AnySystem(system), system.y0(), 50);
    };
    const FormulaReference plain = reference_in(1);
    for (const double unit : {1e-9, 1e6}) {
      const FormulaReference scaled = reference_in(unit);
      EXPECT_LT(scaled.error_bound(), 1e-9 * unit);
      for (const double t : {3.17, 20.0, 49.99})
        for (const int i : {0, 1})
          EXPECT_NEAR(scaled.at(t)[i] / unit, plain.at(t)[i], 1e-9) << unit << " " << t;
    }
  }
}

TEST(FormulaReference, KeepsASmallStateBesideALargeOneOfAnotherUnit) {
  const FormulaSystem system(
      FormulaDefinition{.name = "pressed",
                        .equations = {{"p", "-0.01*(p - 101000)"}, {"x", "v"}, {"v", "-w^2*x"}},
                        .parameters = {{"w", 125}},
                        .y0 = {101325, 1e-6, 0}});
  const FormulaReference reference(AnySystem(system), system.y0(), 1);
  for (const double t : {0.3, 0.77, 1.0})
    EXPECT_NEAR(reference.at(t)[1], 1e-6 * std::cos(125 * t), 1e-11) << t;
}

TEST(FormulaReference, IsNaNOutsideItsInterval) {
  const FormulaReference reference = decay(1);
  EXPECT_FALSE(std::isnan(reference.at(0)[0]));
  for (const double t : {-0.001, 1.001, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_TRUE(std::isnan(reference.at(t)[0])) << t;
}

TEST(FormulaReference, EndsBeforeTheSolutionBlowsUp) {
  // y' = y^2, y(0) = 1: y = 1 / (1 - t).
  const FormulaSystem system(FormulaDefinition{.name = "blow_up", .equations = {{"y", "y^2"}}, .y0 = {1}});
  const FormulaReference reference(AnySystem(system), system.y0(), 3);
  EXPECT_LE(reference.valid_until(), 1);
  EXPECT_NEAR(reference.at(0.5)[0], 2, 1e-9);
  EXPECT_GT(reference.valid_until(), 0.99);
  EXPECT_TRUE(std::isnan(reference.at(1.5)[0]));
}

TEST(FormulaReference, EndsBeforeAPoleThatIsAGridPoint) {
  // y' = y^2, y(0) = 1 has its pole at t = 1; y' = 1 + y^2, y(0) = 0 is tan t.
  const double pi = std::acos(-1.0);
  for (const auto& [formula, y0, pole] : {std::tuple{"y^2", 1.0, 1.0}, std::tuple{"1 + y^2", 0.0, pi / 2}})
    for (const int multiple : {1, 2, 4}) {
      SCOPED_TRACE(multiple);
      const FormulaSystem system(
          FormulaDefinition{.name = "pole", .equations = {{"y", formula}}, .y0 = {y0}});
      const double t_end = multiple * pole;
      const FormulaReference reference(AnySystem(system), system.y0(), t_end);
      EXPECT_LT(reference.valid_until(), pole * (1 - 1e-9)) << formula;
      EXPECT_GT(reference.valid_until(), pole - 3 * t_end / 2000) << formula;
      const double last = reference.valid_until();
      const double exact = pole == 1 ? 1 / (1 - last) : std::tan(last);
      EXPECT_NEAR(reference.at(last)[0] / exact, 1, 1e-6) << formula;
    }
}

}  // namespace
}  // namespace hmax
