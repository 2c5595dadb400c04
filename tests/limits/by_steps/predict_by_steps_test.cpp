#include "limits/by_steps/predict_by_steps.hpp"

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/numbers.hpp"
#include "limits/linearised_problem.hpp"

namespace hmax {
namespace {

const StepChoices with_exact{}, with_frozen{.jacobian = {JacobianUpdate::frozen}},
    with_truncated{
        .linear = {.by = LinearSolve::By::conjugate_gradients, .tolerance = 1e-3, .iterations = 20}};

/// A ball under gravity, with a spring below 0 of so many N/m, from x.
Problem ball(double k, double x) {
  return make_problem({.name = "ball",
                       .equations = {{"x", "v"}, {"v", "-9.81 - (x<0 ? k*x : 0)"}},
                       .parameters = {{"k", k}},
                       .y0 = {x, 0}},
                      "ball.toml");
}

// All eigenvalues are zero: no step size is short or long.
TEST(PredictBySteps, FindsNoLimitWhereNothingMovesOfItself) {
  const Problem falls = ball(0, 1);
  const Linearised near = linearised(falls);
  for (const StepChoices& options : {with_exact, with_frozen, with_truncated}) {
    const Prediction row = predict_by_steps(find_method("linearly_implicit_euler"), falls, near,
                                            {.options = options, .verified = true});
    EXPECT_EQ(row.bound, Bound::accuracy);
    EXPECT_EQ(row.h_max, infinity);
    EXPECT_FALSE(row.observed);  // no run is long
  }
}

// In flight the Jacobian of the contact at the start is all that has a rate. Linearly implicit Euler makes
// v / (1 + h^2 k) and x + h v of x and v, which grow at no step; the stages of others do.
TEST(PredictBySteps, TakesTheRatesOfAFrozenJacobianWhereTheModelHasNone) {
  const Problem pressed = ball(1e4, -1);
  const Linearised flying = linearised(pressed, 0, Eigen::Vector2d(1, 0));
  const auto row_of = [&](const char* method) {
    return predict_by_steps(find_method(method), pressed, flying, {.options = with_frozen, .verified = true});
  };
  EXPECT_EQ(row_of("linearly_implicit_euler").h_max, infinity);
  const Prediction row = row_of("rodas_5p");
  ASSERT_TRUE(row.observed);
  EXPECT_TRUE(row.observed->agrees) << row.note;
  EXPECT_LT(row.observed->h_max, 0.02);
}

}  // namespace
}  // namespace hmax
