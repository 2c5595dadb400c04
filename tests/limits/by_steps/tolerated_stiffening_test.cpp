#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/by_steps/predict_by_steps.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/steps/linearly_implicit.hpp"

namespace hmax {
namespace {

const StepChoices frozen_jacobian{.jacobian = {JacobianUpdate::frozen}, .linear = {}};

TEST(ToleratedStiffening, IsThatOfTheFormulaWithoutDamping) {
  const Problem spring = make_problem("liver_linear", {.parameters = {{"c", 0}}});
  const Linearised near = linearised(spring, 0, spring.y0);
  const double omega = std::sqrt(near.modes.spectrum.mechanical.front().kappa);
  const Method method = find_method("linearly_implicit_euler");
  for (const double omega_h : {0.5, 1.0, 3.0}) {
    const double of_formula = tolerated_stiffness(*linearly_implicit_method(method.id), omega_h).most;
    ASSERT_TRUE(std::isfinite(of_formula));
    EXPECT_NEAR(tolerated_stiffening(method, spring, near, frozen_jacobian, omega_h / omega), of_formula,
                0.03 * of_formula)
        << omega_h;
  }
}

TEST(ToleratedStiffening, GrowsWithDamping) {
  const auto tolerated = [](double c) {
    const Problem spring = make_problem("liver_linear", {.parameters = {{"c", c}}});
    return tolerated_stiffening(find_method("linearly_implicit_euler"), spring,
                                linearised(spring, 0, spring.y0), frozen_jacobian, 1);
  };
  EXPECT_GT(tolerated(1), 1.05 * tolerated(0));
}

TEST(ToleratedStiffening, IsNotToldOfWhatHasNoStiffness) {
  const Problem decay = make_problem("dahlquist", {});
  EXPECT_TRUE(std::isnan(tolerated_stiffening(find_method("linearly_implicit_euler"), decay,
                                              linearised(decay, 0, decay.y0), frozen_jacobian, 0.1)));
}

}  // namespace
}  // namespace hmax
