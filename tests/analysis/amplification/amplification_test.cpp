#include "analysis/amplification/amplification.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/step_limits/stable_step.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/methods/measured_amplification.hpp"
#include "catalogue/models/problems.hpp"

namespace hmax {
namespace {

constexpr int samples = 10'000;

/// Random z of sizes from 0.01 to 10, most of them on the left.
Complex random_z(std::mt19937_64& random) {
  std::uniform_real_distribution<double> angle(1.2, 5.1), exponent(-2, 1);
  return std::polar(std::pow(10.0, exponent(random)), angle(random));
}

/// The states after 0, 1, ..., steps steps of size one.
std::vector<Eigen::VectorXd> path(const Method& method, const Problem& problem, int steps) {
  std::vector<Eigen::VectorXd> states;
  method.bind(problem).run({.t_end = static_cast<double>(steps), .h = 1},
                           [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) { states.push_back(y); });
  return states;
}

TEST(Amplification, OfEveryOneStepMethodIsWhatOneRealStepMultipliesBy) {
  for (const Method& method : methods()) {
    if (!method.amplification || !method.amplification->R || method.needs_second_order) continue;
    std::mt19937_64 random(7);
    // The foreign engines take a hundred times longer to start.
    const int count = method.engine == "hmax" ? samples : samples / 20;
    double worst = 0;
    Complex where;
    for (int i = 0; i < count; ++i) {
      const Complex z = random_z(random), R = method.amplification->R(z);
      const double defect = std::abs(measured_step(method, Eigenmode(z)) - R) / std::max(1.0, std::abs(R));
      if (!(defect <= worst)) {
        worst = defect;
        where = z;
      }
    }
    // The tables of the foreign engines have sixteen digits, which R near a pole magnifies.
    EXPECT_LT(worst, method.engine == "hmax" ? 1e-12 : 1e-11) << method.id << " at z = " << where;
  }
}

TEST(Amplification, OfTheFixedStepMethodsOfOdeintIsAFormulaThatTheirStepsConfirm) {
  for (const Method& method : methods()) {
    if (method.family != "odeint" || !method.fixed_step) continue;
    EXPECT_FALSE(method.amplification->measured) << method.id;
    if (!method.amplification->R) continue;  // of several steps
    for (const Complex z :
         {Complex(-0.3, 0), {-0.05, 0.4}, {-0.9, 0.7}, {-1.7, 0.2}, {-0.2, 1.3}, {-2.4, 1.9}})
      EXPECT_LT(std::abs(measured_step(method, Eigenmode(z)) - method.amplification->R(z)), 1e-12)
          << method.id << " at z = " << z;
  }
}

TEST(Amplification, OfEveryMultistepMethodIsTheRecurrenceOfItsSteps) {
  for (const Method& method : methods()) {
    if (method.family != "adams" && method.id != "odeint_adams_bashforth_moulton") continue;
    if (!method.amplification) continue;
    const StepPolynomial& pi = *method.amplification->in_z;
    const auto k = static_cast<int>(pi.coefficients().size()) - 1;
    // Of the pair without last evaluation the recurrence is that of the predicted values, which no run shows;
    // the corrected ones obey it as well, being sums of them.
    std::mt19937_64 random(8);
    double worst = 0;
    for (int i = 0; i < samples / 10; ++i) {
      const Complex z = 0.3 * random_z(random);
      const int first = method.order + 1;
      const auto states = path(method, spiral(Eigenmode(z)), first + k + 2);
      Complex defect = 0;
      double size = 0;
      for (int j = 0; j <= k; ++j) {
        const auto& y = states[static_cast<std::size_t>(first) + static_cast<std::size_t>(j)];
        const Complex term =
            Complex(evaluate(pi.coefficients()[static_cast<std::size_t>(j)], LongComplex(z))) *
            Complex(y[0], y[1]);
        defect += term;
        size += std::abs(term);
      }
      worst = std::max(worst, std::abs(defect) / size);
    }
    EXPECT_LT(worst, 1e-12) << method.id;
  }
}

TEST(Amplification, OfEveryMethodOfPositionsAndVelocitiesIsTheRecurrenceOfItsSteps) {
  const char* names[]{"symplectic_euler",
                      "velocity_verlet",
                      "stormer_verlet",
                      "central_difference",
                      "newmark",
                      "newmark:beta=0.3,gamma=0.6",
                      "explicit_newmark",
                      "hht_alpha",
                      "hht_alpha:alpha=-0.3",
                      "generalized_alpha",
                      "generalized_alpha:rho_inf=0.2"};
  for (const char* name : names) {
    const Method method = find_method(name);
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> uniform(0, 1);
    double worst = 0;
    for (int i = 0; i < samples; ++i) {
      const double kappa = std::pow(10.0, 4 * uniform(random) - 3),
                   gamma = std::pow(10.0, 4 * uniform(random) - 3);
      const StepPolynomial pi =
          *method.amplification->of_oscillation({.kappa = kappa, .gamma = gamma}).polynomial;
      const Problem problem = make_problem(
          "liver_linear",
          {.parameters = {{"m", 1}, {"c", gamma}, {"k1", kappa}}, .y0 = {uniform(random), uniform(random)}});
      const auto k = pi.coefficients().size() - 1;
      const auto states = path(method, problem, static_cast<int>(k) + 1);
      // From the second state on: the first has an acceleration of its own choice.
      for (const int component : {0, 1}) {
        double defect = 0, size = 0;
        for (std::size_t j = 0; j <= k; ++j) {
          const double term = static_cast<double>(evaluate(pi.coefficients()[j], LongComplex(1)).real()) *
                              states[1 + j][component];
          defect += term;
          size += std::abs(term);
        }
        worst = std::max(worst, std::abs(defect) / size);
      }
    }
    EXPECT_LT(worst, 1e-12) << name;
  }
}

TEST(Amplification, OfAFrozenJacobianToleratesTwiceTheDecayAndTwiceTheStiffness) {
  const Method euler = find_method("linearly_implicit_euler");
  const auto exit = [&](double ratio) {
    Eigenmode mode(Complex(-ratio, 0));
    mode.frozen = -1;
    return first_exit(euler.amplification->of_eigenmode(mode));
  };
  EXPECT_TRUE(std::isinf(exit(1.0)));
  EXPECT_TRUE(std::isinf(exit(2.0)));
  EXPECT_NEAR(exit(2.5), 2 / (2.5 - 2), 1e-9);  // |1 - h (r - 1) / (1 + h)| = 1
}

TEST(Amplification, OfAnImplicitExplicitPairTakesTheStiffPartImplicitly) {
  const Method euler = find_method("imex_euler");
  // R = (1 + z_nonstiff) / (1 - z_stiff)
  Eigenmode mode(Complex(-3, 0));
  mode.stiff = -1;
  EXPECT_NEAR(first_exit(euler.amplification->of_eigenmode(mode)), 2 / (2.0 - 1), 1e-12);
  mode.stiff = -2;
  EXPECT_TRUE(std::isinf(first_exit(euler.amplification->of_eigenmode(mode))));
}

TEST(StepPolynomial, DecidesStabilityAsItsRootsDo) {
  std::mt19937_64 random(10);
  std::uniform_real_distribution<long double> uniform(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const std::size_t degree = 1 + static_cast<std::size_t>(i) % 3;
    std::vector<Polynomial> p(degree + 1);
    for (Polynomial& q : p) q = {uniform(random)};
    p.back() = {2.0L};
    const StepPolynomial pi = StepPolynomial::real(p);
    const double radius = pi.spectral_radius(1);
    if (std::abs(radius - 1) < 1e-6) continue;
    EXPECT_EQ(pi.is_at_most_one(1), radius < 1);
    bool all = true;
    const std::vector<Polynomial> conditions = pi.conditions(0).value();
    for (const Polynomial& condition : conditions)
      all = all && (condition.empty() || evaluate(condition, 1.0L) >= 0);
    EXPECT_EQ(all, radius < 1) << degree << " " << radius;
  }
}

TEST(NegativeIntervals, AreFoundWhateverTheScale) {
  Polynomial p{1, -1};
  for (int i = 0; i < 5; ++i) p = product(p, {1, 1});
  for (const long double scale : {1e-8L, 1e-4L, 1.0L, 1e4L, 1e8L}) {
    const auto found = negative_intervals(p, scale);
    ASSERT_EQ(found.size(), 1u) << scale;
    EXPECT_NEAR(found[0].from, 1, 1e-8) << scale;
  }
}

TEST(Amplification, DoesNotDependOnTheUnitOfTime) {
  for (const char* name : {"imex_ark_436", "rodas_5p"}) {
    const Method method = find_method(name);
    const auto exit = [&](double size) {
      Eigenmode mode(size * Complex(-3, 2));
      mode.stiff = size * Complex(-1, 0);
      mode.frozen = size * Complex(-1.5, 0.5);
      return size * first_exit(method.amplification->of_eigenmode(mode));
    };
    EXPECT_TRUE(std::isfinite(exit(1))) << name;
    for (const double size : {1e-6, 1e-3, 1e4})
      EXPECT_NEAR(exit(size) / exit(1), 1, 1e-9) << name << " " << size;
  }
}

TEST(LargestStableStep, TakesAnEigenvalueThatIsRoundingForZero) {
  const Method euler = find_method("explicit_euler");
  const std::vector<Complex> spectrum{-10, 1.5e-16, -2};
  const StepLimit limit = largest_stable_step(*euler.amplification, spectrum);
  EXPECT_TRUE(limit.growing.empty());
  EXPECT_NEAR(limit.h_max, 0.2, 1e-12);
  const std::vector<Complex> growing{-10, 1e-6};
  EXPECT_EQ(largest_stable_step(*euler.amplification, growing).growing, std::vector<std::size_t>{1});
}

TEST(NegativeIntervals, AreFoundBetweenRootsOfAnySpacingAndNotAtDoubleOnes) {
  const auto with_roots = [](std::initializer_list<long double> roots) {
    Polynomial p{1};
    for (const long double root : roots) p = product(p, {-root, 1});
    return p;
  };
  const auto found = negative_intervals(with_roots({1, 2, 3, 3.0000001L}));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].from, 1, 1e-12);
  EXPECT_NEAR(found[0].to, 2, 1e-12);
  EXPECT_NEAR(found[1].from, 3, 1e-9);
  EXPECT_NEAR(found[1].to, 3.0000001, 1e-9);
  EXPECT_TRUE(negative_intervals(with_roots({2, 2})).empty());
  EXPECT_TRUE(negative_intervals(with_roots({-1, -5})).empty());
  EXPECT_EQ(negative_intervals(Polynomial{-1, 1}).front().from, 0);
  EXPECT_TRUE(std::isinf(negative_intervals(Polynomial{1, -1}).front().to));
}

}  // namespace
}  // namespace hmax
