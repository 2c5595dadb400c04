/// The structural methods of the catalogue: their parameters, the facts that follow from them, their runs.

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string refusal(std::string_view name) {
  return error_of<InputError>([&] { find_method(name); });
}

TEST(StructuralMethods, NeedPositionsAndVelocities) {
  int found = 0;
  for (const Method& method : methods()) {
    if (method.family != "structural") continue;
    ++found;
    EXPECT_TRUE(method.needs_second_order && method.fixed_step && !method.adaptive()) << method.id;
    EXPECT_EQ(method.with != nullptr, !method.parameters.empty()) << method.id;
  }
  EXPECT_EQ(found, 8);
}

TEST(StructuralMethods, HaveTheOrderAndTheStabilityOfTheirParameters) {
  const auto facts = [](std::string_view name) {
    const Method m = find_method(name);
    return std::tuple(m.order, m.is_explicit, m.a_stable, m.l_stable);
  };
  EXPECT_EQ(facts("newmark"), std::tuple(2, false, true, false));
  EXPECT_EQ(facts("newmark:gamma=0.6"), std::tuple(1, false, false, false));
  EXPECT_EQ(facts("newmark:beta=0.3025,gamma=0.6"), std::tuple(1, false, true, false));
  EXPECT_EQ(facts("newmark:beta=0"), std::tuple(2, true, false, false));
  EXPECT_EQ(facts("newmark:beta=1,gamma=1.5"), std::tuple(1, false, true, true));
  EXPECT_EQ(facts("hht_alpha"), std::tuple(2, false, true, false));
  EXPECT_EQ(facts("hht_alpha:alpha=-0.3333333333333333"), std::tuple(2, false, true, false));
  EXPECT_EQ(facts("generalized_alpha"), std::tuple(2, false, true, false));
  EXPECT_EQ(facts("generalized_alpha:rho_inf=0"), std::tuple(2, false, true, true));
  EXPECT_EQ(facts("generalized_alpha:rho_inf=1"), std::tuple(2, false, true, false));
  EXPECT_EQ(facts("velocity_verlet"), std::tuple(1, true, false, false));
  EXPECT_EQ(facts("stormer_verlet"), std::tuple(2, true, false, false));
  EXPECT_EQ(facts("explicit_newmark"), std::tuple(2, true, false, false));
  EXPECT_EQ(find_method("verlet").id, "stormer_verlet");
}

TEST(StructuralMethods, SayWhichParametersMakeNoMethod) {
  EXPECT_EQ(
      refusal("newmark:beta=-0.1"),
      "beta of newmark is -0.1 but must lie between 0 and 1: it is the share of the new acceleration in the "
      "position, 1/4 for the trapezoidal rule");
  EXPECT_TRUE(says(refusal("newmark:gamma=3"), "between 0 and 2"));
  EXPECT_TRUE(says(refusal("hht_alpha:alpha=0.1"), "alpha of hht_alpha is 0.1"));
  EXPECT_TRUE(says(refusal("hht_alpha:alpha=-0.34"), "-1/3 damps fast modes most"));
  EXPECT_TRUE(says(refusal("generalized_alpha:rho_inf=1.1"), "between 0 and 1"));
  EXPECT_TRUE(says(refusal("generalized_alpha:rho=1"), "did you mean 'rho_inf'"));
  EXPECT_EQ(refusal("newmark:beta=0.3,beta=0.25"), "beta of newmark is given twice; leave one of them out");
}

TEST(StructuralMethods, RunWithTheirParametersAndCountTheirWork) {
  const Problem problem = make_problem("liver_linear");
  const RunSpec spec{.t_end = 10, .h = 0.1};
  const auto run = [&](std::string_view name) { return find_method(name).bind(problem).run(spec, {}); };
  const RunRecord newmark = run("newmark");
  EXPECT_EQ(newmark.outcome, Outcome::reached_end);
  EXPECT_EQ(newmark.stats.steps, 100);
  EXPECT_EQ(newmark.stats.factorisations, 1);
  EXPECT_EQ(run("newmark:beta=0.25,gamma=0.5").y, newmark.y);
  EXPECT_EQ(run("hht_alpha:alpha=0").y, newmark.y);
  EXPECT_NE(run("generalized_alpha:rho_inf=0.5").y, newmark.y);
  EXPECT_EQ(run("newmark:beta=0").y, run("explicit_newmark").y);
  EXPECT_EQ(run("stormer_verlet").stats.rhs, 101);
  EXPECT_EQ(run("velocity_verlet").stats.rhs, 101);
}

}  // namespace
}  // namespace hmax
