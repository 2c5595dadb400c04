#include "catalogue/methods/catalogue.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/choice/chosen_methods.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/methods/families.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(Catalogue, IdsAndAliasesAreUnique) {
  std::set<std::string> names;
  for (const Method& method : methods()) {
    EXPECT_TRUE(names.insert(method.id).second) << method.id;
    for (const std::string& alias : method.aliases) EXPECT_TRUE(names.insert(alias).second) << alias;
  }
  for (const std::string& family : method_families()) EXPECT_FALSE(names.contains(family)) << family;
}

TEST(Catalogue, FactsOfEveryMethodAgreeWithOneAnother) {
  for (const Method& method : methods()) {
    EXPECT_GE(method.order, 0) << method.id;
    EXPECT_FALSE(method.source.empty() || method.family.empty() || method.engine.empty()) << method.id;
    EXPECT_TRUE(method.fixed_step || method.adaptive()) << method.id;
    EXPECT_TRUE(method.a_stable || !method.l_stable) << method.id;
    EXPECT_FALSE(method.a_stable && method.is_explicit) << method.id;
    EXPECT_EQ(method.parameters.empty(), !method.with) << method.id;
  }
}

TEST(Catalogue, AMethodOfOtherParametersStaysInItsFamily) {
  for (const char* name : {"newmark:beta=0.3", "vbd:iterations=3", "rk4:substeps=2"})
    EXPECT_EQ(find_method(name).family,
              find_method(std::string_view(name).substr(0, std::string_view(name).find(':'))).family)
        << name;
}

TEST(Catalogue, ChangesParametersOfAMethodByTheirNames) {
  const Method vbd = find_method("vbd:iterations=3,rho=0.5");
  EXPECT_EQ(with_values(vbd, {{"substeps", 4}}).id, "vbd:iterations=3,substeps=4,rho=0.5");
  EXPECT_EQ(with_values(find_method("rk4"), {{"substeps", 4}}).id, "rk4:substeps=4");
  EXPECT_THROW(with_values(find_method("rk4"), {{"iterations", 4}}), InputError);
}

TEST(Catalogue, EveryMethodOfFixedStepsTakesThemInParts) {
  const Problem problem = make_problem("liver_forced");
  for (const Method& method : methods()) {
    if (!suits(method, problem)) continue;
    if (!method.fixed_step) {
      EXPECT_THROW(find_method(method.id + ":substeps=4"), InputError) << method.id;
      continue;
    }
    const Method parts = find_method(method.id + ":substeps=4");
    const RunRecord whole = parts.bind(problem).run({.t_end = 1, .h = 0.25}, {}),
                    small = method.bind(problem).run({.t_end = 1, .h = 0.0625}, {});
    EXPECT_EQ(whole.y, small.y) << method.id;
    EXPECT_FALSE(parts.adaptive()) << method.id;
    std::vector<double> times;
    parts.bind(problem).run({.t_end = 1, .h = 0.25}, [&](double t, const auto&) { times.push_back(t); });
    EXPECT_EQ(times, (std::vector<double>{0, 0.25, 0.5, 0.75, 1})) << method.id;
    if (method.parameters.empty()) {
      EXPECT_EQ(find_method(method.id + ":substeps=1").id, method.id);
    }
    EXPECT_EQ(parts.parameters.back(), (std::pair<std::string, double>("substeps", 4))) << method.id;
  }
  EXPECT_THROW(find_method("rk4:substeps=0"), InputError);
  EXPECT_THROW(find_method("rk4:substeps=1.5"), InputError);
}

TEST(Catalogue, FamiliesAndAllStandForTheMethodsThatSuitTheProblem) {
  const Problem oscillator = make_problem("liver_forced");
  const std::vector<Method> all = choose_methods({"all"}, {oscillator});
  EXPECT_EQ(static_cast<std::ptrdiff_t>(all.size()),
            std::ranges::count_if(methods(), [&](const Method& each) { return suits(each, oscillator); }));
  const std::vector<Method> explicit_ones = choose_methods({"explicit_runge_kutta", "rk4"}, {});
  EXPECT_GE(explicit_ones.size(), 13U);  // rk4 is one of them
  EXPECT_THROW(choose_methods({"explicit_runge_kuta"}, {}), InputError);
}

TEST(Catalogue, TakesAMethodThatIsNamedTwiceOnceInItsFirstPlace) {
  const auto ids = [](const std::vector<std::string>& names) {
    std::vector<std::string> chosen;
    for (const Method& method : choose_methods(names, {})) chosen.push_back(method.id);
    return chosen;
  };
  const std::vector<std::string> family = ids({"explicit_runge_kutta"});
  EXPECT_EQ(ids({"explicit_runge_kutta", "rk4"}), family);
  EXPECT_EQ(ids({"rk4", "ode45", "rk4", "dormand_prince_54"}),
            (std::vector<std::string>{"rk4", "dormand_prince_54"}));
  const std::vector<std::string> rk4_first = ids({"rk4", "explicit_runge_kutta"});
  EXPECT_EQ(rk4_first.front(), "rk4");
  EXPECT_EQ(rk4_first.size(), family.size());
  EXPECT_EQ(choose_formulas({"bdf_3", "rk4", "bdf_3", "explicit_runge_kutta"}).size(), family.size() + 1);
  EXPECT_EQ(chosen_methods_and_formulas({"bdf_3", "rk4", "bdf_3"}, {}).methods.size(), 2U);
}

