/// Facts of methods against what their runs show.
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/families.hpp"
#include "catalogue/models/problems.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

Problem oscillator(double damping) { return make_problem("liver_cubic", {.parameters = {{"c", damping}}}); }

VectorXd steps_from(const Method& method, Problem problem, const VectorXd& y, int steps) {
  constexpr double h = 0.3;
  problem.y0 = y;
  const RunRecord record = method.bind(problem).run({.t_end = steps * h, .h = h, .jacobian = {1}}, {});
  EXPECT_EQ(record.outcome, Outcome::reached_end) << method.id;
  return record.y;
}

/// Whether twelve steps end somewhere else than twelve runs of one step. Methods of several steps take less
/// to start. Foreign engines begin their Newton iterations with what they know of the steps before.
bool shows_a_past(const Method& method, const Problem& problem, VectorXd y = Eigen::Vector2d(0.3, -0.6)) {
  constexpr int steps = 12;
  const VectorXd together = steps_from(method, problem, y, steps);
  for (int step = 0; step < steps; ++step) y = steps_from(method, problem, y, 1);
  return (together - y).norm() > (method.is_foreign() ? 1e-5 : 1e-9);
}

TEST(MethodFacts, AStepDependsOnThePastWhereRunsShowIt) {
  for (const double damping : {0.0, 0.3}) {
    const Problem problem = oscillator(damping);
    for (const Method& method : choose_methods({"all"}, {problem})) {
      if (!method.fixed_step) continue;
      EXPECT_EQ(depends_on_past(method, problem), shows_a_past(method, problem))
          << method.id << " with the damping " << damping;
    }
  }
  for (const char* name : {"hht_alpha:alpha=0", "generalized_alpha:rho_inf=0", "newmark:beta=0.3,gamma=0.6"})
    EXPECT_EQ(depends_on_past(find_method(name), oscillator(0.3)),
              shows_a_past(find_method(name), oscillator(0.3)))
        << name;
}

TEST(MethodFacts, AStepOfABodyDependsOnThePastWhereRunsShowIt) {
  const Problem body = make_problem("fem_neo_hookean@cube:n=1", {.parameters = {{"E", 20}, {"g", 0}}});
  VectorXd moving = body.y0;
  moving.tail(moving.size() / 2).setLinSpaced(0, 0.02);
  for (const char* name :
       {"vbd", "xpbd", "projective_dynamics", "newton_truncated:cg=50", "newton_truncated:cg=50,frozen=1"})
    EXPECT_EQ(depends_on_past(find_method(name), body), shows_a_past(find_method(name), body, moving))
        << name;
}

TEST(MethodFacts, AFirstStageThatIsTheLastOfTheStepBeforeCostsNothing) {
  constexpr int steps = 10;
  const Problem problem = oscillator(0.3);
  int shared = 0;
  for (const Method& method : choose_methods({"explicit_runge_kutta"}, {})) {
    const RunRecord record = method.bind(problem).run({.t_end = 1, .h = 1.0 / steps}, {});
    const int saved = method.first_same_as_last ? 1 : 0;
    EXPECT_EQ(record.stats.rhs <= steps * (method.stages - 1) + 1, saved == 1) << method.id;
    EXPECT_LE(record.stats.rhs, steps * method.stages) << method.id;
    shared += saved;
  }
  EXPECT_GE(shared, 3);
}

TEST(MethodFacts, TellWhichErrorEstimatesMissAFunctionOfTimeAlone) {
  std::set<std::string> told;
  for (const Method& method : methods())
    if (method.note.find("error estimate is zero") != std::string::npos) told.insert(method.id);
  told.erase("odeint_fehlberg78");  // where Boost is
  EXPECT_EQ(told, std::set<std::string>{"fehlberg_78"});
}

/// Its stages stand at 1/4, 3/4, 11/20, 1/2 and 1, and none at the start of the step.
TEST(MethodFacts, TellWhichErrorEstimatesMissAJump) {
  for (const Method& method : methods())
    EXPECT_EQ(
        method.note.find("does not see a jump in time in the first 0.25 of a step") != std::string::npos,
        method.id == "sdirk_4")
        << method.id;
}

TEST(MethodFacts, OnlyForeignMethodsFactorDenseMatricesAlone) {
  for (const Method& method : methods()) {
    EXPECT_FALSE(method.dense_equations && (!method.is_foreign() || !method.needs_jacobian)) << method.id;
    EXPECT_EQ(is_too_slow(method, 601), method.dense_equations) << method.id;
    EXPECT_FALSE(is_too_slow(method, 600)) << method.id;
  }
}

TEST(Families, HoldEveryMethodAndTellWhoseLibraryRunsIt) {
  std::set<std::string_view> ids;
  for (const Family& family : all_families) EXPECT_TRUE(ids.insert(family.id).second) << family.id;
  for (const Method& method : methods()) {
    const Family* const family = family_of(method);
    ASSERT_NE(family, nullptr) << method.id;
    EXPECT_EQ(method.is_foreign(), !family->library.name.empty()) << method.id;
    EXPECT_TRUE(method.id.starts_with(family->library.prefix)) << method.id;
  }
}

}  // namespace
}  // namespace hmax
