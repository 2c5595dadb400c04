#include "problems/formula_system.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "integrators/system.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {
namespace {

static_assert(System<FormulaSystem>);
static_assert(!DifferentiableSystem<FormulaSystem>);

FormulaDefinition liver() {
  return {.name = "liver",
          .equations = {{"x", "v"}, {"v", "(P*cos(w*t) - c*v - k1*x - k3*x^3)/m"}},
          .parameters = {{"m", 1.45}, {"c", 2}, {"k1", 0.7}, {"k3", 0.8}, {"P", 0.5}, {"w", 0.5}},
          .y0 = {0.5, 1}};
}

/// One equation x' = formula with a parameter a = 2, started at x = 3, t = 5.
FormulaDefinition single(const std::string& formula) {
  return {.name = "single", .equations = {{"x", formula}}, .parameters = {{"a", 2}}, .y0 = {3}, .t0 = 5};
}

double value(const std::string& formula) {
  const FormulaSystem system(single(formula));
  Eigen::VectorXd dydt(1);
  system.rhs(5, system.y0(), dydt);
  return dydt[0];
}

std::string refusal(const FormulaDefinition& definition) {
  try {
    const FormulaSystem system(definition);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal(const std::string& formula) { return refusal(single(formula)); }

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST(FormulaSystem, EqualsTheOscillatorOnRandomStates) {
  const FormulaSystem formulas(liver());
  const Oscillator oscillator;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-4, 4);
  Eigen::VectorXd dydt(2);
  Eigen::Vector2d expected;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d y(uniform(random), uniform(random));
    const double t = 20 * uniform(random);
    formulas.rhs(t, y, dydt);
    oscillator.rhs(t, y, expected);
    ASSERT_LT((dydt - expected).norm(), 4e-15 * (1 + expected.norm()));
  }
}

TEST(FormulaSystem, OperatorsAndFunctionsMeanWhatMathematicsMeans) {
  EXPECT_EQ(value("a + x * t"), 17);
  EXPECT_EQ(value("-x^2"), -9);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("7/2"), 3.5);
  EXPECT_EQ(value("10^10"), 1e10);
  EXPECT_EQ(value("x^40"), std::pow(3.0, 40));
  EXPECT_EQ(value("2^-1"), 0.5);
  EXPECT_EQ(value("(-2)^3"), -8);
  EXPECT_EQ(value("1.5e-3*2"), 3e-3);
  EXPECT_EQ(value("x > a ? 10 : 20"), 10);
  EXPECT_EQ(value("x == 3 && a != 3 ? 1 : 0"), 1);
  EXPECT_EQ(value("min(x, a) + max(1, 4)"), 6);
  EXPECT_DOUBLE_EQ(value("ln(e) + log(e) + sin(pi/2)"), 3);
  EXPECT_DOUBLE_EQ(value("atan2(1, -1)"), std::atan2(1.0, -1.0));
  EXPECT_DOUBLE_EQ(value("sign(-x) * abs(-x) + sqrt(16) + exp(0) + log10(100) + log2(8)"), 7);
}

TEST(FormulaSystem, SettingAParameterChangesThisCopyOnly) {
  FormulaSystem system(single("a*x"));
  const FormulaSystem before = system;
  system.set("a", 7);
  Eigen::VectorXd dydt(1);
  system.rhs(0, system.y0(), dydt);
  EXPECT_EQ(dydt[0], 21);
  EXPECT_EQ(system.definition().parameters[0].second, 7);
  before.rhs(0, system.y0(), dydt);
  EXPECT_EQ(dydt[0], 6);
  FormulaSystem assigned = before;
  assigned = system;
  assigned.rhs(0, system.y0(), dydt);
  EXPECT_EQ(dydt[0], 21);
}

TEST(FormulaSystem, SettingRefusesUnknownNamesAndNumbersThatAreNotFinite) {
  FormulaSystem system(liver());
  EXPECT_THROW(system.set("c", std::nan("")), std::invalid_argument);
  try {
    system.set("k4", 1);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_SAYS(std::string(error.what()), "did you mean 'k1'?");
  }
}