TEST(Catalogue, NamesWhatItLeavesOutOfFamiliesWithTheReason) {
  const Problem kepler = make_problem("kepler"), first_order = make_problem("hires");
  const ChosenMethods chosen = chosen_methods({"structural", "rk4"}, {first_order});
  ASSERT_EQ(chosen.methods.size(), 1U);
  const std::size_t structural = choose_methods({"structural"}, {kepler}).size();
  EXPECT_EQ(chosen.left_out.size(), structural);
  for (const LeftOut& one : chosen.left_out)
    EXPECT_EQ(one.why, "steps positions and velocities, which hires does not have") << one.id;
  EXPECT_EQ(in_words(chosen.left_out).size(), 1U);
  EXPECT_TRUE(chosen_methods({"all"}, {make_problem("liver_forced")}).left_out.empty());
  EXPECT_TRUE(says(error_of<InputError>([&] { choose_methods({"structural"}, {first_order}); }), "newmark"));
}

TEST(Catalogue, OfFormulasHoldsTheNumberThatAMethodChoosesAsItRuns) {
  const ChosenFormulas stabilised = chosen_formulas({"stabilised"});
  ASSERT_EQ(stabilised.formulas.size(), 2U);
  EXPECT_EQ(stabilised.formulas[0].id, "rkc_2:stages=10");
  EXPECT_EQ(stabilised.formulas[1].id, "rkl_2:stages=10");
  EXPECT_EQ(stabilised.held.size(), 2U);
  // Every method of the catalogue is shown, held or named.
  const ChosenFormulas all = chosen_formulas({"all"});
  EXPECT_EQ(all.formulas.size() + all.left_out.size(), methods().size());
  for (const LeftOut& one : all.left_out) EXPECT_EQ(find_method(one.id).amplification, nullptr) << one.id;
}

TEST(Catalogue, KnowsWhichMethodsSolveNonlinearEquations) {
  const auto solves = [](const char* id) { return find_method(id).solves_nonlinear_equations(); };
  for (const char* id : {"rodas_4", "rosenbrock_23", "linearly_implicit_euler", "rk4", "symplectic_euler"})
    EXPECT_FALSE(solves(id)) << id;
  for (const char* id : {"newmark", "explicit_newmark", "implicit_euler", "radau_iia_5"})
    EXPECT_TRUE(solves(id)) << id;
  for (const Method& method : methods()) {
    if (method.id == "odeint_rosenbrock4" || method.id == "odeint_implicit_euler") {
      EXPECT_EQ(method.solves_nonlinear_equations(), method.id == "odeint_implicit_euler");
    }
  }
}

TEST(Catalogue, APeerOfAMethodThatIsNotThereIsAnError) {
  if (std::ranges::none_of(methods(), [](const Method& method) { return method.family == "odeint"; }))
    GTEST_SKIP() << "without Boost";
  std::vector<Method> none;
  EXPECT_THROW(add_odeint(none), std::logic_error);
}

TEST(Catalogue, AMethodWithoutItsTableIsLeftOutAndSaidWhy) {
  if (std::ranges::none_of(methods(),
                           [](const Method& method) { return method.family == "sundials_arkode"; }))
    GTEST_SKIP() << "without SUNDIALS";
  std::vector<Method> found;
  add_arkode_dirk(found, "arkode_dirk_of_tomorrow", 99'999);
  EXPECT_TRUE(found.empty());
  EXPECT_TRUE(says(why_left_out("arkode_dirk_of_tomorrow"), "no implicit table 99999"));
  EXPECT_TRUE(says(error_of<InputError>([&] { find_method("arkode_dirk_of_tomorrow"); }),
                   "another version of SUNDIALS"));
  EXPECT_EQ(why_left_out("rk4"), "");
}

TEST(Catalogue, AMethodWithoutParametersTakesNone) { EXPECT_THROW(find_method("rk4:beta=1"), InputError); }

TEST(Catalogue, JacobianPoliciesReadBackAsWritten) {
  for (const char* word : {"auto", "exact", "frozen", "every:7"})
    EXPECT_EQ(to_string(jacobian_update_from(word)), word);
  for (const char* word : {"every:0", "every:1.5", "every:", "frosen"})
    EXPECT_THROW(jacobian_update_from(word), InputError) << word;
}

TEST(Catalogue, LinearSolversReadBackAsWritten) {
  for (const char* word : {"auto", "direct", "cg:0.001", "cg:1e-06,20"})
    EXPECT_EQ(to_string(linear_solve_from(word)), word);
  for (const char* word : {"cg:1", "cg:0", "cg:1e-6,", "cg:1e-6,0", "cg:1e-6,2.5", "cg:,20", "chol"})
    EXPECT_THROW(linear_solve_from(word), InputError) << word;
}

}  // namespace
}  // namespace hmax
