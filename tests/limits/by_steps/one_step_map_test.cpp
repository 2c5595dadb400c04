#include "limits/by_steps/one_step_map.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;

Problem cubic(double c) { return make_problem("liver_cubic", {.parameters = {{"c", c}}}); }

TEST(OneStepMap, IsTheStepOfTheFormula) {
  const double h = 0.4;
  const auto f = [](const Vector2d& y) {
    return Vector2d(y(1), -(2 * y(1) + 0.7 * y(0) + 0.8 * std::pow(y(0), 3)) / 1.45);
  };
  const Vector2d y(0.3, -0.6);
  EXPECT_LT((one_step_map(find_method("explicit_euler"), cubic(2), h)(y) - (y + h * f(y))).norm(), 1e-15);
  EXPECT_LT(
      (one_step_map(find_method("rk2_midpoint"), cubic(2), h)(y) - (y + h * f(y + h / 2 * f(y)))).norm(),
      1e-15);
  // Implicit methods by their equation.
  const Vector2d next = one_step_map(find_method("implicit_euler"), cubic(2), h)(y);
  EXPECT_LT((next - y - h * f(next)).norm(), 1e-14);
}

TEST(OneStepMap, KnowsWhichMethodsRememberMoreThanTheState) {
  const auto is_map = [](const Method& method, double c) {
    try {
      (void)one_step_map(method, cubic(c), 0.1);
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  for (const Method& method : methods()) {
    if (!method.fixed_step ||
        (!method.is_foreign() && !method.needs_second_order && method.steps_back == 0)) {
      EXPECT_EQ(is_map(method, 0.3), method.fixed_step) << method.id;
    }
  }
  // Orders 2 to 6 start with Runge-Kutta steps, so that a single step of them is one.
  for (const char* id : {"adams_bashforth_2", "adams_bashforth_6", "abm_pece_4", "abm_pec_1", "abm_pec_6",
                         "hht_alpha", "generalized_alpha"})
    EXPECT_FALSE(is_map(find_method(id), 0.3)) << id;
  // Of order 1 they are the rules of Euler.
  for (const char* id :
       {"adams_bashforth_1", "symplectic_euler", "newmark", "central_difference", "explicit_newmark"})
    EXPECT_TRUE(is_map(find_method(id), 0.3)) << id;
  // The force at the end of its step is taken at a velocity that is not yet the last one.
  for (const char* id : {"velocity_verlet", "stormer_verlet"}) {
    EXPECT_FALSE(is_map(find_method(id), 0.3)) << id;
    EXPECT_TRUE(is_map(find_method(id), 0)) << id;
  }
}

TEST(OneStepMap, AnswersWithNanWhereTheStepDiverges) {
  const VectorFunction map = one_step_map(find_method("rk4"), cubic(2), 2);
  EXPECT_FALSE(map(Vector2d(1e100, 0)).allFinite());
  EXPECT_FALSE(map(Vector2d(std::nan(""), 0)).allFinite());
  EXPECT_TRUE(map(Vector2d(0.1, 0)).allFinite());
}

TEST(OneStepMap, RefusesStepsThatAreNone) {
  for (const double h : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(one_step_map(find_method("rk4"), cubic(2), h), InputError) << h;
  EXPECT_THROW(one_step_map(find_method("stormer_verlet"), make_problem("van_der_pol"), 0.1), InputError);
}

}  // namespace
}  // namespace hmax