TEST(FormulaSystem, CopiesServeThreadsOfTheirOwn) {
  const FormulaSystem original(liver());
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t n = 0; n < wrong.size(); ++n)
    threads.emplace_back([&original, &wrong, n] {
      const FormulaSystem mine = original;
      const Oscillator oscillator;
      Eigen::VectorXd dydt(2);
      Eigen::Vector2d expected;
      for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector2d y(0.01 * i, static_cast<double>(n));
        mine.rhs(i, y, dydt);
        oscillator.rhs(i, y, expected);
        wrong[n] += (dydt - expected).norm() > 1e-12 * (1 + expected.norm());
      }
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

TEST(FormulaSystem, LaterDivisionsByZeroGiveNumbersThatAreNotFinite) {
  const FormulaSystem system(single("1/x"));
  Eigen::VectorXd y(1), dydt(1);
  y[0] = 0;
  system.rhs(0, y, dydt);
  EXPECT_FALSE(std::isfinite(dydt[0]));
}

TEST(FormulaSystem, UnknownNamesAreNamedWithColumnAndSuggestion) {
  EXPECT_SAYS(refusal("a*x + coz(t)"),
              "equation x' = \"a*x + coz(t)\", column 7: the name 'coz' is not known; did you");
  EXPECT_SAYS(refusal("a*x + coz(t)"), "'cos'?");
  EXPECT_SAYS(refusal("velocity"), "known are x, a, t, pi, e");
  EXPECT_SAYS(refusal("_pi"), "'_pi' is not known; did you mean 'pi'?");
}

TEST(FormulaSystem, SyntaxErrorsNameTheEquationTheColumnAndTheRemedy) {
  EXPECT_SAYS(refusal(""), "the formula is empty");
  EXPECT_SAYS(refusal("  "), "the formula is empty");
  EXPECT_SAYS(refusal("x +* a"), "column 4: the operator '*' is out of place");
  EXPECT_SAYS(refusal("x +"), "ends too early");
  EXPECT_SAYS(refusal("(x + a"), "not closed");
  EXPECT_SAYS(refusal("x + a)"), "column 6: the parenthesis ')'");
  EXPECT_SAYS(refusal("x a"), "column 3: an operator is missing before 'a'");
  EXPECT_SAYS(refusal("2x"), "column 2: a name follows a number");
  EXPECT_SAYS(refusal("2e"), "column 2: a name follows a number");
  EXPECT_SAYS(refusal("x(2)"), "out of place");
  EXPECT_SAYS(refusal("sin"), "equation x'");
  EXPECT_SAYS(refusal("sin()"), "too few arguments");
  EXPECT_SAYS(refusal("sin(x, a)"), "too many arguments");
  EXPECT_SAYS(refusal("x ? a"), "a ? b : c");
  EXPECT_SAYS(refusal("1.2.3"), "equation x'");
  EXPECT_SAYS(refusal("()"), "equation x'");
  EXPECT_SAYS(refusal(std::string(6000, '1')), "equation x'");
  EXPECT_LT(refusal(std::string(6000, '1')).size(), 300u);
}

TEST(FormulaSystem, AssignmentsSeveralValuesAndForeignCharactersAreRefused) {
  EXPECT_SAYS(refusal("a = 3"), "column 3: a formula assigns nothing");
  EXPECT_SAYS(refusal("x = a == 2"), "column 3: a formula assigns nothing");
  EXPECT_SAYS(refusal("1,5"), "decimals with a point");
  EXPECT_SAYS(refusal("x, a"), "decimals with a point");
  EXPECT_SAYS(refusal("\"text\""), "column 1: a formula cannot contain '\"'");
  EXPECT_SAYS(refusal("x; a"), "cannot contain ';'");
  EXPECT_SAYS(refusal("x \xc3\x97 a"), "this character");
  EXPECT_SAYS(refusal(std::string("x\0a", 3)), "this character");
}

TEST(FormulaSystem, DerivativesThatAreNotFiniteAtTheStartAreRefused) {
  EXPECT_SAYS(refusal("1/0"), "not finite at the start");
  EXPECT_SAYS(refusal("1/(x - 3)"), "not finite at the start");
  EXPECT_SAYS(refusal("sqrt(-x)"), "not finite at the start");
  EXPECT_SAYS(refusal("ln(0*t)"), "not finite at the start");
}

TEST(FormulaSystem, NamesThatAreNotFreeAreRefused) {
  const auto named = [](const std::string& state, const std::string& parameter) {
    return refusal({.name = "n", .equations = {{state, "0"}}, .parameters = {{parameter, 1}}, .y0 = {0}});
  };
  EXPECT_EQ(named("x", "a"), "accepted");
  EXPECT_SAYS(named("t", "a"), "the state 't' has the name of the time");
  EXPECT_SAYS(named("x", "pi"), "the parameter 'pi' has the name of a constant");
  EXPECT_SAYS(named("x", "sin"), "the parameter 'sin' has the name of a function");
  EXPECT_SAYS(named("x", "x"), "the parameter 'x' is defined twice");
  EXPECT_SAYS(named("1x", "a"), "the state '1x' is no name");
  EXPECT_SAYS(named("x y", "a"), "is no name");
  EXPECT_SAYS(named("", "a"), "is no name");
  EXPECT_SAYS(named(std::string(101, 'x'), "a"), "is no name");
}

TEST(FormulaSystem, SizesAndNumbersAreChecked) {
  auto definition = single("x");
  definition.equations.clear();
  EXPECT_SAYS(refusal(definition), "no equations");
  definition = single("x");
  definition.y0 = {1, 2};
  EXPECT_SAYS(refusal(definition), "1 equations but 2 initial values");
  definition.y0 = {std::nan("")};
  EXPECT_SAYS(refusal(definition), "initial value of 'x' is not finite");
  definition = single("x");
  definition.parameters[0].second = std::numeric_limits<double>::infinity();
  EXPECT_SAYS(refusal(definition), "parameter 'a' is not finite");
  definition = single("x");
  definition.t_end = 4;
  EXPECT_SAYS(refusal(definition), "before the start");
  definition.t_end = std::nan("");
  EXPECT_SAYS(refusal(definition), "time span");
}

}  // namespace
}  // namespace hmax
