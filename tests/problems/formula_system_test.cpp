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
#include "tests/says.hpp"

namespace hmax {
namespace {

static_assert(System<FormulaSystem>);
static_assert(DifferentiableSystem<FormulaSystem> && TimeDifferentiableSystem<FormulaSystem> &&
              SecondOrderSystem<FormulaSystem>);

FormulaDefinition liver_formulas() {
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
  return error_of<std::invalid_argument>([&] { const FormulaSystem system(definition); });
}

std::string refusal(const std::string& formula) { return refusal(single(formula)); }

TEST(FormulaSystem, EqualsTheOscillatorOnRandomStates) {
  const FormulaSystem formulas(liver_formulas());
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
  FormulaSystem system(liver_formulas());
  EXPECT_THROW(system.set("c", std::nan("")), std::invalid_argument);
  EXPECT_TRUE(says(error_of<std::invalid_argument>([&] { system.set("k4", 1); }), "did you mean 'k1'?"));
}

TEST(FormulaSystem, OneSystemServesSeveralThreads) {
  const FormulaSystem original(liver_formulas());
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t n = 0; n < wrong.size(); ++n)
    threads.emplace_back([&original, &wrong, n] {
      const Oscillator oscillator;
      Eigen::VectorXd dydt(2);
      Eigen::Vector2d expected;
      for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector2d y(0.01 * i, static_cast<double>(n));
        original.rhs(i, y, dydt);
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
  EXPECT_TRUE(says(refusal("a*x + coz(t)"),
                   "equation x' = \"a*x + coz(t)\", column 7: the name 'coz' is not known; did you"));
  EXPECT_TRUE(says(refusal("a*x + coz(t)"), "'cos'?"));
  EXPECT_TRUE(says(refusal("velocity"), "known are x, a, t, pi, e"));
  EXPECT_TRUE(says(refusal("_pi"), "'_pi' is not known; did you mean 'pi'?"));
}

TEST(FormulaSystem, SyntaxErrorsNameTheEquationTheColumnAndTheRemedy) {
  EXPECT_TRUE(says(refusal(""), "the formula is empty"));
  EXPECT_TRUE(says(refusal("  "), "the formula is empty"));
  EXPECT_TRUE(says(refusal("x +* a"), "column 4: the operator '*' is out of place"));
  EXPECT_TRUE(says(refusal("x +"), "ends too early"));
  EXPECT_TRUE(says(refusal("(x + a"), "not closed"));
  EXPECT_TRUE(says(refusal("x + a)"), "column 6: the parenthesis ')'"));
  EXPECT_TRUE(says(refusal("x a"), "column 3: an operator is missing before 'a'"));
  EXPECT_TRUE(says(refusal("2x"), "column 2: a name follows a number"));
  EXPECT_TRUE(says(refusal("2e"), "column 2: a name follows a number"));
  EXPECT_TRUE(says(refusal("x(2)"), "out of place"));
  EXPECT_TRUE(says(refusal("sin"), "column 1: the function 'sin' has no arguments"));
  EXPECT_TRUE(says(refusal("sin()"), "too few arguments"));
  EXPECT_TRUE(says(refusal("sin(x, a)"), "too many arguments"));
  EXPECT_TRUE(says(refusal("x ? a"), "a ? b : c"));
  EXPECT_TRUE(says(refusal("1.2.3"), "column 1: this is no number"));
  EXPECT_TRUE(says(refusal("()"), "column 2: the parentheses are empty"));
  EXPECT_TRUE(says(refusal("1 < x < 3 ? 1 : 0"), "column 7: comparisons do not chain; write a < b && b < c"));
  EXPECT_TRUE(says(refusal("x == a == 0"), "column 8: comparisons do not chain"));
  EXPECT_TRUE(says(refusal("x & a"), "column 3: conditions are joined by &&"));
  EXPECT_TRUE(says(refusal(std::string(6000, '1')), "equation x'"));
  EXPECT_TRUE(says(refusal(std::string(100'000, '(') + "x"), "nested too deeply"));
  EXPECT_TRUE(says(refusal(std::string(100'000, '-') + "x"), "nested too deeply"));
  EXPECT_LT(refusal(std::string(6000, '1')).size(), 300u);
}

TEST(FormulaSystem, AssignmentsSeveralValuesAndForeignCharactersAreRefused) {
  EXPECT_TRUE(says(refusal("a = 3"), "column 3: a formula assigns nothing"));
  EXPECT_TRUE(says(refusal("x = a == 2"), "column 3: a formula assigns nothing"));
  EXPECT_TRUE(says(refusal("1,5"), "decimals with a point"));
  EXPECT_TRUE(says(refusal("x, a"), "decimals with a point"));
  EXPECT_TRUE(says(refusal("\"text\""), "column 1: a formula cannot contain '\"'"));
  EXPECT_TRUE(says(refusal("x; a"), "cannot contain ';'"));
  EXPECT_TRUE(says(refusal("x \xc3\x97 a"), "this character"));
  EXPECT_TRUE(says(refusal(std::string("x\0a", 3)), "this character"));
}

TEST(FormulaSystem, DerivativesThatAreNotFiniteAtTheStartAreRefused) {
  EXPECT_TRUE(says(refusal("1/0"), "not finite at the start"));
  EXPECT_TRUE(says(refusal("1/(x - 3)"), "not finite at the start"));
  EXPECT_TRUE(says(refusal("sqrt(-x)"), "not finite at the start"));
  EXPECT_TRUE(says(refusal("ln(0*t)"), "not finite at the start"));
}

TEST(FormulaSystem, NamesThatAreNotFreeAreRefused) {
  const auto named = [](const std::string& state, const std::string& parameter) {
    return refusal({.name = "n", .equations = {{state, "0"}}, .parameters = {{parameter, 1}}, .y0 = {0}});
  };
  EXPECT_EQ(named("x", "a"), "");
  EXPECT_TRUE(says(named("t", "a"), "the state 't' has the name of the time"));
  EXPECT_TRUE(says(named("x", "pi"), "the parameter 'pi' has the name of a constant"));
  EXPECT_TRUE(says(named("x", "sin"), "the parameter 'sin' has the name of a function"));
  EXPECT_TRUE(says(named("x", "x"), "the parameter 'x' is defined twice"));
  EXPECT_TRUE(says(named("1x", "a"), "the state '1x' is no name"));
  EXPECT_TRUE(says(named("x y", "a"), "is no name"));
  EXPECT_TRUE(says(named("", "a"), "is no name"));
  EXPECT_TRUE(says(named("x\ny", "a"), "the state 'x?y' is no name"));
  EXPECT_TRUE(says(named(std::string(101, 'x'), "a"), "is no name"));
  EXPECT_EQ(named(std::string(100, 'x'), "a"), "");
}

TEST(FormulaSystem, SizesAndNumbersAreChecked) {
  auto definition = single("x");
  definition.equations.clear();
  EXPECT_TRUE(says(refusal(definition), "no equations"));
  definition = single("x");
  definition.y0 = {1, 2};
  EXPECT_TRUE(says(refusal(definition), "1 equations but 2 initial values"));
  definition.y0 = {std::nan("")};
  EXPECT_TRUE(says(refusal(definition), "initial value of 'x' is not finite"));
  definition = single("x");
  definition.parameters[0].second = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(says(refusal(definition), "parameter 'a' is not finite"));
  definition = single("x");
  definition.t_end = 5;
  EXPECT_TRUE(says(refusal(definition), "t_end is 5, the time of the start"));
  definition.t_end = 4;
  EXPECT_EQ(refusal(definition), "") << "backwards";
  definition.t_end = std::nan("");
  EXPECT_TRUE(says(refusal(definition), "time span"));
}

/// What muParser 2.3.3 made of formulas with x = 3, a = 2 and t = 5; it read them before.
TEST(FormulaSystem, OperatorsBindAsTheyAlwaysDid) {
  EXPECT_EQ(value("2^-a^2"), 0.0625);
  EXPECT_EQ(value("2^-1*4"), 2);
  EXPECT_EQ(value("-2^-2"), -0.25);
  EXPECT_EQ(value("x--a"), 5);
  EXPECT_EQ(value("x-+a"), 1);
  EXPECT_EQ(value("+x"), 3);
  EXPECT_EQ(value("(1<2)==1"), 1);
  EXPECT_EQ(value("3>2&&2>1"), 1);
  EXPECT_EQ(value("1||0&&0"), 1);
  EXPECT_EQ(value("1 && 2 == 2"), 1);
  EXPECT_EQ(value("x<0?1:x<1?2:3"), 3);
  EXPECT_EQ(value("x>0?a>5?1:2:3"), 2);
  EXPECT_EQ(value("1?2:3+4"), 2);
  EXPECT_EQ(value("(1?2:3)+4"), 6);
  EXPECT_EQ(value("2*3?1:0"), 1);
  EXPECT_EQ(value("1-2-3"), -4);
  EXPECT_EQ(value("8/4/2"), 1);
  EXPECT_EQ(value("-e^2"), -std::pow(std::exp(1.0), 2));
  EXPECT_EQ(value("2*x^2^2"), 162);
  EXPECT_EQ(value("rint(2.5) + 10*rint(-2.5) + 100*rint(3.5)"), 3 - 20 + 400);
  // Where a + 0.5 rounds.
  EXPECT_EQ(value("rint(0.49999999999999994)"), 0);
  EXPECT_EQ(value("rint(4503599627370497)"), 4503599627370497);
  EXPECT_EQ(value("sign(0)"), 0);
  EXPECT_EQ(value("sum(1,2,3) + avg(1,2,3)"), 8);
  EXPECT_EQ(value("min(x,a,1) + max(x) + 5. + .5 + 1e3"), 1009.5);
  EXPECT_DOUBLE_EQ(value("log(2)"), std::log(2.0));
}

TEST(FormulaSystem, PowersMayBeWrittenAsInOtherLanguages) {
  EXPECT_EQ(value("x**2 + 1"), 10);
  EXPECT_EQ(value("2**3**2"), 512);
  EXPECT_EQ(value("-x ** 2"), -9);
  EXPECT_EQ(value("pow(x, 3)"), 27);
  EXPECT_EQ(value("0.5 && 1"), 1);
  EXPECT_TRUE(says(refusal("pow(x)"), "too few arguments for the function 'pow'"));
  EXPECT_TRUE(says(refusal("x *** a"), "column 5: the operator '*' is out of place"));
}

/// A system of n states y1, y2, ... started at (0.3, 0.7, 1.1, ...), with a = 2 and z = 0.
FormulaSystem system_of(const std::vector<std::string>& formulas) {
  FormulaDefinition definition{.name = "f", .parameters = {{"a", 2}, {"z", 0}}, .t0 = 0.5};
  for (std::size_t i = 0; i < formulas.size(); ++i) {
    definition.equations.emplace_back("y" + std::to_string(i + 1), formulas[i]);
    definition.y0.push_back(0.3 + 0.4 * static_cast<double>(i));
  }
  return FormulaSystem(definition);
}

/// f(t, y) of the only equation.
double at(const FormulaSystem& system, double t, const Eigen::VectorXd& y) {
  Eigen::VectorXd f(y.size());
  system.rhs(t, y, f);
  return f[0];
}

TEST(FormulaSystem, DerivativesAreThoseOfEveryFunction) {
  const std::vector<std::string> formulas{"y1^2",
                                          "y1^3",
                                          "y1^4",
                                          "y1^2.5",
                                          "a^y1",
                                          "y1^y2",
                                          "(y1*t)^(y2*t)",
                                          "sin(y1*y2)",
                                          "cos(3*y1)",
                                          "tan(y1)",
                                          "asin(y1)",
                                          "acos(y1*t)",
                                          "atan(y1)",
                                          "sinh(y1)",
                                          "cosh(y1)",
                                          "tanh(y1)",
                                          "asinh(y1)",
                                          "acosh(1 + y1)",
                                          "atanh(y1)",
                                          "exp(-y1*t)",
                                          "log(y1)",
                                          "ln(y1)",
                                          "log2(y1)",
                                          "log10(y1)",
                                          "sqrt(y1)",
                                          "abs(y1 - y2)",
                                          "atan2(y1, y2*t)",
                                          "min(y1, y2, t)",
                                          "max(y1, y2*t)",
                                          "avg(y1, y2, t)",
                                          "sum(y1, y1*y2)",
                                          "1/y1 - y2/(y1 + t)",
                                          "-y1*y2 + +t",
                                          "y1 < y2 ? y1^2 : t*y2",
                                          "y1 > y2 ? y1^2 : t*y2",
                                          "pow(y1, 2)*y2",
                                          "y1/y2/t"};
  const double t = 0.6, h = 1e-6;
  for (const std::string& formula : formulas) {
    SCOPED_TRACE(formula);
    const FormulaSystem system = system_of({formula, "0"});
    Eigen::VectorXd y(2), dfdt(2);
    y << 0.3, 0.7;
    Eigen::MatrixXd J;
    system.jacobian(t, y, J);
    for (Eigen::Index j = 0; j < 2; ++j) {
      Eigen::VectorXd plus = y, minus = y;
      plus[j] += h;
      minus[j] -= h;
      EXPECT_NEAR(J(0, j), (at(system, t, plus) - at(system, t, minus)) / (2 * h),
                  2e-8 * (1 + std::abs(J(0, j))));
      EXPECT_EQ(J(1, j), 0);
    }
    system.time_derivative(t, y, dfdt);
    EXPECT_NEAR(dfdt[0], (at(system, t + h, y) - at(system, t - h, y)) / (2 * h),
                2e-8 * (1 + std::abs(dfdt[0])));
  }
}

TEST(FormulaSystem, BranchesShareWhatBothNeed) {
  // sin(y1) is of all branches, exp(y1) of two of them, log(y1) of one inside another.
  const FormulaSystem system = system_of(
      {"y1 < 1 ? (y1 < 0.5 ? exp(y1)*sin(y1) : log(y1) + exp(y1)) : cos(y1)*sin(y1) + (y1 > 3 ? y1^2.5 : sin(y1)^2)"});
  for (const double x : {0.3, 0.7, 2.0, 4.0}) {
    const double expected =
        x < 1 ? (x < 0.5 ? std::exp(x) * std::sin(x) : std::log(x) + std::exp(x))
              : std::cos(x) * std::sin(x) + (x > 3 ? std::pow(x, 2.5) : std::pow(std::sin(x), 2));
    EXPECT_NEAR(at(system, 0, Eigen::VectorXd::Constant(1, x)), expected, 1e-14 * std::abs(expected)) << x;
  }
}

TEST(FormulaSystem, DerivativesKnowNothingOfLargeConstantsAndZeros) {
  // The rate constants of a pump: differences at zero beside 1e10 lose all digits.
  const FormulaSystem system = system_of({"1e26 - 1e6*y1", "1e10 - 50*y2 + 1e-8*y1"});
  Eigen::MatrixXd J;
  system.jacobian(0, Eigen::Vector2d(0, 0), J);
  EXPECT_EQ(J(0, 0), -1e6);
  EXPECT_EQ(J(0, 1), 0);
  EXPECT_EQ(J(1, 0), 1e-8);
  EXPECT_EQ(J(1, 1), -50);
}

TEST(FormulaSystem, DerivativesAtAKinkAreOfOneSide) {
  const auto slope = [](const std::string& formula, double t) {
    const FormulaSystem system = system_of({formula});
    Eigen::VectorXd dfdt(1);
    system.time_derivative(t, Eigen::VectorXd::Constant(1, 0.3), dfdt);
    return dfdt[0];
  };
  EXPECT_EQ(slope("abs(t - 1)", 1), 1);
  EXPECT_EQ(slope("abs(1 - t)", 1), 1);
  EXPECT_EQ(slope("max(0, t - 1)", 1), 1);
  EXPECT_EQ(slope("min(0, t - 1)", 1), 0);
  EXPECT_EQ(slope("t < 1 ? t : 3*t", 1), 3);
  EXPECT_EQ(slope("sign(t - 1) + rint(t)", 0.5), 0);
  // Contact: the side that the formula takes.
  const FormulaSystem contact = system_of({"y1 < 0 ? -1e6*y1 : 0"});
  Eigen::MatrixXd J;
  contact.jacobian(0, Eigen::VectorXd::Constant(1, -1e-9), J);
  EXPECT_EQ(J(0, 0), -1e6);
  contact.jacobian(0, Eigen::VectorXd::Zero(1), J);
  EXPECT_EQ(J(0, 0), 0);
  // A power at zero has the slope of its limit.
  const FormulaSystem power = system_of({"y1^1.5 + y1^(2 + z*y1)"});
  power.jacobian(0, Eigen::VectorXd::Zero(1), J);
  EXPECT_EQ(J(0, 0), 0);
}

TEST(FormulaSystem, LinearityIsThatOfTheStructure) {
  using enum Linearity;
  const auto of = [](const std::string& formula) { return system_of({formula, "0"}).linearity(); };
  for (const char* formula : {"-y1 + 3*y2",
                              "a*y1 - y2/a + sin(t)*a",
                              "1e26 - y1/1e-6",
                              "z*y1^3 - y1",
                              "z*sin(y1)",
                              "y1*y1*0",
                              "y1^(a - 1)",
                              "0",
                              "abs(t) + y1",
                              "t < 1 ? 1 : 2",
                              "z ? y1^2 : y1",
                              "y1 + y2 - (y1 - y2)",
                              "z*abs(y1)",
                              "sum(y1, y2, 1)",
                              "avg(y1, y2)",
                              "y1*a^2",
                              "-(-y1)",
                              "cos(z)*y1",
                              "z*sign(y1)/3 + y1",
                              "2*(y1 + 3) > 0 ? y2 : y2"})
    EXPECT_EQ(of(formula), linear) << formula;
  for (const char* formula : {"t*y1", "-(t < 1 ? 1 : 10000)*y1", "sin(t)*y1 + y2", "y1/(1 + t^2)",
                              "y1*abs(t - 3)", "t < 1 ? y1 : y2", "y1^(1 + z)*t", "rint(t)*y1"})
    EXPECT_EQ(of(formula), time_varying) << formula;
  for (const char* formula :
       {"y1*y2", "y1^2", "sin(y1)", "abs(y1)", "sign(y1)", "rint(y1)", "min(y1, 0)", "max(y1, t)", "y1 > 0",
        "y1 > 0 ? 1 : 0", "y1 > 0 ? -y1 : -2*y1", "1/y1", "a^y1", "y1 == 3", "y1 > 0 && t > 1", "y1 > 0 || 0",
        "sqrt(y1)", "y1 < 0 ? 1e6*y1 : 0", "abs(y1 - t)*1e-9"})
    EXPECT_EQ(of(formula), nonlinear) << formula;
  // One equation is enough.
  EXPECT_EQ(system_of({"y2", "-y1", "y3^2"}).linearity(), nonlinear);
}

TEST(FormulaSystem, LinearityFollowsTheParameters) {
  FormulaSystem system(liver_formulas());
  EXPECT_EQ(system.linearity(), Linearity::nonlinear);
  EXPECT_FALSE(system.is_autonomous());
  system.set("k3", 0);
  EXPECT_EQ(system.linearity(), Linearity::linear);
  EXPECT_FALSE(system.is_autonomous());
  system.set("P", 0);
  EXPECT_TRUE(system.is_autonomous());
}

TEST(FormulaSystem, SaysWhetherTimeActs) {
  EXPECT_TRUE(system_of({"-y1"}).is_autonomous());
  EXPECT_TRUE(system_of({"-y1 + 0*t"}).is_autonomous());
  EXPECT_FALSE(system_of({"-y1 + 1e-30*t"}).is_autonomous());
  EXPECT_FALSE(system_of({"t < 1e9 ? 1 : 2"}).is_autonomous());
}

using Times = std::vector<double>;

void expect_near(const Times& times, const Times& expected) {
  ASSERT_EQ(times.size(), expected.size());
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(times[i], expected[i], 1e-14 * (1 + std::abs(expected[i])));
}

TEST(FormulaSystem, BreakpointsAreTheTimesAtWhichTimeAloneSwitches) {
  const auto of = [](const std::string& formula, double t0, double t1) {
    return system_of({formula}).breakpoints(t0, t1);
  };
  EXPECT_EQ(of("t < 1 ? 1 : 2", 0, 3), (Times{1}));
  EXPECT_EQ(of("-(t >= 1 && t < 1.5 ? 5 : 0)*y1", 0, 3), (Times{1, 1.5}));
  EXPECT_EQ(of("t < 1 ? 1 : 2", 1, 3), Times{});
  EXPECT_EQ(of("t < 1 ? 1 : 2", 0, 1), Times{});
  EXPECT_EQ(of("y1 < t ? 1 : 2", 0, 3), Times{});
  EXPECT_EQ(of("sin(t)*y1", 0, 30), Times{});
  EXPECT_EQ(of("z*(t < 1)", 0, 30), Times{});
  EXPECT_EQ(of("t > 1 && t < 1.000001", 0, 1000), (Times{1, 1.000001}));
  expect_near(of("t <= 1 ? 1 : 2", 0, 3), {1});
  expect_near(of("abs(t - 0.7) + sign(2*t - 1) + max(t, 0.3) + min(2, t)", 0, 3), {0.3, 0.5, 0.7, 2});
  expect_near(of("rint(t)", 0, 3), {0.5, 1.5, 2.5});
  expect_near(of("t - rint(t) < 0.2", -0.9, 1.1), {-0.8, -0.5, 0.2, 0.5});
  expect_near(of("(t < 1e-9)*y1", 0, 4e-9), {1e-9});
  expect_near(of("t^3 < 8", -1e3, 1e3), {2});
  expect_near(of("exp(-t) > 0.5", 0, 10), {std::log(2.0)});
}

TEST(FormulaSystem, AConditionWithoutAValueDoesNotSwitch) {
  // All samples are without a value; then those behind 5, where the condition loses its own.
  const auto of = [](const std::string& formula, double t0, double t1) {
    return system_of({formula}).breakpoints(t0, t1);
  };
  EXPECT_EQ(of("rint(log(5 - t))", 5.5, 9), Times{});
  expect_near(of("rint(sqrt(5 - t))", 4.9, 9), {5});
  expect_near(of("sqrt(5 - t) < 1 ? 1 : 2", 0, 8), {4, 5});
}

TEST(FormulaSystem, BreakpointsOfPeriodicConditionsAreAllThere) {
  const FormulaSystem square = system_of({"sin(2*pi*50*t) > 0 ? 1 : -1"});
  const Times times = square.breakpoints(0, 10);
  ASSERT_EQ(times.size(), 999U);
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(times[i], 0.01 * static_cast<double>(i + 1), 1e-12);
  // Far more than is looked for: those at the beginning.
  const Times many = system_of({"cos(1e9*t) > 0"}).breakpoints(0, 10);
  ASSERT_GT(many.size(), 10'000U);
  ASSERT_LT(many.size(), 100'000U);
  EXPECT_NEAR(many[9999], (9999.5) * std::acos(-1.0) / 1e9, 1e-18);
}

TEST(FormulaSystem, PositionsAndTheirVelocitiesAreRecognised) {
  const auto system = [](std::vector<std::pair<std::string, std::string>> equations) {
    FormulaDefinition definition{.name = "s", .equations = std::move(equations), .parameters = {{"k", 3}}};
    for (std::size_t i = 0; i < definition.equations.size(); ++i)
      definition.y0.push_back(static_cast<double>(i + 1));
    return FormulaSystem(definition);
  };
  using Order = std::vector<Eigen::Index>;
  EXPECT_EQ(system({{"x", "v"}, {"v", "-k*x"}}).order(), (Order{0, 1}));
  EXPECT_EQ(system({{"v", "-k*x"}, {"x", "v"}}).order(), (Order{1, 0}));
  EXPECT_EQ(system({{"x", "v"}, {"v", "-x"}, {"y", "w"}, {"w", "-y"}}).order(), (Order{0, 2, 1, 3}));
  EXPECT_EQ(system({{"x", "v + 1e-9*x"}, {"v", "-x"}}).dofs(), 0) << "not v alone";
  EXPECT_EQ(system({{"x", "(v + 0)*1"}, {"v", "-x"}}).dofs(), 1);
  EXPECT_EQ(system({{"x", "2*v"}, {"v", "-x"}}).dofs(), 0);
  EXPECT_EQ(system({{"x", "v + 1"}, {"v", "-x"}}).dofs(), 0);
  EXPECT_EQ(system({{"x", "abs(v)"}, {"v", "-x"}}).dofs(), 0);
  EXPECT_EQ(system({{"x", "x"}, {"v", "v"}}).dofs(), 0);
  EXPECT_EQ(system({{"x", "v"}, {"y", "v"}, {"v", "-x"}, {"w", "-y"}}).dofs(), 0) << "one velocity for two";
  EXPECT_EQ(system({{"x", "v"}, {"v", "-x"}, {"c", "-c"}}).dofs(), 0) << "a state beside them";
  EXPECT_EQ(system({{"x", "-x"}}).dofs(), 0);
  // Both are derivatives: the first is a position. Of a chain the one that is nobody's derivative is.
  EXPECT_EQ(system({{"x", "y"}, {"y", "x"}}).order(), (Order{0, 1}));
  EXPECT_EQ(system({{"v", "a"}, {"x", "v"}, {"a", "j"}, {"j", "-x"}}).order(), (Order{1, 2, 0, 3}));

  // y and its derivatives have the order (q, v).
  const FormulaSystem pair = system({{"v", "-k*x - 2*v + t*x*w"}, {"x", "v"}, {"w", "-5*y"}, {"y", "w"}});
  ASSERT_EQ(pair.order(), (Order{1, 3, 0, 2}));
  EXPECT_EQ(pair.y0(), Eigen::Vector4d(2, 4, 1, 3));
  Eigen::VectorXd dydt(4), f;
  pair.rhs(10, pair.y0(), dydt);
  EXPECT_EQ(dydt, Eigen::Vector4d(1, 3, -3 * 2 - 2 + 60, -20));
  const Eigen::VectorXd q = pair.y0().head(2), v = pair.y0().tail(2);
  pair.force(10, q, v, f);
  EXPECT_EQ(f, Eigen::Vector2d(52, -20));
  EXPECT_EQ(pair.mass(), Eigen::Vector2d(1, 1));
  Eigen::MatrixXd K, C;
  pair.stiffness(10, q, v, K);
  pair.damping(10, q, v, C);
  EXPECT_EQ(K, (Eigen::Matrix2d{{3 - 30, 0}, {0, 5}}));
  EXPECT_EQ(C, (Eigen::Matrix2d{{2, -20}, {0, 0}}));
}

/// A chain of `count` masses with cubic springs to the ground, positions after velocities.
FormulaDefinition long_chain(int count) {
  FormulaDefinition chain{.name = "chain", .parameters = {{"k", 3}}};
  const auto q = [&](int i) { return i < 0 || i >= count ? std::string("0") : "q" + std::to_string(i); };
  for (int i = 0; i < count; ++i) {
    const std::string v = "v" + std::to_string(i);
    chain.equations.emplace_back(
        v, "k*(" + q(i - 1) + " - 2*" + q(i) + " + " + q(i + 1) + ") - " + q(i) + "^3 - 2*" + v);
    chain.y0.push_back(0);
  }
  for (int i = 0; i < count; ++i) {
    chain.equations.emplace_back(q(i), "v" + std::to_string(i));
    chain.y0.push_back(0.01 * (i + 1));
  }
  return chain;
}

TEST(FormulaSystem, OfManyLooselyCoupledEquationsHasSparseMatrices) {
  EXPECT_FALSE(FormulaSystem(long_chain(5)).is_sparse());
  const int n = 150;
  const FormulaSystem chain(long_chain(n));
  ASSERT_TRUE(chain.is_sparse());
  ASSERT_EQ(chain.dofs(), n);
  // -dF/dq: 2 k + 3 q^2 on the diagonal, -k beside it; -dF/dv: 2.
  const Eigen::VectorXd q = chain.y0().head(n), v = chain.y0().tail(n);
  EXPECT_EQ(q[n - 1], 0.01 * n);
  Eigen::SparseMatrix<double> K, C, J;
  chain.stiffness(0, q, v, K);
  chain.damping(0, q, v, C);
  chain.jacobian(0, chain.y0(), J);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    right(i, i) = 6 + 3 * q[i] * q[i];
    if (i > 0) right(i, i - 1) = right(i - 1, i) = -3;
  }
  EXPECT_LE((Eigen::MatrixXd(K) - right).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(Eigen::MatrixXd(C), Eigen::MatrixXd(2 * Eigen::MatrixXd::Identity(n, n)));
  EXPECT_EQ(J.nonZeros(), n + 3 * n - 2 + n);
  // y' = (v, -K q - C v)
  Eigen::MatrixXd dense;
  chain.jacobian(0, chain.y0(), dense);
  EXPECT_EQ(Eigen::MatrixXd(J), dense);
  EXPECT_EQ(dense.topLeftCorner(n, n), Eigen::MatrixXd(Eigen::MatrixXd::Zero(n, n)));
  EXPECT_EQ(dense.topRightCorner(n, n), Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  EXPECT_LE((dense.bottomLeftCorner(n, n) + right).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(dense.bottomRightCorner(n, n), Eigen::MatrixXd(-2 * Eigen::MatrixXd::Identity(n, n)));
  chain.stiffness(0, q, v, dense);
  EXPECT_EQ(Eigen::MatrixXd(K), dense);
  // Where q = 0 an entry is zero and stays in the pattern.
  chain.jacobian(0, Eigen::VectorXd::Zero(2 * n), J);
  EXPECT_EQ(J.nonZeros(), n + 3 * n - 2 + n);
}

TEST(FormulaSystem, OfManyEquationsThatMeetInASumHasFullMatrices) {
  const int n = 210;
  FormulaDefinition all{.name = "all"};
  std::string sum = "0";
  for (int i = 0; i < n; ++i) sum += " + x" + std::to_string(i);
  for (int i = 0; i < n; ++i) all.equations.emplace_back("x" + std::to_string(i), sum);
  all.y0.assign(n, 1);
  const FormulaSystem system(all);
  EXPECT_FALSE(system.is_sparse());
  Eigen::MatrixXd J;
  system.jacobian(0, system.y0(), J);
  EXPECT_EQ(J, Eigen::MatrixXd(Eigen::MatrixXd::Ones(n, n)));
  // A message names no more than people read.
  all.equations.front().second = "velocity";
  EXPECT_TRUE(says(refusal(all), "known are x0, x1, x2, "));
  EXPECT_TRUE(says(refusal(all), "x59 and "));
}

TEST(FormulaSystem, PositionsAndVelocitiesMayBeNamed) {
  FormulaDefinition definition{.name = "s",
                               .equations = {{"x", "y"}, {"y", "x"}},
                               .y0 = {1, 2},
                               .positions = {"y"},
                               .velocities = {"x"}};
  EXPECT_EQ(FormulaSystem(definition).order(), (std::vector<Eigen::Index>{1, 0}));
  const auto named = [&](std::vector<std::string> positions, std::vector<std::string> velocities) {
    definition.positions = std::move(positions);
    definition.velocities = std::move(velocities);
    return refusal(definition);
  };
  EXPECT_TRUE(says(named({"x"}, {}), "1 positions but 0 velocities"));
  EXPECT_TRUE(says(named({"x"}, {"u"}), "name 'u', which has no equation"));
  EXPECT_TRUE(says(named({"x"}, {"x"}), "name 'x' twice"));
  definition.equations = {{"x", "2*v"}, {"v", "-x"}, {"z", "0"}};
  definition.y0 = {1, 2, 3};
  EXPECT_TRUE(says(named({"x"}, {"v"}), "name 2 of 3 states"));
  definition.equations.pop_back();
  definition.y0.pop_back();
  EXPECT_TRUE(
      says(named({"x"}, {"v"}), "equation x' = \"2*v\": this is not the velocity 'v'; write x = \"v\""));
}

TEST(FormulaSystem, SlopesThatItsRulesDoNotTellAreInfinite) {
  const FormulaSystem root(
      {.name = "root", .equations = {{"y", "t^0.5 - y * sqrt(y)"}}, .y0 = {0}, .t_end = 1});
  FormulaSystem::State slope(1);
  root.time_derivative(0, root.y0(), slope);
  EXPECT_EQ(slope[0], INFINITY);
  root.time_derivative(0.25, root.y0(), slope);
  EXPECT_DOUBLE_EQ(slope[0], 1);
  Eigen::MatrixXd J(1, 1);
  root.jacobian(0, root.y0(), J);
  EXPECT_EQ(J(0, 0), INFINITY);  // sqrt(y) + y / (2 sqrt(y))
}

}  // namespace
}  // namespace hmax
